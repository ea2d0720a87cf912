// SPDX-License-Identifier: GPL-3.0-or-later
// The moment bound in exact arithmetic: its identity, and what rounding makes of its parts.
#include <catch2/catch.hpp>

#include "cinch/refit.hpp"
#include "exact/optimum.hpp"
#include "tests/exact/lifted_exactly.hpp"
#include "toolkit/bounds/rounding.hpp"
#include "toolkit/hierarchy/lifted_points.hpp"

using namespace cinch;
using namespace cinch::exact;

namespace {

struct ExactRemainder {
    Exact s;
    Point<Exact> r;
};

// s_j and r_j for any numbers.
ExactRemainder remainder(const MomentFit& fit, const Vec3& z, const RestMoments& rest, const AffineMap& map,
                         const Axis& axis)
{
    const auto extremum_at = [&](const Vec3& x) { return extremum<Exact>(x, Vec3::Zero(), map, axis).plus; };
    const Exact at_zero = extremum_at(Vec3::Zero());
    Point<Exact> q, gz;
    for (int a = 0; a < 3; ++a)
        q[static_cast<std::size_t>(a)] = extremum_at(Vec3::Unit(a)) - at_zero;
    ExactRemainder out{extremum_at(rest.centre) - Exact(fit.phi), {}};
    for (std::size_t a = 0; a < 3; ++a) {
        const auto i = static_cast<int>(a);
        for (int b = 0; b < 3; ++b)
            gz[a] = gz[a] + Exact(fit.column[b][i]) * Exact(z[b]);
        out.r[a] = q[a] - (Exact(fit.linear[i]) - Exact(fit.g[i]) * Exact(1 / rest.unit)) - gz[a];
        out.s = out.s + half(Exact(rest.unit) * Exact(z[i]) * gz[a]) - Exact(fit.g[i]) * Exact(z[i]);
    }
    return out;
}

// Maps that are value and gradient of a quadratic motion at the places of the simulation nodes, as they are rounded.
std::vector<AffineMap> quadratic_maps(std::span<const Vec3> place, Random& random)
{
    Eigen::Matrix3d linear, quadratic[3];
    for (int i = 0; i < 9; ++i) {
        linear(i) = uniform(random, 1);
        for (auto& q : quadratic)
            q(i) = uniform(random, 1);
    }
    std::vector<AffineMap> maps;
    for (const Vec3& at : place) {
        AffineMap map;
        for (int r = 0; r < 3; ++r) {
            const Vec3 row = linear.row(r).transpose() + (quadratic[r] + quadratic[r].transpose()) * at;
            for (int s = 0; s < 3; ++s)
                map.m[r][s] = row[s];
            map.m[r][3] = linear.row(r).dot(at) + at.dot(quadratic[r] * at) - row.dot(at);
        }
        maps.push_back(map);
    }
    return maps;
}

// Maps that the moments follow exactly: linear parts are linear in the places, offsets quadratic. They change the more
// along z the flatter the places lie.
std::vector<AffineMap> maps_on_flat_places(std::span<const Vec3> place, double flat, Random& random)
{
    const Vec3 scale(1, 1, 1 / flat);
    std::vector<AffineMap> maps(place.size());
    for (int r = 0; r < 3; ++r) {
        Vec3 linear, offset;
        Eigen::Matrix3d change;
        for (int i = 0; i < 3; ++i) {
            linear[i] = uniform(random, 1);
            offset[i] = uniform(random, scale[i]);
            for (int s = 0; s < 3; ++s)
                change(s, i) = uniform(random, scale[i]);
        }
        for (std::size_t j = 0; j < place.size(); ++j) {
            const Vec3 row = linear + change * place[j];
            for (int s = 0; s < 3; ++s)
                maps[j].m[r][s] = row[s];
            maps[j].m[r][3] = offset.dot(place[j]) - 0.5 * place[j].dot(change * place[j]);
        }
    }
    return maps;
}

// Support of a BV's exact vertices, d as in axes_of(26).
Exact greatest_vertex(const MomentScene& scene, std::size_t bv, std::span<const AffineMap> maps, std::size_t d)
{
    Exact truth;
    bool any = false;
    for (const std::uint32_t k : scene.vertices(bv)) {
        const Exact own = along(deformed<Exact>(scene.e.surface.mesh.vertices[k], scene.e.surface.weights.of(k), maps),
                                all_axes[d / 2], d % 2 == 1);
        truth = !any || truth < own ? own : truth;
        any = true;
    }
    return truth;
}

// How much of their errors the parts need, with the numbers as they are computed: extrema on nodes, support of points.
std::pair<double, double> used_errors(const MomentScene& scene)
{
    double used_by_nodes = 0, used_by_points = 0;
    std::size_t finite = 0;
    const auto share = [](const Exact& off, double error) { return CGAL::to_double(absolute(off)) / error; };
    for (std::size_t bv = 0; bv < scene.bvh.bvs.size(); ++bv) {
        const RestBv rest = scene.bvh.rest(bv);
        const RestMoments moments = scene.moments(bv);
        std::vector<double> plus(rest.node.size()), minus(plus);
        for (const auto& frame : {scene.e.frames[1], scene.e.frames[2]})
            for (const Axis& axis : axes_of(14)) {
                const MomentFit fit = fit_moments(rest, moments, frame, axis);
                const double error = remainder_extrema(rest, moments, frame, axis, fit, plus, minus);
                if (!(error < infinite)) // its numbers overflow: there is no bound
                    continue;
                ++finite;
                for (std::size_t j = 0; j < rest.node.size(); ++j) {
                    const MomentInfluence& own = moments.influence[j];
                    const ExactRemainder exactly = remainder(fit, own.place, moments, frame[rest.node[j]], axis);
                    Exact position = exactly.s, radius(0);
                    for (int a = 0; a < 3; ++a) {
                        const Exact& r = exactly.r[static_cast<std::size_t>(a)];
                        position = position + r * Exact(own.local.centre[a]);
                        radius = radius + absolute(r) * Exact(own.local.half[a]);
                    }
                    used_by_nodes = std::max({used_by_nodes, share(radius + position - Exact(plus[j]), error),
                                              share(radius - position - Exact(minus[j]), error)});
                }
                const LiftedSupport support = lifted_support(moments, fit);
                Exact most, least;
                for (std::size_t i = 0; i < moments.point.size(); ++i) {
                    ExactLifted point;
                    for (std::size_t c = 0; c < lifted_size; ++c)
                        point[c] = Exact(moments.point[i][c]);
                    const Exact value = Exact(fit.phi) + times(fit.functional(), point);
                    most = i == 0 || most < value ? value : most;
                    least = i == 0 || value < least ? value : least;
                }
                Exact slack[2];
                for (std::size_t c = 0; c < lifted_size; ++c) {
                    const Exact up = Exact(fit.functional()[c]) * Exact(moments.greatest[c]),
                                down = Exact(fit.functional()[c]) * Exact(moments.least[c]);
                    slack[0] = slack[0] + maximum(up, down);
                    slack[1] = slack[1] + maximum(-up, -down);
                }
                used_by_points = std::max({used_by_points, share(most + slack[0] - Exact(support.along), support.error),
                                           share(slack[1] - least - Exact(support.against), support.error)});
            }
    }
    CHECK(finite > 0);
    return {used_by_nodes, used_by_points};
}

} // namespace

