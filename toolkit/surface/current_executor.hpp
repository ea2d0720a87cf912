// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cinch/environment.hpp"

namespace cinch {

/// What this thread goes parallel by; null for oneTBB.
Executor*& current_executor();

} // namespace cinch
