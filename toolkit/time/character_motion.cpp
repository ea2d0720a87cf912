// SPDX-License-Identifier: Apache-2.0
#include "toolkit/time/character_motion.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <set>

#include "cinch/environment.hpp"
#include "toolkit/surface/character.hpp"
#include "toolkit/time/bone_path.hpp"
#include "toolkit/time/weight_path.hpp"

namespace cinch {
namespace {

// Sums and products of non-negative terms, some hundred per bone, are rounded by less.
constexpr double wider = 1 + 0x1p-32;
// How far computed derivatives of a chain of d factors are from the exact ones: at most (d + 2) · chain_error · what
// they are without cancellation. A factor's own entries: 16 roundings of sums and products, and sin, cos and atan2, off
// by at most 2⁻⁵⁰ (tests/time/motion_test.cpp has them against MPFR): less than 2⁻⁴⁷ in norm. A product of two: γ₄
// |A||B| in each entry, at most 3γ₄ ‖A‖_F ‖B‖_F < 2⁻⁴⁹ ‖A‖ ‖B‖ · 3, Leibniz's coefficients as the majorant has them:
// 2⁻⁴⁷. Both together with all that is of second order, 2⁻⁴⁵; 2⁻⁴³ leaves room. `t − key` and the time of the middle
// are off by u of themselves, which moves a polynomial's terms by 3u of each.
constexpr double chain_error = 0x1p-43;

struct World {
    std::array<Eigen::Matrix3d, 3> m{Mat3::Identity(), Mat3::Zero(), Mat3::Zero()};
    std::array<Vec3, 3> p{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
};

// (G L)^(k) by Leibniz.
World chained(const World& g, const BonePath::Jet& l)
{
    World out;
    out.m[0] = g.m[0] * l.m[0];
    out.p[0] = g.m[0] * l.p[0] + g.p[0];
    out.m[1] = g.m[1] * l.m[0] + g.m[0] * l.m[1];
    out.p[1] = g.m[1] * l.p[0] + g.m[0] * l.p[1] + g.p[1];
    out.m[2] = g.m[2] * l.m[0] + 2 * (g.m[1] * l.m[1]) + g.m[0] * l.m[2];
    out.p[2] = g.m[2] * l.p[0] + 2 * (g.m[1] * l.p[1]) + g.m[0] * l.p[2] + g.p[2];
    return out;
}

std::vector<World> world_of(const std::vector<Bone>& bones, const std::vector<BonePath::Jet>& jets)
{
    std::vector<World> world(bones.size());
    for (std::size_t i = 0; i < bones.size(); ++i) // parents come first
        world[i] = chained(bones[i].parent < 0 ? World() : world[static_cast<std::size_t>(bones[i].parent)], jets[i]);
    return world;
}

// Without derivatives.
std::vector<BonePath::Place> place_at(const std::vector<Bone>& bones, const std::vector<BonePath>& paths, double t)
{
    std::vector<BonePath::Place> world(bones.size());
    for (std::size_t i = 0; i < bones.size(); ++i) {
        const BonePath::Place own = paths[i].place_at(t);
        world[i] = own;
        if (bones[i].parent < 0)
            continue;
        const BonePath::Place& above = world[static_cast<std::size_t>(bones[i].parent)];
        world[i] = {above.m * own.m, above.m * own.p + above.p};
    }
    return world;
}

Mat3 linear(const AffineMap& map)
{
    Mat3 out;
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c)
            out(r, c) = map.m[r][c];
    return out;
}

Vec3 shift(const AffineMap& map) { return {map.m[0][3], map.m[1][3], map.m[2][3]}; }

// G B.
AffineMap joint_map(const Mat3& of_bone, const Vec3& place, const AffineMap& bind)
{
    const Mat3 m = of_bone * linear(bind);
    const Vec3 p = of_bone * shift(bind) + place;
    AffineMap out;
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c)
            out.m[r][c] = m(r, c);
        out.m[r][3] = p[r];
    }
    return out;
}

