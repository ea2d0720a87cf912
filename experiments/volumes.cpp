// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/volumes.hpp"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

#include "exact/polytope.hpp"

namespace cinch {

void add_volumes(const DeformableSurface& surface, const Bvh& bvh, std::span<const AffineMap> maps, int kdop,
                 std::span<const double> supports, std::vector<VolumeTotals>& totals)
{
    constexpr std::size_t most = 16;
    const auto k = static_cast<std::size_t>(kdop);
    for (std::size_t level = 0; level < totals.size(); ++level) {
        const std::size_t first = bvh.level[level], count = bvh.level[level + 1] - first,
                          sample = std::min(count, most);
        std::vector<exact::Polytope> bound(sample), truth(sample);
        tbb::parallel_for(std::size_t{0}, sample, [&](std::size_t i) {
            const std::size_t bv = first + i * count / sample;
            const auto s = supports.subspan(bv * k, k);
            if (std::any_of(s.begin(), s.end(), [](double x) { return !std::isfinite(x); }))
                return;
            bound[i] = exact::polytope(kdop, s);
            truth[i] = exact::true_polytope(surface, bvh, bv, maps, kdop);
        });
        for (std::size_t i = 0; i < sample; ++i) {
            VolumeTotals& t = totals[level];
            t.redundant += bound[i].redundant.size();
            if (!(truth[i].approximate_volume > 0)) {
                ++t.flat;
                continue;
            }
            const double ratio = bound[i].approximate_volume / truth[i].approximate_volume;
            ++t.measured;
            t.ratio_sum += ratio;
            t.ratio_max = std::max(t.ratio_max, ratio);
        }
    }
}

} // namespace cinch
