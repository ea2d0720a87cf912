// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace cinch {

/// The instruction sets that this machine can run and the kernels are compiled for, best first, and the one in use.
std::vector<std::string> kernel_targets();
std::string kernel_target();
/// Uses only this target from now on; empty lifts it. False if there is none of that name here. Not while kernels run.
bool force_kernel_target(std::string_view name);

} // namespace cinch