class CharacterMotion {
public:
    CharacterMotion(const Character& character, const Character::Animation& animation, const DeformableSurface& surface,
                    const Engine& engine)
        : file_(character.file), name_(animation.name), bones_(character.bones), joints_(character.joints),
          curves_(animation.curves), curves_of_(bones_.size()), reach_(reaches(surface))
    {
        require_default_arithmetic();
        if (!animation.fault.empty())
            throw InputError(animation.fault);
        for (std::size_t c = 0; c < curves_.size(); ++c)
            curves_of_[curves_[c].bone].push_back(c);
        if (!engine.exact())
            engine_.emplace(engine, character, surface);
        if (!moves_targets(character, animation))
            return;
        weights_ = character.target_weights;
        weight_curves_ = animation.morphs;
        farthest_.resize(joints_.size());
        for (std::uint32_t i = 0; i < character.targets.size(); ++i) {
            std::map<std::uint32_t, double> most;
            const MorphTarget& target = character.targets[i];
            for (std::size_t n = 0; n < target.vertex.size(); ++n) {
                Vec3 far = target.displacement[n].cwiseAbs();
                if (!target.half.empty()) // twice: what opposite displacements are rounded against
                    far += 2 * target.half[n];
                for (const std::uint32_t j : surface.weights.of(target.vertex[n]).node)
                    most[j] = std::max(most[j], norm_of(far) * wider);
            }
            for (const auto& [j, size] : most)
                farthest_[j].push_back({i, size});
        }
    }

    bool morphs() const { return !weights_.empty(); }
    std::vector<double> weights(double t_s) const { return WeightPath(weights_, weight_curves_, t_s).at(0, t_s); }
    std::vector<AffineMap> at(double t_s) const;
    MotionInterval over(double a_s, double b_s) const;

private:
    std::vector<BonePath> paths(double middle_s) const;
    std::vector<BonePath> paths_at_end(std::vector<BonePath> paths, double middle_s, double end_s) const;
    std::vector<const Curve*> curves(std::size_t bone) const;

    std::string file_, name_;
    std::vector<Bone> bones_;
    std::vector<Joint> joints_;
    std::vector<Curve> curves_;
    std::vector<std::vector<std::size_t>> curves_of_; // a bone
    std::vector<Reach> reach_;
    std::optional<EngineError> engine_;
    // Of morph targets, where their weights are not all 0: weights that no curve sets, curves, and how far each target
    // displaces a vertex that a joint influences.
    std::vector<double> weights_;
    std::vector<WeightCurve> weight_curves_;
    std::vector<std::vector<std::pair<std::uint32_t, double>>> farthest_;
};

std::vector<const Curve*> CharacterMotion::curves(std::size_t bone) const
{
    std::vector<const Curve*> out;
    for (const std::size_t c : curves_of_[bone])
        out.push_back(&curves_[c]);
    return out;
}

std::vector<BonePath> CharacterMotion::paths(double middle_s) const
{
    std::vector<BonePath> out;
    out.reserve(bones_.size());
    for (std::size_t b = 0; b < bones_.size(); ++b)
        out.emplace_back(bones_[b], curves(b), middle_s, std::nullopt);
    return out;
}

std::vector<BonePath> CharacterMotion::paths_at_end(std::vector<BonePath> paths, double middle_s, double end_s) const
{
    for (std::size_t b = 0; b < bones_.size(); ++b)
        if (!curves_of_[b].empty())
            paths[b] = BonePath(bones_[b], curves(b), middle_s, end_s);
    return paths;
}

std::vector<AffineMap> CharacterMotion::at(double t_s) const
{
    const std::vector<BonePath::Place> world = place_at(bones_, paths(t_s), t_s);
    std::vector<AffineMap> out;
    out.reserve(joints_.size());
    for (const Joint& joint : joints_) {
        out.push_back(joint_map(world[joint.bone].m, world[joint.bone].p, joint.inverse_bind));
        if (!is_finite(out.back()))
            throw InputError::in_file(file_, "clip '" + name_ + "' at " + std::to_string(t_s) +
                                                 " s: the matrix of joint " + std::to_string(out.size() - 1) +
                                                 " overflows");
    }
    return out;
}