TEST_CASE("the identity of the moment bound holds for any numbers, exactly")
{
    const MomentScene scene(200, 20, 4);
    Random random(1);
    std::size_t checked = 0;
    for (std::size_t bv = 0; bv < scene.bvh.bvs.size(); bv += 3) {
        const RestBv rest = scene.bvh.rest(bv);
        const RestMoments moments = scene.moments(bv);
        for (const Axis& axis : {all_axes[0], all_axes[5], all_axes[12]}) {
            MomentFit fit = any_numbers(random, 1);
            fit.phi = uniform(random, 1);
            for (const std::uint32_t k : scene.vertices(bv)) {
                Exact sum = Exact(fit.phi) + times(fit.functional(), lifted(scene.e.surface, rest, moments, k));
                const Weights::Row row = scene.e.surface.weights.of(k);
                for (std::size_t i = 0; i < row.node.size(); ++i) {
                    const auto j = place_in(rest, row.node[i]);
                    const ExactRemainder own =
                        remainder(fit, moments.influence[j].place, moments, scene.e.frames[2][row.node[i]], axis);
                    Exact of_node = own.s;
                    for (int a = 0; a < 3; ++a)
                        of_node = of_node + own.r[static_cast<std::size_t>(a)] *
                                                (Exact(scene.e.surface.mesh.vertices[k][a]) - Exact(moments.centre[a]));
                    sum = sum + Exact(row.weight[i]) * of_node;
                }
                REQUIRE(sum ==
                        along(deformed<Exact>(scene.e.surface.mesh.vertices[k], row, scene.e.frames[2]), axis, false));
                ++checked;
            }
        }
    }
    CHECK(checked > 1000);
}

// What the errors allow is used to more than a hundredth, so that none is idle, and never beyond.
TEST_CASE("the parts of the moment bound are within their errors of exact arithmetic")
{
    const auto [used_by_nodes, used_by_points] = used_errors(MomentScene(200, 20, 4));
    CAPTURE(used_by_nodes, used_by_points);
    CHECK(used_by_nodes <= 1);
    CHECK(used_by_nodes > 0.02);
    CHECK(used_by_points <= 1);
    CHECK(used_by_points > 0.02);
}

TEST_CASE("the parts of the moment bound are within their errors where products underflow")
{
    for (const auto& [scale, stretch] : {std::pair(0x1p-535, 0x1p-535), std::pair(0x1p-900, 0x1p-170),
                                         std::pair(1.0, 0x1p-1050), std::pair(0x1p-500, 0x1p-570)}) {
        CAPTURE(scale, stretch);
        const auto [used_by_nodes, used_by_points] = used_errors(MomentScene(100, 12, 4, scale, stretch));
        CHECK(used_by_nodes <= 1);
        CHECK(used_by_points <= 1);
    }
}

