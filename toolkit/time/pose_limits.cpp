// SPDX-License-Identifier: Apache-2.0
#include "toolkit/time/pose_limits.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "toolkit/time/bone_path.hpp"
#include "toolkit/time/character_motion.hpp"
#include "toolkit/time/norm.hpp"

namespace cinch {
namespace {

constexpr double upward = 1 + 0x1p-40; // more than what a handful of roundings of sums of positive numbers lose

// At least ‖M‖₂: that of M transposed times M is at most its greatest sum of a row.
double greatest_stretch(const Eigen::Matrix3d& m)
{
    const double greatest = m.cwiseAbs().maxCoeff();
    if (!(greatest > 0 && greatest < HUGE_VAL))
        return greatest;
    const double scale = std::exp2(-std::ilogb(greatest)); // squares must not vanish; 1022 is not reached below
    const Eigen::Matrix3d scaled = m * std::min(scale, 0x1p1000), square = (scaled.transpose() * scaled).cwiseAbs();
    return std::sqrt(square.rowwise().sum().maxCoeff()) / std::min(scale, 0x1p1000) * upward;
}

double times(double x, double y) { return x == 0 || y == 0 ? 0 : x * y; }

// How far the vertices of every joint may be off.
std::vector<double> displacements(const Character& character, std::span<const PoseLimit> limits,
                                  const DeformableSurface& surface)
{
    std::vector<BonePath::Jet> jets;
    for (const Bone& bone : character.bones)
        jets.push_back(BonePath(bone, {}, 0, {}).at(0));
    const std::vector<Reach> reach = reaches(surface);
    std::vector<double> displaced(reach.size(), 0); // by morph targets
    for (std::size_t i = 0; i < character.targets.size(); ++i) {
        std::vector<double> most(reach.size(), 0);
        const MorphTarget& target = character.targets[i];
        for (std::size_t n = 0; n < target.vertex.size(); ++n) {
            const double far = norm_of(target.displacement[n]) + (target.half.empty() ? 0 : norm_of(target.half[n]));
            for (const std::uint32_t j : surface.weights.of(target.vertex[n]).node)
                most[j] = std::max(most[j], far);
        }
        for (std::size_t j = 0; j < reach.size(); ++j)
            displaced[j] += times(std::abs(character.target_weights[i]), most[j]) * upward;
    }
    std::vector<double> out;
    for (std::size_t j = 0; j < reach.size(); ++j) {
        const Joint& joint = character.joints[j];
        Eigen::Matrix3d bind;
        for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 3; ++c)
                bind(r, c) = joint.inverse_bind.m[r][c];
        Vec3 centre = apply(joint.inverse_bind, reach[j].centre);
        double radius = times(greatest_stretch(bind), reach[j].radius + displaced[j]) * upward, off = 0;
        for (std::int64_t at = joint.bone; at >= 0; at = character.bones[static_cast<std::size_t>(at)].parent) {
            const BonePath::Jet& jet = jets[static_cast<std::size_t>(at)];
            const PoseLimit& limit = limits[static_cast<std::size_t>(at)];
            const double stretch = greatest_stretch(jet.m[0]);
            const Vec3 turned = jet.m[0] * centre;
            radius = times(stretch, radius) * upward;
            const double chord = 2 * std::sin(std::min(limit.angle, std::numbers::pi) / 2);
            off = (limit.move + times(stretch, off) + times(chord, norm_of(turned) + radius)) * upward;
            centre = turned + jet.p[0];
        }
        // What the centres were off by, link by link: a few roundings each of what the points' distances add up to
        // without cancelling, of which the still pose's own `error` has 2^-43 per link and uses a quarter.
        out.push_back(reach[j].any ? off * upward : 0);
    }
    return out;
}

} // namespace

TimedMotion poses_within(const Character& character, std::span<const PoseLimit> limits,
                         const DeformableSurface& surface)
{
    if (limits.size() != character.bones.size())
        throw std::invalid_argument("poses_within: one limit per bone is needed");
    for (const PoseLimit& limit : limits)
        if (!(limit.angle >= 0 && limit.move >= 0))
            throw std::invalid_argument("poses_within: limits from 0 on are needed");
    const TimedMotion still = character_motion(character, character.rest, surface);
    const std::vector<double> off = displacements(character, limits, surface);
    TimedMotion out = still;
    out.name = "poses";
    out.over = [over = still.over, off, t = still.first_s()](double, double) {
        MotionInterval interval = over(t, t);
        for (std::size_t j = 0; j < off.size(); ++j) {
            double& error = interval.limits[j].error;
            error = error + off[j] < HUGE_VAL ? (error + off[j]) * (1 + 0x1p-50) : HUGE_VAL;
        }
        return interval;
    };
    return out;
}

} // namespace cinch
