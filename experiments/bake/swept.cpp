// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bake/swept.hpp"

#include <algorithm>

#include "experiments/bake/baked_clip.hpp"

namespace cinch {

Input with_frames(const TimedBody& body, std::size_t frames)
{
    const TimedMotion& motion = body.clips.front().motion;
    const double first = motion.first_s(), last = motion.last_s();
    const std::size_t count = last > first ? std::max<std::size_t>(frames, 2) : 1;
    auto time_s = [first, last, count](std::size_t i) {
        return i + 1 == count ? last : first + (last - first) * static_cast<double>(i) / static_cast<double>(count - 1);
    };
    Input out = body.input;
    std::function<std::vector<double>(std::size_t)> weights;
    if (motion.weights) {
        weights = [of = motion.weights, time_s](std::size_t i) { return of(time_s(i)); };
        out.targets.assign(body.targets().begin(), body.targets().end());
    }
    out.clip = {motion.name, count, time_s, [at = motion.at, time_s](std::size_t i) { return at(time_s(i)); }, weights};
    return out;
}

Inputs with_all_times(InputOptions what, std::size_t frames, std::vector<TimedBody>& timed)
{
    what.frames = 0;
    what.first_frame = false;
    timed = load_timed(what);
    Inputs out{what.input, {}, {}};
    for (TimedBody& body : timed) {
        body.clips.resize(1); // the first, or the one that was asked for
        out.bodies.push_back(with_frames(body, frames));
        out.report.insert(out.report.end(), body.input.report.begin(), body.input.report.end());
    }
    return out;
}

std::vector<double> swept_bounds(const TimedBody& body, const Input& input, const Bvh& bvh, int kdop)
{
    BakeOptions options;
    options.bounds.kdop = kdop;
    IntervalRefitter refit(bvh, body.input.surface, options.bounds, body.targets());
    const std::size_t supports = bvh.bvs.size() * static_cast<std::size_t>(kdop);
    const std::vector<BakedInterval> intervals =
        bake_clip(refit, watched(body.clips.front().motion, TimeSabotage::none), options, supports);
    std::vector<double> out;
    for (std::size_t f = 0; f < input.clip.frame_count(); ++f) {
        const double t = input.clip.time_s(f);
        const auto around =
            std::find_if(intervals.begin(), intervals.end(), [t](const BakedInterval& i) { return t <= i.last_s; });
        out.insert(out.end(), around->supports.begin(), around->supports.end());
    }
    return out;
}

} // namespace cinch