// In exact arithmetic, but for the numbers that the parts are.
TEST_CASE("a moment bound is at least the sum of its parts and of all their errors")
{
    MomentScene scene(300, 60, 4);
    Random random(5);
    std::vector<AffineMap>& maps = scene.e.frames[2];
    for (AffineMap& map : maps) // rough, so that what is left to the simulation nodes is most of the bound
        for (auto& row : map.m)
            for (double& x : row)
                x = uniform(random, 1);
    const std::vector<double> bounds = scene.bounds(maps);
    for (std::size_t bv = 0; bv < scene.bvh.bvs.size(); ++bv) {
        const RestBv rest = scene.bvh.rest(bv);
        const RestMoments moments = scene.moments(bv);
        std::vector<double> plus(rest.node.size()), minus(plus);
        for (std::size_t a = 0; a < 13; ++a) {
            const MomentFit fit = fit_moments(rest, moments, maps, all_axes[a]);
            const LiftedSupport points = lifted_support(moments, fit);
            double world = 0; // of a vertex, along the axis
            for (const std::uint32_t j : rest.node) {
                double own = 0;
                for (std::size_t r = 0; r < 3; ++r)
                    for (int s = 0; s < 4; ++s)
                        own += std::abs(all_axes[a][r] * maps[j].m[r][s]) *
                               (s < 3 ? std::abs(rest.box.centre[s]) + rest.box.half[s] : 1);
                world = std::max(world, own);
            }
            const Exact error = Exact(remainder_extrema(rest, moments, maps, all_axes[a], fit, plus, minus)) +
                                Exact(points.error) + Exact(evaluation_error(rest.vertex_influences, 0.9999 * world));
            for (const bool against : {false, true}) {
                const std::vector<double>& b = against ? minus : plus;
                const auto most = optimum(rest.space, std::vector<Exact>(b.begin(), b.end()));
                REQUIRE(most);
                CHECK(Exact(against ? points.against : points.along) + most->value + error <=
                      Exact(bounds[bv * 26 + 2 * a + against]));
            }
        }
    }
}

// Where places lie nearly in a plane the gradient across it is large, and so is what kernels cancel: about their
// factor.
TEST_CASE("kernels have room for what they cancel where places are nearly coplanar and the motion is quadratic")
{
    Random random(8);
    MomentScene scene(200, 30, 8);
    scene.e.surface.place.clear();
    constexpr double flat = 0x1p-9; // of the places; the surface is round
    for (std::size_t j = 0; j < scene.e.surface.weights.node_count; ++j)
        scene.e.surface.place.emplace_back(uniform(random, 1), uniform(random, 1), flat * uniform(random, 1));
    double used = 0; // of the room, at most: the factor is hundreds, and needed
    for (std::size_t trial = 0; trial < test::share_of(4); ++trial) {
        const std::vector<AffineMap> maps = maps_on_flat_places(scene.e.surface.place, flat, random);
        for (const Precision precision : {Precision::float32, Precision::float64}) {
            std::vector<double> bounds(26 * scene.bvh.bvs.size()), plain(bounds);
            refit(scene.bvh, scene.e.surface, maps, {Method::moments, 26, Rounding::proven, precision}, bounds);
            refit(scene.bvh, scene.e.surface, maps, {Method::moments, 26, Rounding::plain, precision}, plain);
            for (std::size_t bv = 0; bv < scene.bvh.bvs.size(); ++bv)
                for (std::size_t d = 0; d < 26; ++d) {
                    const std::size_t place = bv * 26 + d;
                    const Exact truth = greatest_vertex(scene, bv, maps, d);
                    REQUIRE(truth <= Exact(bounds[place]));
                    used =
                        std::max(used, CGAL::to_double(truth - Exact(plain[place])) / (bounds[place] - plain[place]));
                }
        }
    }
    CAPTURE(used);
    CHECK(used > 0.001);
}

TEST_CASE("a quadratic motion is bounded by the moments to within the rounding of places, whatever the weights")
{
    Random random(4);
    MomentScene scene(200, 30, 8);
    scene.e.surface.place.clear();
    for (std::size_t j = 0; j < scene.e.surface.weights.node_count; ++j)
        scene.e.surface.place.emplace_back(uniform(random, 1), uniform(random, 1), uniform(random, 1));
    scene.data = rest_moments(scene.bvh, scene.e.surface);
    std::size_t tight = 0;
    for (int trial = 0; trial < 2; ++trial) {
        const std::vector<AffineMap> maps = quadratic_maps(scene.e.surface.place, random);
        const std::vector<double> bounds = scene.bounds(maps);
        for (std::size_t bv = 0; bv < scene.bvh.bvs.size(); ++bv) {
            const std::size_t vertices = scene.vertices(bv).size();
            for (std::size_t d = 0; d < 26; ++d) {
                const Exact truth = greatest_vertex(scene, bv, maps, d);
                const std::size_t place = bv * 26 + d;
                REQUIRE(truth <= Exact(bounds[place]));
                if (vertices > lifted_points_of(vertices))
                    continue;
                REQUIRE(bounds[place] - CGAL::to_double(truth) < 1e-6);
                ++tight;
            }
        }
    }
    CHECK(tight > 500);
}
