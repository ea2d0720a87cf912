// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/audit/audit_clip.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "cinch/refit.hpp"
#include "exact/vertex_enclosure.hpp"
#include "experiments/audit/exact_clip.hpp"
#include "experiments/audit/outside_method.hpp"
#include "experiments/bake/baked_clip.hpp"
#include "experiments/baselines/engines/engine_character.hpp"
#include "experiments/measure/race.hpp"
#include "experiments/report/interrupt.hpp"

namespace cinch {

std::string name_of(AuditVerdict verdict)
{
    switch (verdict) {
    case AuditVerdict::proven:
        return "proven";
    case AuditVerdict::touches:
        return "to rounding";
    case AuditVerdict::holds:
        return "holds";
    case AuditVerdict::refuted:
        return "refuted";
    case AuditVerdict::undecided:
        return "undecided";
    }
    return "unknown";
}

namespace {

constexpr std::size_t most_instants = 1500, exact_instants = 64;

std::vector<double> times_of(const TimedMotion& motion, int samples)
{
    std::vector<double> times{motion.keys.front()};
    for (std::size_t i = 1; i < motion.keys.size(); ++i) {
        const double length = motion.keys[i] - motion.keys[i - 1];
        const int between = std::max(samples, static_cast<int>(std::min(60 * length, 1e5))); // where keys are sparse
        for (int s = 1; s <= between + 1; ++s)
            times.push_back(s > between ? motion.keys[i] : motion.keys[i - 1] + length * s / (between + 1));
    }
    if (times.size() <= most_instants)
        return times;
    std::vector<double> fewer;
    for (std::size_t i = 0; i < most_instants; ++i)
        fewer.push_back(times[i * (times.size() - 1) / (most_instants - 1)]);
    return fewer;
}

// How far the surface is beyond a bound at an instant, and which vertex is the farthest.
struct Beyond {
    double by = -HUGE_VAL;
    std::uint32_t vertex = 0;
    int direction = -1;
};

Beyond beyond(const EngineBound& bound, const Instant& at)
{
    Beyond out;
    if (bound.ball) {
        const Vec3 centre = bound.centre();
        for (std::uint32_t v = 0; v < at.places.size(); ++v)
            if (const double by = (at.places[v] - centre).norm() - *bound.ball; by > out.by)
                out = {by, v, -1};
        return out;
    }
    for (int c = 0; c < 3; ++c)
        for (const bool against : {false, true}) {
            const double by = against ? bound.low[c] - at.box.low[c] : at.box.high[c] - bound.high[c];
            if (!(by <= out.by)) // a bound that is no number is beyond everything
                out = {by, 0, 2 * c + against};
        }
    const int c = out.direction / 2;
    for (std::uint32_t v = 0; v < at.places.size(); ++v)
        if (at.places[v][c] == (out.direction % 2 ? at.box.low[c] : at.box.high[c]))
            out.vertex = v;
    return out;
}

// A formula on its way through a clip.
struct Audited {
    AuditedFormula row;
    ReadyFormula formula;
    std::vector<EngineBound> bounds = {}; // at each instant
    bool touches = false;                 // the surface, but for rounding, at an instant
    bool has_time = true;                 // of a bound, that says something

