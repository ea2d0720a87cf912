// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/pose_check.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <Eigen/Geometry>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "exact/along.hpp"
#include "exact/clip_enclosure.hpp"
#include "exact/sin_cos.hpp"

namespace cinch::exact {
namespace {

constexpr std::size_t most_poses = 200;

Interval size_of(const Place& x) { return CGAL::sqrt(CGAL::square(x[0]) + CGAL::square(x[1]) + CGAL::square(x[2])); }

Place linear(const MapEnclosure& map, const Place& x)
{
    Place out;
    for (std::size_t r = 0; r < 3; ++r)
        out[r] = interval_of(map.m[r][0]) * x[0] + interval_of(map.m[r][1]) * x[1] + interval_of(map.m[r][2]) * x[2];
    return out;
}
MapEnclosure enclosure_of(const AffineMap& map)
{
    MapEnclosure out;
    for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 4; ++c)
            out.m[r][c] = {map.m[r][c], map.m[r][c]};
    return out;
}
Place shifted(const MapEnclosure& map, const Place& x)
{
    return {x[0] + interval_of(map.m[0][3]), x[1] + interval_of(map.m[1][3]), x[2] + interval_of(map.m[2][3])};
}

// At least ‖M‖₂: of MᵀM the root of the greatest sum of a row.
Interval stretch_of(const MapEnclosure& map)
{
    double most = 0;
    for (std::size_t a = 0; a < 3; ++a) {
        Interval row(0);
        for (std::size_t b = 0; b < 3; ++b) {
            Interval entry(0);
            for (std::size_t r = 0; r < 3; ++r)
                entry += interval_of(map.m[r][a]) * interval_of(map.m[r][b]);
            row += absolute(entry);
        }
        most = std::max(most, row.sup());
    }
    return CGAL::sqrt(Interval(most));
}

// Of a rotation after a scale its greatest factor.
Interval stretch_of(const Bone& bone, const MapEnclosure& map)
{
    if (bone.is_matrix)
        return stretch_of(map);
    const auto& s = bone.scale;
    return Interval(std::max({std::abs(s[0]), std::abs(s[1]), std::abs(s[2])}));
}

// 2 sin(angle/2) of a rotation by at most so much. The double next to π is below it.
Interval chord_of(double angle)
{
    return angle >= std::numbers::pi ? Interval(2) : 2 * minimum(sin_cos(Interval(angle) / 2).sin, Interval(1));
}

// Bones as the file has them, with what poses may do to each.
struct Links {
    std::vector<MapEnclosure> map;
    std::vector<Interval> stretch, chord, move, lever; // lever: the stretches of the bones above

    Links(std::span<const Bone> bones, std::span<const PoseLimit> limits)
    {
        for (std::size_t i = 0; i < bones.size(); ++i) { // parents come first
            map.push_back(bone_enclosure(bones[i]));
            stretch.push_back(stretch_of(bones[i], map[i]));
            chord.push_back(chord_of(limits[i].angle));
            move.emplace_back(limits[i].move);
            const std::int64_t above = bones[i].parent;
            lever.push_back(above < 0 ? Interval(1)
                                      : Interval(lever[static_cast<std::size_t>(above)] *
                                                 stretch[static_cast<std::size_t>(above)]));
        }
    }
};

Interval length_of(const Axis& axis)
{
    return CGAL::sqrt(Interval(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]));
}

Eigen::Matrix3d middle_of(const MapEnclosure& map)
{
    Eigen::Matrix3d out;
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c)
            out(r, c) = map.m[r][c].low / 2 + map.m[r][c].high / 2;
    return out;
}

// That R(to) is R(from) turned by at most the angle: the cosine of half of it is |from·to|/(|from||to|).
bool is_within(const std::array<double, 4>& from, const std::array<double, 4>& to, double angle)
{
    if (angle >= std::numbers::pi)
        return true;
    const DirectedRounding rounding;
    Interval dot(0), one(0), other(0);
    for (std::size_t i = 0; i < 4; ++i) {
        dot += Interval(from[i]) * Interval(to[i]);
        one += CGAL::square(Interval(from[i]));
        other += CGAL::square(Interval(to[i]));
    }
    const Interval cosine = sin_cos(Interval(angle) / 2).cos;
    return certainly(CGAL::square(dot) >= CGAL::square(cosine) * one * other) && other.inf() > 0;
}
bool is_within(const Vec3& from, const Vec3& to, double move)
{
    const DirectedRounding rounding;
    Interval sum(0);
    for (int r = 0; r < 3; ++r)
        sum += CGAL::square(Interval(to[r]) - Interval(from[r]));
    return certainly(sum <= CGAL::square(Interval(move)));
}

} // namespace

// A vertex and a direction of which it is not shown that all poses stay below the support.
struct PoseChecker::Open {
    std::uint32_t place; // in vertices_
    std::size_t direction;
    double reach;  // no pose has more
    double excess; // over the least support, or infinite
};

