// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bake/prove.hpp"

#include <fmt/format.h>

#include "exact/clip_enclosure.hpp"
#include "experiments/report/interrupt.hpp"
#include "experiments/report/number.hpp"

namespace cinch {

exact::TimeVerdict prove(const TimedBody& body, const TimedClip& clip, const Bvh& bvh, int kdop,
                         std::span<const BakedInterval> intervals)
{
    std::unique_ptr<exact::MotionEnclosure> enclosure;
    if (clip.animation)
        enclosure = std::make_unique<exact::ClipEnclosure>(*body.character, *clip.animation);
    else
        enclosure = std::make_unique<exact::LinearEnclosure>(body.input.clip);
    const exact::TimeChecker check(body.input.surface, bvh, *enclosure, body.targets(), kdop, throw_if_interrupted);
    exact::TimeVerdict out;
    for (const BakedInterval& interval : intervals)
        out.add(check(interval.first_s, interval.last_s, interval.supports));
    return out;
}

std::string verdict_line(const exact::TimeVerdict& verdict)
{
    return fmt::format("{} bounds for all times, {} proven, {} violated{}", grouped(verdict.bounds),
                       grouped(verdict.proven()), grouped(verdict.violated),
                       verdict.undecided ? ", " + grouped(verdict.undecided) + " undecided" : "");
}

std::string worst_line(const exact::TimeVerdict& verdict)
{
    if (!verdict.worst)
        return "";
    const exact::Outside& worst = *verdict.worst;
    return fmt::format("  vertex {} at {:.17g} s is {:.3g} beyond direction {} of BV {}\n", worst.vertex, worst.time_s,
                       worst.at_least - worst.bound, worst.direction, worst.bv);
}

} // namespace cinch
