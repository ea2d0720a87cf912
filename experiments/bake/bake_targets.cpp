// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bake/bake_targets.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <tbb/global_control.h>

#include "toolkit/time/interval_refit.hpp"

namespace cinch {
namespace {

// Clips with this many keys per second are those that a program has sampled.
constexpr double baked_rate = 15;

} // namespace

IntervalCost interval_cost(const TimedBody& body, const Bvh& bvh, const RefitOptions& options)
{
    const TimedMotion& motion = body.clips.front().motion;
    const std::vector<double>& keys = motion.keys;
    if (keys.size() < 2)
        return {};
    const tbb::global_control alone(tbb::global_control::max_allowed_parallelism, 1);
    std::vector<MotionInterval> intervals; // as many as are no trouble to keep
    for (std::size_t i = 1; i < std::min<std::size_t>(keys.size(), 33); ++i)
        intervals.push_back(motion.over(keys[i - 1], keys[i]));
    IntervalRefitter over(bvh, body.input.surface, options, body.targets());
    Refitter at(bvh, body.input.surface, options);
    std::vector<double> supports(bvh.bvs.size() * static_cast<std::size_t>(options.kdop));
    // An interval after another: what it takes to know how it moves, bounds at its end, those over it.
    auto by = [&](double enough) {
        return [&, enough, i = std::size_t{0},
                first = over.at(over.all(), intervals[0].first, intervals[0].morph.first)]() mutable {
            const MotionInterval& interval = intervals[i++ % intervals.size()];
            motion.over(interval.first_s, interval.last_s);
            InstantBounds last = over.at(over.all(), interval.last, interval.morph.last);
            over(over.all(), interval, first, last, enough, supports);
            first = std::move(last);
        };
    };
    std::size_t j = 0;
    const RaceTimes times =
        race({by(0), by(HUGE_VAL), [&] { at(intervals[j++ % intervals.size()].first, supports); }}, 0.5);
    return {times.ratio(0, 2), times.ratio(1, 2)};
}

std::vector<Figure> time_targets(const std::vector<BakedFigures>& clips, const IntervalCost& cost, std::size_t bvs)
{
    double time = 1, root = 1, leaves = 1, missed = 0, sampled = 0, between_keys = 0, worst = 0,
           per_second = std::nan("");
    for (const BakedFigures& clip : clips) {
        time = std::max(time, clip.time_max);
        root = std::max(root, clip.root);
        leaves = std::max(leaves, clip.leaves);
        missed = std::max(missed, clip.missed_by_us);
        const double intervals = clip.intervals, segments = static_cast<double>(clip.key_segments);
        if (!(clip.length_s > 0))
            continue;
        if (segments >= baked_rate * clip.length_s) {
            sampled += intervals;
            between_keys += segments;
            worst = std::max(worst, intervals / segments);
        } else {
            per_second = std::fmax(per_second, intervals / clip.length_s);
        }
    }
    auto figure = [](const char* what, const char* format, double value, double most) {
        const std::string text = std::isnan(value) ? "-" : fmt::format(fmt::runtime(format), value);
        return Figure(what, text, fmt::format("<= {}", most), at_most(value, most));
    };
    auto of_refits = [bvs](const char* what, const Range& measured, double most) {
        const Range counted = bvs >= 500 ? measured : Range(std::nan(""));
        const std::string text = std::isnan(counted.value) ? "-" : fmt::format("{:.2f}", counted.value);
        return Figure(what, text, fmt::format("<= {}", most), at_most(counted, most));
    };
    return {figure("what time adds, any BV and interval", "{:.3f}", time, 1.01),
            figure("root / truth, worst clip", "{:.3f}", root, 1.04),
            figure("leaves / truth, worst clip", "{:.3f}", leaves, 1.1),
            figure("vertices outside, of the half diagonal", "{:.3g}", missed, 0),
            {"intervals per key segment (worst clip)",
             between_keys > 0 ? fmt::format("{:.2f} ({:.2f})", sampled / between_keys, worst) : "-", "<= 1.2",
             at_most(sampled / between_keys, 1.2)},
            figure("intervals per second, other clips", "{:.0f}", per_second, 45),
            of_refits("refits that one interval costs, by its bend", cost.bend, 2.5),
            of_refits("the same by norms", cost.norms, 1.5)};
}

} // namespace cinch