PoseChecker::PoseChecker(const DeformableSurface& surface, const Bvh& bvh, const Character& character,
                         std::span<const PoseLimit> limits, std::optional<Enclosure> any_weights, int kdop,
                         std::function<void()> poll)
    : surface_(surface), character_(character), limits_(limits), any_weights_(any_weights), kdop_(kdop),
      poll_(std::move(poll)), vertices_(surface, bvh), displaced_(character.targets, surface.mesh.vertices.size())
{
    if (limits.size() != character.bones.size())
        throw std::invalid_argument("PoseChecker: one limit per bone is needed");
}

std::vector<PoseChecker::Open> PoseChecker::not_proven(const std::vector<double>& least) const
{
    const ClipEnclosure still(character_, character_.rest, any_weights_);
    std::vector<MapEnclosure> maps, slopes;
    std::vector<Enclosure> weights, weight_slopes;
    still.at(0, 0, 0, 0, maps, slopes);
    still.weights_at(0, 0, 0, 0, weights, weight_slopes);
    const Links links = [&] {
        const DirectedRounding rounding;
        return Links(character_.bones, limits_);
    }();
    const auto axes = axes_of(kdop_);
    const std::size_t k = 2 * axes.size();
    tbb::enumerable_thread_specific<std::vector<Open>> found;
    tbb::parallel_for(
        tbb::blocked_range<std::uint32_t>(0, static_cast<std::uint32_t>(vertices_.vertex.size()), 64),
        [&](const auto& range) {
            const DirectedRounding rounding;
            for (std::uint32_t i = range.begin(); i < range.end(); ++i) {
                const std::uint32_t v = vertices_.vertex[i];
                const Vec3& rest = surface_.mesh.vertices[v];
                const Weights::Row row = surface_.weights.of(v);
                // Where weights of targets are known the vertex is one point, else that and a ball.
                Place y{Interval(rest[0]), Interval(rest[1]), Interval(rest[2])},
                    by{Interval(0), Interval(0), Interval(0)};
                add_displacement(displaced_.of(v), weights, any_weights_ ? by : y);
                Interval off(0); // how far poses put it from where it is
                for (std::size_t n = 0; n < row.node.size(); ++n) {
                    const Joint& joint = character_.joints[row.node[n]];
                    const MapEnclosure bind = enclosure_of(joint.inverse_bind);
                    Place x = shifted(bind, linear(bind, y));
                    Interval ball = stretch_of(bind) * size_of(by), of_joint(0);
                    for (std::int64_t at = joint.bone; at >= 0;
                         at = character_.bones[static_cast<std::size_t>(at)].parent) {
                        const auto b = static_cast<std::size_t>(at);
                        const Place turned = linear(links.map[b], x);
                        ball *= links.stretch[b];
                        of_joint += links.lever[b] * (links.move[b] + links.chord[b] * (size_of(turned) + ball));
                        x = shifted(links.map[b], turned);
                    }
                    off += Interval(row.weight[n]) * of_joint;
                }
                for (std::size_t d = 0; d < k; ++d) {
                    const double limit = least[i * k + d];
                    if (limit == HUGE_VAL)
                        continue;
                    const Along g(row, maps, axes[d / 2], d % 2 == 1);
                    const Interval reach = g.of(rest) + g.shift + displaced_along(g, displaced_.of(v), weights, true) +
                                           length_of(axes[d / 2]) * off;
                    if (const double most = reach.sup(); !(most <= limit))
                        found.local().push_back({i, d, most, most - limit < HUGE_VAL ? most - limit : HUGE_VAL});
                }
            }
        });
    std::vector<Open> out;
    for (const std::vector<Open>& some : found)
        out.insert(out.end(), some.begin(), some.end());
    std::sort(out.begin(), out.end(), [](const Open& a, const Open& b) {
        return a.excess != b.excess ? a.excess > b.excess
               : a.place != b.place ? a.place < b.place
                                    : a.direction < b.direction;
    });
    return out;
}