    // By what was confirmed, if it was.
    void refute(const std::optional<Counterexample>& found, const Instant& at)
    {
        if (!found)
            return;
        row.verdict = AuditVerdict::refuted;
        row.worst = found;
        row.worst_share = found->beyond / at.half_diagonal();
    }
};

// Its overflow and looseness at every instant, in doubles; and where it is refuted, exactly.
void try_at_instants(const std::vector<Instant>& instants, const ExactClip& exact, Audited& of)
{
    std::vector<std::pair<double, std::size_t>> worst; // beyond, instant
    double sum = 0;
    std::size_t measured = 0;
    for (std::size_t i = 0; i < instants.size(); ++i) {
        const Instant& at = instants[i];
        const EngineBound bound = of.formula.at(at.maps);
        of.bounds.push_back(bound);
        const double half = bound.ball ? *bound.ball : (0.5 * (bound.high - bound.low)).norm(),
                     ratio = half / at.half_diagonal();
        if (std::isfinite(ratio)) {
            sum += ratio;
            ++measured;
            of.row.max_ratio = std::max(of.row.max_ratio, ratio);
        }
        const double by = beyond(bound, at).by, rounding = audit_rounding * at.half_diagonal();
        of.touches = of.touches || !(by <= -rounding);
        if (!(by <= rounding))
            worst.emplace_back(by, i);
    }
    of.row.instants = instants.size();
    of.row.mean_ratio = sum / static_cast<double>(measured);
    std::sort(worst.begin(), worst.end(), std::greater<>());
    constexpr std::size_t most_tries = 16; // what rounding alone put outside may be inside
    for (std::size_t n = 0; n < std::min(worst.size(), most_tries); ++n) {
        throw_if_interrupted();
        const std::size_t i = worst[n].second;
        const Beyond by = beyond(of.bounds[i], instants[i]);
        of.refute(exact.confirm(instants[i].time_s, by.vertex, by.direction, of.bounds[i]), instants[i]);
        if (of.row.verdict == AuditVerdict::refuted)
            return;
    }
}

// Of a bound for the whole clip: all of it at once. What touches it at an instant takes the exact side as many halvings
// as there are, to say no more than that.
void prove_whole(const std::vector<Instant>& instants, const TimedClip& clip, const ExactClip& exact, Audited& of)
{
    const EngineBound &box = of.bounds.front(), more = grown(box);
    const exact::TimeVerdict verdict = exact.over(clip.motion.first_s(), clip.motion.last_s(), of.touches ? more : box);
    if (verdict.violated == 0 && verdict.undecided == 0)
        of.row.verdict = of.touches ? AuditVerdict::touches : AuditVerdict::proven;
    else if (verdict.worst)
        of.refute(exact.confirm(verdict.worst->time_s, static_cast<std::uint32_t>(verdict.worst->vertex),
                                static_cast<int>(verdict.worst->direction), box),
                  instants.front());
}

// Of a bound per pose: at some of the instants, of the matrices that it had, exactly.
void prove_at_instants(const std::vector<Instant>& instants, const ExactClip& exact, Audited& of)
{
    const std::size_t tries = std::min(instants.size(), exact_instants);
    of.row.instants = tries;
    bool touches = false;
    for (std::size_t n = 0; n < tries; ++n) {
        throw_if_interrupted();
        const std::size_t i = tries < 2 ? 0 : n * (instants.size() - 1) / (tries - 1);
        if (exact.holds_at(instants[i], of.bounds[i]))
            continue;
        if (!exact.holds_at(instants[i], grown(of.bounds[i])))
            return;
        touches = true;
    }
    of.row.verdict = touches ? AuditVerdict::touches : AuditVerdict::holds;
}

// That the boxes of joints hold their vertices at rest, from which all poses follow.
bool joints_hold(const DeformableSurface& surface)
{
    std::vector<Vec3> low(surface.weights.node_count, Vec3::Constant(HUGE_VAL)),
        high(low.size(), Vec3::Constant(-HUGE_VAL));
    for (std::size_t v = 0; v < surface.mesh.vertices.size(); ++v)
        for (const std::uint32_t j : surface.weights.of(v).node) {
            low[j] = low[j].cwiseMin(surface.mesh.vertices[v]);
            high[j] = high[j].cwiseMax(surface.mesh.vertices[v]);
        }
    return exact::rest_boxes_hold(surface, low, high);
}

// What is left where nothing was found.
void prove(const std::vector<Instant>& instants, const TimedBody& body, const TimedClip& clip, const ExactClip& exact,
           Audited& of)
{
    if (of.row.verdict == AuditVerdict::refuted)
        return;
    if (of.formula.still && !of.bounds.front().ball)
        prove_whole(instants, clip, exact, of);
    else if (of.formula.holds_by_convexity && !clip.motion.weights)
        of.row.verdict = joints_hold(body.input.surface) ? AuditVerdict::proven : AuditVerdict::undecided;
    else
        prove_at_instants(instants, exact, of);
}

EngineBound box_of_supports(std::span<const double> s) { return {{-s[1], -s[3], -s[5]}, {s[0], s[2], s[4]}, {}}; }

// The place among the instants of the maps that a formula gets, which are asked for in order.
class WhichInstant {
public:
    explicit WhichInstant(const std::vector<Instant>& instants) : instants_(instants) {}

