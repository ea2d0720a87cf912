// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace cinch {

/// Throws std::runtime_error unless this thread's arithmetic rounds to nearest and keeps subnormals: every guarantee rests on it.
/// Linking anything with -ffast-math, or a plug-in host that sets flush-to-zero, breaks it for the whole thread. Asked wherever numbers are
/// made that bounds rest on: by readers, weights, motions and clips, trees, refits, queries and steps.
void require_default_arithmetic();

} // namespace cinch
