// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/absolute.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include "cinch/bounds.hpp"
#include "exact/number.hpp"

namespace cinch::exact {

void absolute_supports(int kdop, std::span<const float> relative, const Vec3& origin, std::span<double> supports)
{
    const auto axes = axes_of(kdop);
    if (relative.size() != 2 * axes.size() || supports.size() != relative.size())
        throw std::invalid_argument("absolute_supports: sizes do not fit");
    const DirectedRounding upward;
    for (std::size_t d = 0; d < supports.size(); ++d) {
        Interval sum(static_cast<double>(relative[d]));
        for (int r = 0; r < 3; ++r)
            sum += Interval((d % 2 ? -1 : 1) * axes[d / 2][static_cast<std::size_t>(r)] * origin[r]);
        constexpr double infinite = std::numeric_limits<double>::infinity();
        supports[d] = relative[d] == std::numeric_limits<float>::infinity() ? infinite
                      : std::isnan(sum.inf())                               ? -infinite
                                                                            : sum.inf();
    }
}

} // namespace cinch::exact
