// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bake/prove.hpp"

#include <cmath>

#include <fmt/format.h>

#include "exact/clip_enclosure.hpp"
#include "exact/pose_check.hpp"
#include "experiments/report/interrupt.hpp"
#include "experiments/report/number.hpp"

namespace cinch {
namespace {

// Of the weights that morph targets may have.
std::optional<exact::Enclosure> limits_of(const TimedBody& body)
{
    if (!body.any_weights)
        return {};
    return exact::Enclosure{body.any_weights->least, body.any_weights->greatest};
}

} // namespace

exact::TimeVerdict prove(const TimedBody& body, const TimedClip& clip, const Bvh& bvh, int kdop,
                         std::span<const BakedInterval> intervals)
{
    if (!body.poses.empty()) {
        const Character& character = body.any_weights ? *body.any_weights->character : *body.character;
        const exact::PoseChecker check(body.input.surface, bvh, character, body.poses, limits_of(body), kdop,
                                       throw_if_interrupted);
        return check(intervals.front().supports);
    }
    std::unique_ptr<exact::MotionEnclosure> enclosure;
    std::span<const MorphTarget> targets = body.targets();
    if (body.any_weights) {
        targets = body.any_weights->character->targets;
        enclosure =
            std::make_unique<exact::ClipEnclosure>(*body.any_weights->character, *clip.animation, limits_of(body));
    } else if (clip.animation)
        enclosure = std::make_unique<exact::ClipEnclosure>(*body.character, *clip.animation);
    else
        enclosure = std::make_unique<exact::LinearEnclosure>(body.input.clip);
    const exact::TimeChecker check(body.input.surface, bvh, *enclosure, targets, kdop, throw_if_interrupted);
    exact::TimeVerdict out;
    for (const BakedInterval& interval : intervals)
        out.add(check(interval.first_s, interval.last_s, interval.supports));
    return out;
}

TimeProofFile::TimeProofFile(const std::string& name, const TimedBody& body, const Bvh& bvh, Methods methods, int kdop)
    : body_(body), file_(name),
      writer_(body.input.surface, bvh, {methods, kdop, RestShape::aabb, "", 0, body.input.missing},
              body.any_weights ? body.any_weights->character.get() : body.character.get(), limits_of(body),
              body.clips.size(), [this](std::string_view text) {
                  throw_if_interrupted(); // then none is written
                  file_.line(text);
              })
{
}

void TimeProofFile::add(const TimedClip& clip, std::span<const BakedInterval> intervals)
{
    const double first_s = clip.motion.first_s(), last_s = clip.motion.last_s();
    if (!body_.poses.empty())
        writer_.poses(clip.motion.name, body_.poses, first_s);
    else if (clip.animation)
        writer_.clip(*clip.animation, first_s, last_s, intervals.size());
    else
        writer_.clip(body_.input.clip, first_s, last_s, intervals.size());
    for (const BakedInterval& interval : intervals)
        writer_.interval(interval.first_s, interval.last_s, interval.supports);
}

void TimeProofFile::commit(const exact::TimeVerdict& verdict)
{
    writer_.end(verdict);
    file_.commit();
}

std::string verdict_line(const exact::TimeVerdict& verdict, std::string_view of)
{
    return fmt::format("{} bounds for all {}, {} proven, {} violated{}", grouped(verdict.bounds), of,
                       grouped(verdict.proven()), grouped(verdict.violated),
                       verdict.undecided ? ", " + grouped(verdict.undecided) + " undecided" : "");
}

std::string worst_line(const exact::TimeVerdict& verdict)
{
    if (!verdict.worst)
        return "";
    const exact::Outside& worst = *verdict.worst;
    const std::string when =
        std::isnan(worst.time_s) ? "in a pose within the limits" : fmt::format("at {:.17g} s", worst.time_s);
    return fmt::format("  vertex {} {} is {:.3g} beyond direction {} of BV {}\n", worst.vertex, when,
                       worst.at_least - worst.bound, worst.direction, worst.bv);
}

} // namespace cinch
