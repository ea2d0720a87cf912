// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/fuzz/time_case.hpp"

#include <cmath>
#include <random>

#include "toolkit/time/bound_over.hpp"

namespace cinch {
namespace {

using Random = std::mt19937_64;

double between(Random& random, double low, double high)
{
    return std::uniform_real_distribution<double>(low, high)(random);
}
std::size_t one_of(Random& random, std::size_t count)
{
    return std::uniform_int_distribution<std::size_t>(0, count - 1)(random);
}

// As files have them: floats.
double stored(double x) { return static_cast<double>(static_cast<float>(x)); }

std::array<double, 4> quaternion(Random& random)
{
    std::normal_distribution<double> normal;
    std::array<double, 4> q;
    double square = 0;
    for (double& x : q) {
        x = normal(random);
        square += x * x;
    }
    for (double& x : q)
        x = stored(x / std::sqrt(square));
    return q;
}

// Keys as files have them, and the awkward ones: equal, of the other sign, nearly the same, half a turn away, and 0,
// which is the identity, that no curve turns to.
std::array<double, 4> next_key(Random& random, const std::array<double, 4>& q)
{
    std::array<double, 4> out = q;
    switch (one_of(random, 7)) {
    case 0:
        return out;
    case 1:
        for (double& x : out)
            x = -x;
        return out;
    case 2:
        for (double& x : out)
            x = stored(x + between(random, -1e-6, 1e-6));
        return out;
    case 3: // orthogonal but for a little: nearly half a turn
        return {stored(-q[1] + 1e-3), q[0], stored(-q[3]), q[2]};
    case 4:
        if (one_of(random, 4) == 0)
            return {};
        return quaternion(random);
    default:
        return quaternion(random);
    }
}

Curve random_curve(Random& random, std::uint32_t bone, Curve::Target target)
{
    Curve curve;
    curve.bone = bone;
    curve.target = target;
    curve.interpolation = std::array{Curve::Interpolation::linear, Curve::Interpolation::linear,
                                     Curve::Interpolation::cubic_spline, Curve::Interpolation::step}[one_of(random, 4)];
    const std::size_t keys = 1 + one_of(random, 4);
    double t = stored(between(random, -0.5, 0.5));
    std::array<double, 4> value = quaternion(random);
    for (std::size_t k = 0; k < keys; ++k) {
        curve.time_s.push_back(t);
        t = stored(t + between(random, 0.01, 1));
        auto tangent = [&] {
            const double size = one_of(random, 8) == 0 ? std::array{20.0, 1e3, 1e6}[one_of(random, 3)] : 1;
            return std::array{stored(between(random, -size, size)), stored(between(random, -size, size)),
                              stored(between(random, -size, size)), stored(between(random, -size, size))};
        };
        if (target == Curve::Target::translation)
            value = {stored(between(random, -2, 2)), stored(between(random, -2, 2)), stored(between(random, -2, 2)), 0};
        else if (target == Curve::Target::scale)
            value = {stored(between(random, 0.2, 2)), stored(between(random, 0.2, 2)), stored(between(random, 0.2, 2)),
                     0};
        else
            value = next_key(random, value);
        const bool cubic = curve.interpolation == Curve::Interpolation::cubic_spline;
        if (cubic)
            curve.value.push_back(tangent());
        curve.value.push_back(value);
        if (cubic)
            curve.value.push_back(tangent());
    }
    return curve;
}

// One target or a few, of some vertices, each with weights that a curve moves or that stand still.
void add_targets(Random& random, std::size_t vertices, Character& c)
{
    const std::size_t count = 1 + one_of(random, 3);
    for (std::size_t i = 0; i < count; ++i) {
        MorphTarget& target = c.targets.emplace_back();
        c.target_weights.push_back(one_of(random, 2) ? stored(between(random, -1, 1)) : 0);
        for (std::uint32_t v = 0; v < vertices; ++v)
            if (one_of(random, 3) > 0) {
                target.vertex.push_back(v);
                target.displacement.emplace_back(stored(between(random, -1, 1)), stored(between(random, -1, 1)),
                                                 stored(between(random, -1, 1)));
            }
    }
    if (one_of(random, 4) == 0)
        return;
    const std::size_t first = one_of(random, count);
    // Four numbers of a curve are as many weights as there are.
    const Curve from = random_curve(random, 0, Curve::Target::translation);
    WeightCurve curve{static_cast<std::uint32_t>(first),
                      static_cast<std::uint32_t>(count - first),
                      from.interpolation,
                      from.time_s,
                      {}};
    for (const auto& value : from.value)
        for (std::size_t n = 0; n < curve.count; ++n)
            curve.value.push_back(value[n]);
    c.rest.morphs.push_back(curve);
}

} // namespace

TimeCase draw_time_case(std::uint64_t seed)
{
    Random random(seed);
    TimeCase out;
    Character& c = out.character;
    const std::uint32_t bones = 1 + static_cast<std::uint32_t>(one_of(random, 4));
    for (std::uint32_t b = 0; b < bones; ++b) {
        Bone bone;
        bone.parent = static_cast<std::int64_t>(b) - 1;
        bone.translation = {stored(between(random, -1, 1)), 1, 0};
        bone.rotation = quaternion(random);
        if (one_of(random, 4) == 0) { // centimetres on metres
            const double s = b % 2 ? 100 : 0.01;
            bone.scale = {s, s, s};
        }
        c.bones.push_back(bone);
        AffineMap bind = identity_map;
        for (auto& row : bind.m)
            for (double& x : row)
                x = stored(x + between(random, -0.3, 0.3));
        c.joints.push_back({b, bind});
        for (const auto target : {Curve::Target::translation, Curve::Target::rotation, Curve::Target::scale})
            if (one_of(random, target == Curve::Target::rotation ? 1 : 3) == 0)
                c.rest.curves.push_back(random_curve(random, b, target));
    }
    c.rest.first_s = -0.25;
    c.rest.last_s = 1.5;
    Influences influences;
    influences.node_count = bones;
    for (std::uint32_t v = 0; v < 18; ++v) {
        out.surface.mesh.vertices.emplace_back(stored(between(random, -1, 1)), stored(between(random, -1, 1)),
                                               stored(between(random, -1, 1)));
        for (std::uint32_t j = 0; j < bones; ++j)
            if (j == v % bones || one_of(random, 2) == 0) {
                influences.node.push_back(j);
                influences.weight.push_back(between(random, 0.1, 1));
            }
        influences.row.push_back(static_cast<std::uint32_t>(influences.node.size()));
        if (v >= 2)
            out.surface.mesh.triangles.push_back({v - 2, v - 1, v});
    }
    if (one_of(random, 2) == 0)
        add_targets(random, out.surface.mesh.vertices.size(), c);
    out.surface.weights = to_dyadic(influences);
    out.bvh = build_bvh(out.surface, 2);
    return out;
}

std::vector<double> bounds_over_clip(const TimeCase& subject, const TimedMotion& motion, const RefitOptions& options,
                                     CutInto by)
{
    IntervalRefitter refit(subject.bvh, subject.surface, options, subject.character.targets);
    std::vector<double> out(subject.bvh.bvs.size() * static_cast<std::size_t>(options.kdop));
    const double tolerance = by == CutInto::chosen ? 0.01 : 1e6;
    if (by != CutInto::between_keys || motion.keys.size() < 2) {
        bound_over(refit, motion, motion.first_s(), motion.last_s(), tolerance, out);
        return out;
    }
    std::vector<double> own(out.size());
    for (std::size_t i = 1; i < motion.keys.size(); ++i) {
        bound_over(refit, motion, motion.keys[i - 1], motion.keys[i], tolerance, own);
        for (std::size_t s = 0; s < out.size(); ++s)
            out[s] = i == 1 ? own[s] : std::max(out[s], own[s]);
    }
    return out;
}

} // namespace cinch
