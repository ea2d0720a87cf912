// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <span>

namespace cinch {

/// Half the diagonal of the box of a k-DOP: the measure of the paper's Fig. 5. From supports in the order of
/// axes_of(k).
inline double box_radius(std::span<const double> supports)
{
    return 0.5 * std::hypot(supports[0] + supports[1], supports[2] + supports[3], supports[4] + supports[5]);
}

} // namespace cinch
