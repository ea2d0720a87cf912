// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "cinch/bvh.hpp"

namespace cinch {

/// Exact volumes of a level's bounds over those of the true k-DOPs, summed over BVs and frames. Exact polytopes take
/// milliseconds each, so a level is sampled: at most 16 BVs, evenly spread.
struct VolumeTotals {
    std::size_t measured = 0; ///< with a true k-DOP that is not flat
    std::size_t flat = 0;
    double ratio_sum = 0, ratio_max = 0;
    std::size_t redundant = 0; ///< half-spaces of the bounds without a facet
};

/// Adds one frame. `totals` has one entry per level.
void add_volumes(const DeformableSurface& surface, const Bvh& bvh, std::span<const AffineMap> maps, int kdop,
                 std::span<const double> supports, std::vector<VolumeTotals>& totals);

} // namespace cinch