MotionInterval CharacterMotion::over(double a_s, double b_s) const
{
    const double middle_s = a_s + (b_s - a_s) / 2, length = (b_s - a_s) * wider;
    const std::vector<BonePath> path = paths(middle_s);
    const std::vector<BonePath::Place> first = place_at(bones_, path, a_s),
                                       last = place_at(bones_, paths_at_end(path, middle_s, b_s), b_s);
    std::vector<BonePath::Limits> limits;
    std::vector<BonePath::Jet> jets;
    for (const BonePath& bone : path) {
        limits.push_back(bone.over(a_s, b_s));
        jets.push_back(bone.at(middle_s));
    }
    const std::vector<World> middle = world_of(bones_, jets);
    static constexpr double choose[4][4] = {{1}, {1, 1}, {1, 2, 1}, {1, 3, 3, 1}};
    auto times = [](double x, double y) { return x == 0 || y == 0 ? 0 : x * y; };

    MotionInterval out{a_s, b_s, {}, {}, {}, {}, {}};
    std::vector<WeightPath::Limits> weights;
    if (morphs()) {
        const WeightPath of(weights_, weight_curves_, middle_s);
        weights = of.over(a_s, b_s);
        out.morph.first = of.at(0, a_s);
        out.morph.last = WeightPath(weights_, weight_curves_, middle_s, b_s).at(0, b_s);
        for (std::size_t k = 0; k < 3; ++k)
            out.morph.at[k] = of.at(k, middle_s);
    }
    const double bend = -(b_s - a_s) * (b_s - a_s) / 8;
    for (std::size_t j = 0; j < joints_.size(); ++j) {
        const Joint& joint = joints_[j];
        out.first.push_back(joint_map(first[joint.bone].m, first[joint.bone].p, joint.inverse_bind));
        out.last.push_back(joint_map(last[joint.bone].m, last[joint.bone].p, joint.inverse_bind));
        auto middle_map = [&](std::size_t k, double factor) {
            AffineMap map = joint_map(middle[joint.bone].m[k], middle[joint.bone].p[k], joint.inverse_bind);
            for (auto& row : map.m)
                for (double& x : row)
                    x *= factor;
            return map;
        };
        out.bend.push_back(middle_map(2, bend));
        std::array<double, 4> displaced{}; // suprema of derivatives of Σ_i a_i d_i
        std::array<double, 3> displaced_without{};
        if (morphs()) {
            out.morph.slope.push_back(middle_map(1, 2 * bend));
            out.morph.still.push_back(middle_map(0, bend));
            for (const auto& [i, size] : farthest_[j])
                for (std::size_t k = 0; k < 4; ++k) {
                    displaced[k] += times(weights[i].sup[k], size) * wider;
                    if (k < 3)
                        displaced_without[k] += times(weights[i].magnitude[k], size) * wider;
                }
        }

        // Majorants from the joint up to the root (time: of x in the frame of each bone on the way), of derivatives 0
        // to 3; and without cancellation, of 0 to 2.
        const Reach& reach = reach_[j];
        const Mat3 b = linear(joint.inverse_bind);
        const double of_bind = norm_of(b); // Frobenius's, not less than that of any direction
        Vec3 centre = apply(joint.inverse_bind, reach.centre);
        double radius = of_bind * (reach.radius + displaced[0]) * wider;
        std::array<double, 4> r{norm_of(centre) + radius, of_bind * displaced[1] * wider,
                                of_bind * displaced[2] * wider, of_bind * displaced[3] * wider};
        std::array<double, 3> without{of_bind * (norm_of(reach.centre) + reach.radius + displaced_without[0]) +
                                          norm_of(shift(joint.inverse_bind)),
                                      of_bind * displaced_without[1] * wider, of_bind * displaced_without[2] * wider};
        r[0] = r[0] * wider + 0x1p-48 * without[0];
        std::size_t depth = 1;
        // How far an engine's rotations put it, and the lengths that its products add up, link by link.
        double turned = 0, lengths = (of_bind * (norm_of(reach.centre) + reach.radius + displaced[0]) +
                                      norm_of(shift(joint.inverse_bind))) *
                                     wider;
        for (std::int64_t at = joint.bone; at >= 0; at = bones_[static_cast<std::size_t>(at)].parent, ++depth) {
            const BonePath::Limits& l = limits[static_cast<std::size_t>(at)];
            const BonePath::Jet& jet = jets[static_cast<std::size_t>(at)];
            if (engine_) {
                const TurnPath::Between& turn = path[static_cast<std::size_t>(at)].between();
                const double apart = engine_->of_turn(turn.angle, turn.is_half, turn.length_ratio);
                turned = (times(l.m[0], turned) + times(apart, times(l.m[0], r[0] + turned))) * wider;
                lengths = (l.p[0] + times(l.m[0], lengths)) * wider;
            }
            for (std::size_t k = 4; k-- > 0;) {
                double sum = l.p[k];
                for (std::size_t i = 0; i <= k; ++i)
                    sum += choose[k][i] * times(l.m[i], r[k - i]);
                r[k] = sum * wider;
            }
            for (std::size_t k = 3; k-- > 0;) {
                double sum = l.p_magnitude[k];
                for (std::size_t i = 0; i <= k; ++i)
                    sum += choose[k][i] * times(l.m_magnitude[i], without[k - i]);
                without[k] = sum * wider;
            }
            // Of the middle of the interval, plus the way from there.
            centre = jet.m[0] * centre + jet.p[0];
            radius = times(norm_of(jet.m[0]), radius) * wider;
            const double from_middle = norm_of(centre) + radius + length / 2 * r[1];
            if (from_middle < r[0])
                r[0] = from_middle * wider + static_cast<double>(depth) * 2 * chain_error * without[0];
        }
        const double rounding = static_cast<double>(depth + 2) * chain_error, square = length * length / 8;
        MotionInterval::Limits limit;
        // A middle that is off by u of the greatest time sees x″ change by x‴ times as much.
        const double off = 0x1p-52 * std::max(std::abs(a_s), std::abs(b_s));
        limit.remainder = (times(square * length / 4, r[3]) + times(square * off, r[3])) * wider;
        limit.bump = times(square, r[2]) * wider;
        limit.path = times(length, r[1]) * wider;
        limit.error = rounding * without[0] * wider;
        if (engine_)
            limit.error = (limit.error + engine_->of(j, lengths, turned)) * wider;
        limit.bend_error = times(square, without[2]) * rounding * wider;
        for (double* x : {&limit.remainder, &limit.bump, &limit.path, &limit.error, &limit.bend_error})
            if (std::isnan(*x) || !reach.any)
                *x = reach.any ? HUGE_VAL : 0;
        out.limits.push_back(limit);
    }
    return out;
}

} // namespace

TimedMotion character_motion(const Character& character, const Character::Animation& animation,
                             const DeformableSurface& surface, const Engine& engine)
{
    const auto motion = std::make_shared<const CharacterMotion>(character, animation, surface, engine);
    std::set<double> keys{animation.first_s, animation.last_s};
    for (const Curve& curve : animation.curves)
        for (const double t : curve.time_s)
            if (t > animation.first_s && t < animation.last_s)
                keys.insert(t);
    for (const WeightCurve& curve : animation.morphs)
        for (const double t : curve.time_s)
            if (t > animation.first_s && t < animation.last_s)
                keys.insert(t);
    TimedMotion out{animation.name,
                    {keys.begin(), keys.end()},
                    [motion](double t) { return motion->at(t); },
                    nullptr,
                    [motion](double a, double b) { return motion->over(a, b); }};
    if (motion->morphs())
        out.weights = [motion](double t) { return motion->weights(t); };
    return out;
}

} // namespace cinch
