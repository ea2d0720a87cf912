// SPDX-License-Identifier: Apache-2.0
// Key-frame interpolation of the glTF 2.0 specification (appendix C) and joint matrices.
#include <algorithm>
#include <cmath>
#include <memory>

#include <Eigen/Geometry>

#include "cinch/deform.hpp"
#include "cinch/environment.hpp"
#include "toolkit/surface/character.hpp"

namespace cinch {
namespace {

using Quad = std::array<double, 4>;
using Matrix4 = Eigen::Matrix4d;

Quad combine(double a, const Quad& x, double b, const Quad& y)
{
    Quad out;
    for (std::size_t i = 0; i < 4; ++i)
        out[i] = a * x[i] + b * y[i];
    return out;
}

double dot(const Quad& x, const Quad& y) { return x[0] * y[0] + x[1] * y[1] + x[2] * y[2] + x[3] * y[3]; }

Quad slerp(const Quad& from, const Quad& to, double s)
{
    const double cosine = dot(from, to);
    const double sign = cosine < 0 ? -1 : 1; // the shorter way round
    const double angle = std::acos(std::min(1.0, std::abs(cosine)));
    if (angle < 1e-6) // sin(angle) loses its digits; the chord and the arc agree to 1e-13 here
        return combine(1 - s, from, sign * s, to);
    const double scale = 1 / std::sin(angle);
    return combine(std::sin((1 - s) * angle) * scale, from, sign * std::sin(s * angle) * scale, to);
}

Quad evaluate(const Curve& curve, double t)
{
    const bool cubic = curve.interpolation == Curve::Interpolation::cubic_spline;
    auto value_at = [&](std::size_t key) -> const Quad& { return curve.value[cubic ? 3 * key + 1 : key]; };
    const auto next = std::upper_bound(curve.time_s.begin(), curve.time_s.end(), t);
    if (next == curve.time_s.begin())
        return value_at(0);
    const auto key = static_cast<std::size_t>(next - curve.time_s.begin() - 1);
    if (next == curve.time_s.end() || curve.interpolation == Curve::Interpolation::step)
        return value_at(key);
    const double span = *next - curve.time_s[key], s = (t - curve.time_s[key]) / span;
    if (cubic) {
        const double s2 = s * s, s3 = s2 * s;
        const Quad ends = combine(2 * s3 - 3 * s2 + 1, value_at(key), -2 * s3 + 3 * s2, value_at(key + 1));
        const Quad tangents =
            combine(span * (s3 - 2 * s2 + s), curve.value[3 * key + 2], span * (s3 - s2), curve.value[3 * key + 3]);
        return combine(1, ends, 1, tangents);
    }
    if (curve.target == Curve::Target::rotation)
        return slerp(value_at(key), value_at(key + 1), s);
    return combine(1 - s, value_at(key), s, value_at(key + 1));
}

Matrix4 local_matrix(const Bone& bone)
{
    if (bone.is_matrix)
        return Eigen::Map<const Matrix4>(bone.matrix.data());
    const auto& r = bone.rotation;
    Eigen::Quaterniond q(r[3], r[0], r[1], r[2]);
    if (q.squaredNorm() > 0)
        q.normalize();
    Matrix4 m = Matrix4::Identity();
    m.topLeftCorner<3, 3>() = q.toRotationMatrix() * Eigen::Vector3d(bone.scale.data()).asDiagonal();
    m.topRightCorner<3, 1>() = Eigen::Vector3d(bone.translation.data());
    return m;
}

void apply(const Curve& curve, double t, Bone& bone)
{
    const Quad value = evaluate(curve, t);
    bone.is_matrix = false; // it was taken apart when the file was read
    if (curve.target == Curve::Target::rotation)
        bone.rotation = value;
    else
        std::copy_n(value.begin(), 3, (curve.target == Curve::Target::scale ? bone.scale : bone.translation).begin());
}

// What a frame is made from.
struct Motion {
    std::string file, name;
    std::vector<Bone> bones;
    std::vector<Joint> joints;
    std::vector<Curve> curves;
    double first, last;
    std::size_t steps;              // from the first frame to the last
    std::vector<double> still = {}; // weights of morph targets that no curve sets; none where nothing is displaced
    std::vector<Curve> morphs = {}; // of one target each, Curve::bone

    double time_s(std::size_t i) const
    {
        return i == steps ? last : first + (last - first) * static_cast<double>(i) / static_cast<double>(steps);
    }

    std::vector<double> weights(double t) const
    {
        std::vector<double> out = still;
        for (const Curve& curve : morphs)
            out[curve.bone] = evaluate(curve, t)[0];
        return out;
    }

