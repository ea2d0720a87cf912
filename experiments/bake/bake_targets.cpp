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

Range refits_per_interval(const TimedBody& body, const Bvh& bvh, const RefitOptions& options)
{
    const TimedMotion& motion = body.clips.front().motion;
    const std::vector<double>& keys = motion.keys;
    if (keys.size() < 2)
        return {std::nan("")};
    const tbb::global_control alone(tbb::global_control::max_allowed_parallelism, 1);
    std::vector<MotionInterval> intervals; // as many as are no trouble to keep
    for (std::size_t i = 1; i < std::min<std::size_t>(keys.size(), 33); ++i)
        intervals.push_back(motion.over(keys[i - 1], keys[i]));
    IntervalRefitter over(bvh, body.input.surface, options, body.targets());
    Refitter at(bvh, body.input.surface, options);
    std::vector<double> supports(bvh.bvs.size() * static_cast<std::size_t>(options.kdop));
    std::size_t i = 0, j = 0;
    const RaceTimes times = race({[&] {
                                      const std::size_t here = i++ % intervals.size();
                                      motion.over(intervals[here].first_s, intervals[here].last_s);
                                      over(intervals[here], supports);
                                  },
                                  [&] { at(intervals[j++ % intervals.size()].first, supports); }},
                                 0.5);
    return times.ratio(0, 1);
}

std::vector<Figure> time_targets(const std::vector<BakedFigures>& clips, const Range& cost, std::size_t bvs)
{
    double time = 1, root = 1, leaves = 1, missed = 0, per_segment = std::nan(""), per_second = std::nan("");
    for (const BakedFigures& clip : clips) {
        time = std::max(time, clip.time_max);
        root = std::max(root, clip.root);
        leaves = std::max(leaves, clip.leaves);
        missed = std::max(missed, clip.missed_by_us);
        const auto intervals = static_cast<double>(clip.intervals), segments = static_cast<double>(clip.key_segments);
        if (clip.length_s > 0 && segments >= baked_rate * clip.length_s)
            per_segment = std::fmax(per_segment, intervals / segments);
        else if (clip.length_s > 0)
            per_second = std::fmax(per_second, intervals / clip.length_s);
    }
    auto figure = [](const char* what, const char* format, double value, double most) {
        const std::string text = std::isnan(value) ? "-" : fmt::format(fmt::runtime(format), value);
        return Figure(what, text, fmt::format("<= {}", most), at_most(value, most));
    };
    const Range counted = bvs >= 500 ? cost : Range(std::nan(""));
    return {figure("what time adds, any BV and interval", "{:.3f}", time, 1.01),
            figure("root / truth, worst clip", "{:.3f}", root, 1.04),
            figure("leaves / truth, worst clip", "{:.3f}", leaves, 1.1),
            figure("vertices outside, of the half diagonal", "{:.3g}", missed, 0),
            figure("intervals per key segment, sampled clips", "{:.2f}", per_segment, 1.2),
            figure("intervals per second, other clips", "{:.0f}", per_second, 45),
            {"refits that one interval costs", std::isnan(counted.value) ? "-" : fmt::format("{:.2f}", counted.value),
             "<= 2.5", at_most(counted, 2.5)}};
}

} // namespace cinch
