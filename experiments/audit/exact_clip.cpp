// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/audit/exact_clip.hpp"

#include <algorithm>

#include "exact/clip_enclosure.hpp"
#include "exact/vertex_enclosure.hpp"
#include "experiments/report/interrupt.hpp"

namespace cinch {
namespace {

std::vector<double> supports_of(const EngineBound& box)
{
    return {box.high[0], -box.low[0], box.high[1], -box.low[1], box.high[2], -box.low[2]};
}

} // namespace

EngineBound grown(EngineBound bound)
{
    const double room = audit_rounding * (bound.high - bound.low).maxCoeff();
    bound.low -= Vec3::Constant(room);
    bound.high += Vec3::Constant(room);
    if (bound.ball)
        *bound.ball += room;
    return bound;
}

ExactClip::ExactClip(const TimedBody& body, const TimedClip& clip)
    : body_(body), bvh_(build_bvh(body.input.surface, body.input.surface.mesh.triangles.size())),
      verifier_(body.input.surface, bvh_, throw_if_interrupted, body.targets())
{
    if (clip.animation)
        motion_ = std::make_unique<exact::ClipEnclosure>(*body.character, *clip.animation);
    else
        motion_ = std::make_unique<exact::LinearEnclosure>(body.input.clip);
    check_.emplace(body.input.surface, bvh_, *motion_, body.targets(), 6, throw_if_interrupted);
}

exact::TimeVerdict ExactClip::over(double first_s, double last_s, const EngineBound& box) const
{
    return (*check_)(first_s, last_s,
                     std::vector{box.high[0], -box.low[0], box.high[1], -box.low[1], box.high[2], -box.low[2]});
}

std::optional<Counterexample> ExactClip::confirm(double time_s, std::uint32_t vertex, int direction,
                                                 const EngineBound& bound) const
{
    const exact::InstantEnclosure at(body_.input.surface, *motion_, body_.targets(), time_s);
    Counterexample out{time_s, vertex, direction, 0, bound.centre(), at.place(vertex), 0};
    if (bound.ball) {
        out.bound = *bound.ball;
        Vec3 middle;
        for (int c = 0; c < 3; ++c)
            middle[c] = out.place[static_cast<std::size_t>(c)].low;
        out.beyond = (middle - out.centre).norm() - out.bound;
        return exact::is_outside(out.place, out.centre, out.bound) ? std::optional(out) : std::nullopt;
    }
    const auto c = static_cast<std::size_t>(direction / 2);
    const bool against = direction % 2;
    out.bound = against ? -bound.low[direction / 2] : bound.high[direction / 2];
    const double reach = against ? -out.place[c].high : out.place[c].low; // at least
    out.beyond = reach - out.bound;
    return reach > out.bound ? std::optional(out) : std::nullopt;
}

bool ExactClip::holds_at(const Instant& at, const EngineBound& bound) const
{
    if (bound.ball) {
        for (std::uint32_t v = 0; v < at.places.size(); ++v)
            if (!exact::is_inside(verifier_.place(v, at.maps, at.weights), bound.centre(), *bound.ball))
                return false;
        return true;
    }
    const exact::FrameVerdict verdict =
        verifier_.check(at.maps, Method::vertices, 6, supports_of(bound), RestShape::aabb, at.weights);
    return std::none_of(verdict.failed.begin(), verdict.failed.end(),
                        [](std::uint8_t failed) { return failed & exact::exact_vertices; });
}

} // namespace cinch