    Clip::Frame frame(double t) const
    {
        std::vector<Bone> now = bones;
        for (const Curve& curve : curves)
            apply(curve, t, now[curve.bone]);
        std::vector<Matrix4, Eigen::aligned_allocator<Matrix4>> world;
        world.reserve(now.size());
        for (const Bone& bone : now) { // parents come first
            const Matrix4 local = local_matrix(bone);
            world.push_back(bone.parent < 0 ? local : world[static_cast<std::size_t>(bone.parent)] * local);
        }
        Clip::Frame maps;
        maps.reserve(joints.size());
        for (const Joint& joint : joints) {
            Matrix4 bind = Matrix4::Identity();
            for (int r = 0; r < 3; ++r)
                for (int c = 0; c < 4; ++c)
                    bind(r, c) = joint.inverse_bind.m[r][c];
            const Matrix4 m = world[joint.bone] * bind;
            AffineMap map;
            for (int r = 0; r < 3; ++r)
                for (int c = 0; c < 4; ++c) {
                    if (!std::isfinite(m(r, c)))
                        throw InputError::in_file(file, "clip '" + name + "' at " + std::to_string(t) +
                                                            " s: the matrix of joint " + std::to_string(maps.size()) +
                                                            " overflows");
                    map.m[r][c] = m(r, c);
                }
            maps.push_back(map);
        }
        return maps;
    }
};

} // namespace

// Weights are sampled like translations.
static std::vector<Curve> curves_of_targets(const std::vector<WeightCurve>& together)
{
    std::vector<Curve> out;
    for (const WeightCurve& of : together)
        for (std::uint32_t i = 0; i < of.count; ++i) {
            Curve& curve = out.emplace_back();
            curve.bone = of.first_target + i;
            curve.interpolation = of.interpolation;
            curve.time_s = of.time_s;
            for (std::size_t v = i; v < of.value.size(); v += of.count)
                curve.value.push_back({of.value[v], 0, 0, 0});
        }
    return out;
}

bool moves_targets(const Character& character, const Character::Animation& animation)
{
    std::vector<double> most = character.target_weights; // absolute
    for (const WeightCurve& curve : animation.morphs)
        for (std::size_t i = 0; i < curve.value.size(); ++i) {
            double& weight = most[curve.first_target + i % curve.count];
            weight = std::max(i < curve.count ? 0 : std::abs(weight), std::abs(curve.value[i]));
        }
    for (std::size_t i = 0; i < most.size(); ++i)
        if (most[i] != 0 && !character.targets[i].vertex.empty())
            return true;
    return false;
}

DeformableSurface surface_of(const Character& character, WeightReport* report)
{
    DeformableSurface surface{character.mesh, to_dyadic(character.influences, report)};
    if (character.skins + character.carried < 2 || !character.rest.fault.empty())
        return surface;
    Clip::Frame maps;
    try {
        maps = Motion{character.file, "rest", character.bones, character.joints, {}, 0, 0, 0}.frame(0);
    } catch (const InputError&) { // it overflows
        return surface;
    }
    surface.layout.resize(character.mesh.vertices.size());
    evaluate(character.mesh.vertices, surface.weights, maps, surface.layout);
    for (const Vec3& place : surface.layout)
        if (!place.allFinite()) {
            surface.layout.clear();
            break;
        }
    return surface;
}

Clip rest_pose(const Character& character) { return sample(character, character.rest, 1); }

Clip sample(const Character& character, const Character::Animation& animation, double fps)
{
    require_default_arithmetic();
    if (!animation.fault.empty())
        throw InputError(animation.fault);
    const double length = animation.last_s - animation.first_s;
    constexpr double most_frames = 1e12;
    if (!(length * fps < most_frames - 1))
        throw InputError::in_file(character.file,
                                  "clip '" + animation.name + "' lasts " + std::to_string(length) +
                                      " s, a million million frames at this rate; lower the frames per second");
    const auto steps = static_cast<std::size_t>(std::max(length > 0 ? 1.0 : 0.0, std::round(length * fps)));
    Motion of{character.file,   animation.name,    character.bones,  character.joints,
              animation.curves, animation.first_s, animation.last_s, steps};
    const bool displaced = moves_targets(character, animation);
    if (displaced) {
        of.still = character.target_weights;
        of.morphs = curves_of_targets(animation.morphs);
    }
    const auto motion = std::make_shared<const Motion>(std::move(of));
    std::function<std::vector<double>(std::size_t)> weights;
    if (displaced)
        weights = [motion](std::size_t i) { return motion->weights(motion->time_s(i)); };
    return {animation.name, steps + 1, [motion](std::size_t i) { return motion->time_s(i); },
            [motion](std::size_t i) { return motion->frame(motion->time_s(i)); }, weights};
}

std::string not_modelled(const std::vector<std::string>& missing)
{
    std::string out = "what is not modelled: ";
    for (std::size_t i = 0; i < missing.size(); ++i)
        out += (i ? "; " : "") + missing[i];
    return out;
}

} // namespace cinch
