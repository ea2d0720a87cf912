// SPDX-License-Identifier: GPL-3.0-or-later
// Bounds for all poses within limits of random characters: proven by the exact side, and refuted by it where the limits
// that they were made for are smaller.
#include <cmath>
#include <random>

#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include "exact/pose_check.hpp"
#include "experiments/fuzz/time_case.hpp"
#include "tests/support.hpp"
#include "toolkit/time/bound_over.hpp"

using namespace cinch;

namespace {

std::vector<double> bounds_of(const TimeCase& subject, const Character& character, std::span<const PoseLimit> limits,
                              const RefitOptions& options)
{
    const TimedMotion motion = poses_within(character, limits, subject.surface);
    IntervalRefitter refit(subject.bvh, subject.surface, options, character.targets);
    std::vector<double> supports(subject.bvh.bvs.size() * static_cast<std::size_t>(options.kdop));
    bound_over(refit, motion, motion.first_s(), motion.last_s(), 0.01, supports);
    return supports;
}

struct Link {
    Eigen::Matrix3d m;
    Vec3 t;
    double stretch, lever;
};

// In plain doubles: bones as the file has them, with their greatest stretches and those of the bones above.
std::vector<Link> links_of(const Character& character)
{
    std::vector<Link> out;
    for (const Bone& bone : character.bones) {
        Link link;
        if (bone.is_matrix) {
            const Eigen::Map<const Eigen::Matrix4d> m(bone.matrix.data());
            link = {m.topLeftCorner<3, 3>(), m.topRightCorner<3, 1>(), 0, 1};
            link.stretch = std::sqrt((link.m.transpose() * link.m).cwiseAbs().rowwise().sum().maxCoeff());
        } else {
            const auto& q = bone.rotation;
            const Eigen::Quaterniond turn(q[3], q[0], q[1], q[2]);
            const Vec3 scale(bone.scale.data());
            link = {(turn.norm() > 0 ? turn.normalized() : Eigen::Quaterniond::Identity()).toRotationMatrix() *
                        scale.asDiagonal(),
                    Vec3(bone.translation.data()), scale.cwiseAbs().maxCoeff(), 1};
        }
        if (bone.parent >= 0)
            link.lever =
                out[static_cast<std::size_t>(bone.parent)].lever * out[static_cast<std::size_t>(bone.parent)].stretch;
        out.push_back(link);
    }
    return out;
}

// What poses may have along an axis at a vertex, by the formula of PoseChecker in plain doubles. `weights`: of all
// morph targets, or none.
double reach_in_poses(const TimeCase& subject, std::span<const PoseLimit> limits,
                      const std::optional<exact::Enclosure>& weights, std::uint32_t vertex, const Vec3& axis)
{
    const Character& of = subject.character;
    const std::vector<Link> links = links_of(of);
    Vec3 y = subject.surface.mesh.vertices[vertex], low = Vec3::Zero(), high = Vec3::Zero();
    std::vector<Vec3> by;
    for (std::size_t i = 0; i < of.targets.size(); ++i)
        for (std::size_t n = 0; n < of.targets[i].vertex.size(); ++n)
            if (of.targets[i].vertex[n] == vertex) {
                const Vec3& d = of.targets[i].displacement[n];
                if (!weights) {
                    y += of.target_weights[i] * d;
                    continue;
                }
                by.push_back(d);
                low += (weights->low * d).cwiseMin(weights->high * d);
                high += (weights->low * d).cwiseMax(weights->high * d);
            }
    const Weights::Row row = subject.surface.weights.of(vertex);
    Vec3 place = Vec3::Zero(), g = Vec3::Zero();
    double off = 0;
    for (std::size_t n = 0; n < row.node.size(); ++n) {
        const Joint& joint = of.joints[row.node[n]];
        Eigen::Matrix3d bind;
        for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 3; ++c)
                bind(r, c) = joint.inverse_bind.m[r][c];
        Vec3 x = apply(joint.inverse_bind, y);
        Eigen::Matrix3d whole = bind;
        double ball = std::sqrt((bind.transpose() * bind).cwiseAbs().rowwise().sum().maxCoeff()) *
                      low.cwiseAbs().cwiseMax(high.cwiseAbs()).norm();
        for (std::int64_t at = joint.bone; at >= 0; at = of.bones[static_cast<std::size_t>(at)].parent) {
            const Link& link = links[static_cast<std::size_t>(at)];
            const PoseLimit& limit = limits[static_cast<std::size_t>(at)];
            const double chord = limit.angle >= 3.141592653589793 ? 2 : 2 * std::sin(limit.angle / 2);
            ball *= link.stretch;
            off += row.weight[n] * link.lever * (limit.move + chord * ((link.m * x).norm() + ball));
            x = link.m * x + link.t;
            whole = link.m * whole;
        }
        place += row.weight[n] * x;
        g += row.weight[n] * whole.transpose() * axis;
    }
    double reach = axis.dot(place) + axis.norm() * off;
    for (const Vec3& d : by)
        reach += std::max(weights->low * g.dot(d), weights->high * g.dot(d));
    return reach;
}

} // namespace

