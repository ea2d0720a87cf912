// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/verify_totals.hpp"

#include <algorithm>
#include <cmath>

namespace cinch {

void add_levels(const Bvh& bvh, VerifyTotals& totals)
{
    const std::size_t levels = bvh.level.size() - 1;
    if (totals.levels.size() < levels)
        totals.levels.resize(levels);
    for (std::size_t i = 0; i < levels; ++i) {
        totals.levels[i].bvs += bvh.level[i + 1] - bvh.level[i];
        for (std::size_t bv = bvh.level[i]; bv < bvh.level[i + 1]; ++bv)
            totals.levels[i].nodes += bvh.bvs[bv].influence_count;
    }
}

void add(const Bvh& bvh, const exact::FrameVerdict& frame, int kdop, std::span<const char> counted,
         VerifyTotals& totals)
{
    const auto k = static_cast<std::size_t>(kdop);
    for (std::size_t i = 0; i + 1 < bvh.level.size(); ++i) { // another body's tree may have more
        LevelTotals& level = totals.levels[i];
        for (std::size_t bv = bvh.level[i]; bv < bvh.level[i + 1]; ++bv) {
            if (!counted.empty() && !counted[bv])
                continue;
            const auto masks = std::span(frame.failed).subspan(bv * k, k);
            const auto violated = static_cast<std::size_t>(
                std::count_if(masks.begin(), masks.end(), [](auto mask) { return mask != 0; }));
            level.violated += violated;
            level.proven += k - violated;
            const exact::BvReport& report = frame.bvs[bv];
            const double ratio = report.bound_radius / report.true_radius;
            if (!(report.true_radius > 0 && std::isfinite(ratio)))
                continue;
            ++level.measured;
            level.ratio_sum += ratio;
            level.ratio_max = std::max(level.ratio_max, ratio);
            level.loss.box += report.loss.box / report.true_radius;
            level.loss.interval += report.loss.interval / report.true_radius;
            level.loss.corner += report.loss.corner / report.true_radius;
            level.loss.rounding += report.loss.rounding / report.true_radius;
        }
    }
    for (const exact::Violation& violation : frame.examples) {
        if (totals.examples.size() >= 10)
            break;
        const auto above =
            std::upper_bound(bvh.level.begin(), bvh.level.end(), static_cast<std::uint32_t>(violation.bv));
        totals.examples.push_back({totals.frames, static_cast<std::size_t>(above - bvh.level.begin() - 1), violation});
    }
    totals.decided_by_filter += frame.decided_by_filter;
    ++totals.frames;
}

void finish(VerifyTotals& totals)
{
    for (const LevelTotals& level : totals.levels) {
        totals.proven += level.proven;
        totals.violated += level.violated;
    }
    totals.bounds = totals.proven + totals.violated;
}

} // namespace cinch