    std::size_t operator()(std::span<const AffineMap> maps)
    {
        while (instants_[next_].maps.data() != maps.data())
            next_ = (next_ + 1) % instants_.size();
        return next_;
    }

private:
    const std::vector<Instant>& instants_;
    std::size_t next_ = 0;
};

std::vector<Audited> outside_methods(const TimedBody& body, const TimedClip& clip, const std::vector<Instant>& instants,
                                     const AuditOptions& options)
{
    std::vector<Audited> out;
    for (const OutsideMethod& method : options.outside) {
        throw_if_interrupted();
        auto at = [bounds = bounds_of(method, body, clip.motion.name, instants), which = WhichInstant(instants)](
                      std::span<const AffineMap> maps) mutable { return bounds[which(maps)]; };
        out.push_back({{method.name, "from outside"}, {false, false, at}});
        out.back().has_time = false;
    }
    return out;
}

// Ours: the root's bound by a method, pose by pose; and the greatest over the whole clip.
std::vector<Audited> own_formulas(const TimedBody& body, const TimedClip& clip, const std::vector<Instant>& instants,
                                  const ExactClip& exact)
{
    std::vector<Audited> out;
    for (const Method method : {Method::best, Method::local, Method::eq12}) {
        RefitOptions options;
        options.methods = method;
        options.precision = Precision::float64;
        const auto refit = std::make_shared<Refitter>(exact.bvh(), body.input.surface, options, body.targets());
        const auto supports = std::make_shared<std::vector<double>>(exact.bvh().bvs.size() * 6);
        // A formula has the maps of an instant; weights come from the instant that has them.
        auto at = [refit, supports, &instants,
                   which = WhichInstant(instants)](std::span<const AffineMap> maps) mutable {
            (*refit)(maps, instants[which(maps)].weights, *supports);
            return box_of_supports(*supports);
        };
        out.push_back({{"cinch " + std::string(name_of(method)), "cinch::Refitter"}, {false, false, at}, {}});
    }
    BakeOptions options;
    options.whole = true;
    options.bounds.precision = Precision::float64;
    IntervalRefitter refit(exact.bvh(), body.input.surface, options.bounds, body.targets());
    const std::vector<BakedInterval> baked = bake_clip(refit, clip.motion, options, exact.bvh().bvs.size() * 6);
    const EngineBound whole = box_of_supports(baked.front().supports);
    out.push_back({{"cinch bake", "cinch::ClipBounder"},
                   {true, false, [whole](std::span<const AffineMap>) { return whole; }},
                   {}});
    return out;
}

// Nanoseconds of a bound of each that has one per pose, in turn, pose after pose.
void time(const std::vector<Instant>& instants, double seconds, std::vector<Audited>& all)
{
    std::vector<std::size_t> place;
    std::vector<std::function<void()>> calls;
    std::vector<std::size_t> next(all.size());
    volatile double sink = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (all[i].formula.still || !all[i].has_time)
            continue;
        place.push_back(i);
        calls.emplace_back([&, i] {
            const EngineBound bound = all[i].formula.at(instants[next[i]].maps);
            sink = bound.high[0];
            next[i] = (next[i] + 1) % instants.size();
        });
    }
    const RaceTimes times = race(calls, seconds);
    for (std::size_t c = 0; c < place.size(); ++c)
        all[place[c]].row.ns = times.of(c);
}

} // namespace

std::vector<AuditedFormula> audit_clip(const TimedBody& body, const TimedClip& clip, const AuditOptions& options)
{
    const EngineCharacter character = engine_character(body, clip);
    std::vector<Instant> instants;
    for (const double t : times_of(clip.motion, options.samples)) {
        throw_if_interrupted();
        std::vector<Vec3> places = character.places_at(t);
        const EngineBound box = box_of(places);
        instants.push_back({t, clip.motion.at(t), {}, std::move(places), box});
        if (clip.motion.weights)
            instants.back().weights = clip.motion.weights(t);
    }
    const ExactClip exact(body, clip);
    std::vector<Audited> all;
    for (const EngineFormula& formula : engine_formulas())
        if (auto ready = formula.make(character))
            all.push_back({{formula.name, formula.used_by}, std::move(*ready), {}});
    for (Audited& outside : outside_methods(body, clip, instants, options))
        all.push_back(std::move(outside));
    for (Audited& own : own_formulas(body, clip, instants, exact))
        all.push_back(std::move(own));
    for (Audited& of : all) {
        of.row.still = of.formula.still;
        try_at_instants(instants, exact, of);
        prove(instants, body, clip, exact, of);
    }
    time(instants, options.seconds, all);
    std::vector<AuditedFormula> rows;
    for (Audited& of : all)
        rows.push_back(std::move(of.row));
    return rows;
}

} // namespace cinch