TEST_CASE("a support of poses is proven from what the farthest vertex may reach on, and not below")
{
    std::mt19937_64 random(31);
    auto between = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
    for (std::size_t i = 0, cases = test::share_of(60); i < cases; ++i) {
        TimeCase subject = draw_time_case(random());
        subject.character.rest.curves.clear();
        subject.character.rest.morphs.clear();
        std::vector<PoseLimit> limits;
        for (std::size_t b = 0; b < subject.character.bones.size(); ++b) {
            limits.push_back({between(0, 4), between(0, 0.5)});
            if (random() % 2 == 0)
                subject.character.bones[b].scale = {between(0.3, 3), between(-3, -0.3), between(0.3, 3)};
        }
        for (const bool any : {false, true}) {
            const std::optional<exact::Enclosure> weights =
                any ? std::optional(exact::Enclosure{-0.5, 1}) : std::nullopt;
            const exact::PoseChecker check(subject.surface, subject.bvh, subject.character, limits, weights, 26, [] {});
            for (std::size_t d = 0; d < 26; ++d) {
                const auto& g = axes_of(26)[d / 2];
                const Vec3 axis = (d % 2 ? -1.0 : 1.0) * Vec3(g[0], g[1], g[2]);
                double most = -HUGE_VAL, size = 0;
                for (std::uint32_t v = 0; v < subject.surface.mesh.vertices.size(); ++v) {
                    most = std::max(most, reach_in_poses(subject, limits, weights, v, axis));
                    size = std::max(size, std::abs(most));
                }
                std::vector<double> supports(subject.bvh.bvs.size() * 26, HUGE_VAL);
                CAPTURE(i, any, d, most);
                supports[d] = most + 1e-9 * size;
                CHECK(check(supports).proven() == supports.size());
                supports[d] = most - 1e-9 * size;
                CHECK(check(supports).proven() < supports.size());
            }
        }
    }
}

TEST_CASE("bounds of all poses within limits are proven, those of smaller limits refuted")
{
    std::mt19937_64 random(23);
    auto between = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
    std::size_t refuted[2] = {}, cases = test::share_of(120), bounds = 0;
    for (std::size_t i = 0; i < cases; ++i) {
        TimeCase subject = draw_time_case(random());
        subject.character.rest.curves.clear();
        subject.character.rest.morphs.clear();
        const bool any = i % 3 == 2 && !subject.character.targets.empty();
        const std::optional<exact::Enclosure> any_weights =
            any ? std::optional(exact::Enclosure{-0.5, 1}) : std::nullopt;
        const Character bounded = any ? with_any_weights(Character(subject.character), -0.5, 1) : subject.character;
        std::vector<PoseLimit> limits, smaller;
        for (std::size_t b = 0; b < bounded.bones.size(); ++b) {
            const double angles[] = {
                0, between(0, 1e-3), between(0, 1), between(0, 3.14159265358979), 0x1p-60, 0x1.921fb54442d18p+1, 4};
            limits.push_back({angles[random() % 7], random() % 2 ? 0 : between(0, 0.2)});
            smaller.push_back({limits[b].angle / 4, limits[b].move / 4});
        }
        const RefitOptions options{.methods = i % 3 == 0 ? Method::local : Method::best,
                                   .kdop = kdops[i % kdops.size()],
                                   .precision = i % 2 ? Precision::float64 : Precision::float32};
        const exact::PoseChecker check(subject.surface, subject.bvh, subject.character, limits, any_weights,
                                       options.kdop, [] {});
        CAPTURE(i, any);
        const exact::TimeVerdict verdict = check(bounds_of(subject, bounded, limits, options));
        CHECK(verdict.violated == 0);
        CHECK(verdict.undecided == 0);
        bounds += verdict.bounds;
        // A quarter of the limits; and none at all of the first bone, which carries the others.
        refuted[0] += check(bounds_of(subject, bounded, smaller, options)).violated > 0;
        smaller = limits;
        smaller[0] = {};
        refuted[1] += check(bounds_of(subject, bounded, smaller, options)).violated > 0;
    }
    INFO(bounds << " bounds, of " << cases << " refuted " << refuted[0] << " and " << refuted[1]);
    CHECK((cases < 12 || refuted[0] > cases / 6)); // a few may have none
    CHECK((cases < 12 || refuted[1] > cases / 6)); // a few may have none
}
