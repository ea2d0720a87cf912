// SPDX-License-Identifier: Apache-2.0
#include "toolkit/deform/kernel/targets.hpp"

#include "toolkit/deform/kernel/disabled_targets.hpp"
#include <hwy/highway.h>

namespace cinch {

std::vector<std::string> kernel_targets()
{
    std::vector<std::string> names;
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets())
        names.emplace_back(hwy::TargetName(target));
    return names;
}

std::string kernel_target() { return kernel_targets().front(); }

bool force_kernel_target(std::string_view name)
{
    hwy::SetSupportedTargetsForTest(0);
    if (name.empty())
        return true;
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets())
        if (hwy::TargetName(target) == name) {
            hwy::SetSupportedTargetsForTest(target);
            return true;
        }
    return false;
}

} // namespace cinch