// Each bone above the joint of its greatest weight, from the root down, turned and moved toward the direction as the
// bones above left it; those that are not shown to stay within their limits are as the file has them.
Character PoseChecker::posed_toward(const Open& open) const
{
    Character out = character_;
    const std::uint32_t v = vertices_.vertex[open.place];
    const Weights::Row row = surface_.weights.of(v);
    const Joint& joint = character_.joints[row.node[static_cast<std::size_t>(
        std::max_element(row.weight.begin(), row.weight.end()) - row.weight.begin())]];
    const auto& axis = axes_of(kdop_)[open.direction / 2];
    Vec3 toward(axis[0], axis[1], axis[2]);
    toward *= open.direction % 2 ? -1 : 1;
    std::vector<std::size_t> chain; // from the joint to the root
    std::vector<Vec3> turned;       // M x of each
    Vec3 x = apply(joint.inverse_bind, surface_.mesh.vertices[v]);
    std::vector<Eigen::Matrix3d> matrix;
    for (std::int64_t at = joint.bone; at >= 0; at = character_.bones[static_cast<std::size_t>(at)].parent) {
        const MapEnclosure map = bone_enclosure(character_.bones[static_cast<std::size_t>(at)]);
        chain.push_back(static_cast<std::size_t>(at));
        matrix.push_back(middle_of(map));
        turned.push_back(matrix.back() * x);
        x = turned.back() + Vec3(map.m[0][3].low, map.m[1][3].low, map.m[2][3].low);
    }
    constexpr double inside = 1 - 0x1p-20;
    for (std::size_t i = chain.size(); i-- > 0;) {
        Bone& bone = out.bones[chain[i]];
        const PoseLimit& limit = limits_[chain[i]];
        toward.normalize();
        Vec3 translation(bone.translation[0], bone.translation[1], bone.translation[2]);
        const Vec3 moved = translation + inside * limit.move * toward;
        if (!bone.is_matrix && is_within(translation, moved, limit.move))
            for (int r = 0; r < 3; ++r)
                bone.translation[static_cast<std::size_t>(r)] = moved[r];
        const Vec3 about = turned[i].cross(toward);
        const double between = std::atan2(about.norm(), turned[i].dot(toward));
        if (!bone.is_matrix && about.norm() > 0) {
            const auto& q = bone.rotation;
            const Eigen::Quaterniond from(q[3], q[0], q[1], q[2]);
            const Eigen::AngleAxisd turn(std::min(between, inside * limit.angle), about.normalized());
            const Eigen::Quaterniond to =
                Eigen::Quaterniond(turn) * (from.norm() > 0 ? from.normalized() : Eigen::Quaterniond::Identity());
            const std::array<double, 4> was =
                from.norm() > 0 ? std::array<double, 4>{q[0], q[1], q[2], q[3]} : std::array<double, 4>{0, 0, 0, 1};
            if (const std::array<double, 4> now{to.x(), to.y(), to.z(), to.w()}; is_within(was, now, limit.angle)) {
                bone.rotation = now;
                toward = turn.toRotationMatrix().transpose() * toward;
            }
        }
        toward = matrix[i].transpose() * toward;
        if (!(toward.norm() > 0))
            break;
    }
    return out;
}

TimeVerdict PoseChecker::operator()(std::span<const double> supports) const
{
    const auto k = static_cast<std::size_t>(kdop_);
    const auto axes = axes_of(kdop_);
    TimeVerdict out;
    out.bounds = supports.size();
    const std::vector<double> least = vertices_.least(supports, k);
    std::vector<Open> open = not_proven(least);
    std::vector<char> refuted(supports.size()), left_open(supports.size());
    // The vertex reaches that much in some pose.
    auto mark = [&](const Open& of, double at_least) {
        for (std::uint32_t at = vertices_.row[of.place]; at < vertices_.row[of.place + 1]; ++at) {
            const std::size_t bound = vertices_.bv[at] * k + of.direction;
            if (supports[bound] >= of.reach)
                continue;
            (supports[bound] >= at_least ? left_open : refuted)[bound] = true;
            if (supports[bound] < at_least &&
                (!out.worst || at_least - supports[bound] > out.worst->at_least - out.worst->bound))
                out.worst = Outside{vertices_.bv[at], of.direction,    vertices_.vertex[of.place],
                                    std::nan(""),     supports[bound], at_least};
        }
    };
    std::vector<char> tried(least.size());
    for (std::size_t i = 0; i < open.size() && out.pieces < most_poses;) {
        poll_();
        const Open& toward = open[i];
        if (tried[toward.place * k + toward.direction]) {
            ++i;
            continue;
        }
        tried[toward.place * k + toward.direction] = true;
        ++out.pieces;
        const Character pose = posed_toward(toward);
        const ClipEnclosure clip(pose, pose.rest, any_weights_);
        std::vector<MapEnclosure> maps, slopes;
        std::vector<Enclosure> weights, weight_slopes;
        clip.at(0, 0, 0, 0, maps, slopes);
        clip.weights_at(0, 0, 0, 0, weights, weight_slopes);
        std::vector<std::pair<Open, double>> beyond;
        {
            const DirectedRounding rounding;
            std::erase_if(open, [&](const Open& of) {
                const std::uint32_t v = vertices_.vertex[of.place];
                const Along g(surface_.weights.of(v), maps, axes[of.direction / 2], of.direction % 2 == 1);
                const double at_least =
                    (g.of(surface_.mesh.vertices[v]) + g.shift + displaced_along(g, displaced_.of(v), weights, true))
                        .inf();
                if (!(at_least > least[of.place * k + of.direction]))
                    return false;
                beyond.emplace_back(of, at_least);
                return true;
            });
        }
        for (const auto& [of, at_least] : beyond)
            mark(of, at_least);
        i = 0; // those before it were tried, or are gone
    }
    for (const Open& of : open)
        mark(of, -HUGE_VAL);
    for (std::size_t i = 0; i < refuted.size(); ++i) {
        out.violated += refuted[i] != 0;
        out.undecided += left_open[i] && !refuted[i];
    }
    return out;
}

} // namespace cinch::exact
