// SPDX-License-Identifier: GPL-3.0-or-later
// The moment bound in exact arithmetic: its identity, its rest data, and what rounding makes of its parts.
#include <random>

#include <CGAL/QP_functions.h>
#include <CGAL/QP_models.h>
#include <catch2/catch.hpp>

#include "cinch/refit.hpp"
#include "exact/formulas.hpp"
#include "tests/support.hpp"
#include "toolkit/bounds/bound_moments.hpp"
#include "toolkit/hierarchy/lifted_points.hpp"
#include "toolkit/hierarchy/moments.hpp"

using namespace cinch;
using namespace cinch::exact;

namespace {

using Random = std::mt19937_64;
using ExactLifted = std::array<Exact, lifted_size>;

double uniform(Random& random, double most) { return most * (static_cast<double>(random() >> 11) * 0x1p-52 - 1); }
Exact half(const Exact& x) { return x * Exact(0.5); }

std::size_t place_in(const RestBv& bv, std::uint32_t node)
{
    return static_cast<std::size_t>(std::lower_bound(bv.node.begin(), bv.node.end(), node) - bv.node.begin());
}

// Of vertex k: written from the definition, d and all moments exactly.
ExactLifted lifted(const DeformableSurface& surface, const RestBv& bv, const RestMoments& rest, std::uint32_t k)
{
    Exact d[3], xi[3], m[3][3];
    for (int a = 0; a < 3; ++a)
        d[a] = Exact(surface.mesh.vertices[k][a]) - Exact(rest.centre[a]);
    const Weights::Row row = surface.weights.of(k);
    for (std::size_t i = 0; i < row.node.size(); ++i) {
        const std::size_t j = place_in(bv, row.node[i]);
        const Vec3& z = rest.influence[j].place;
        for (int a = 0; a < 3; ++a) {
            xi[a] = xi[a] + Exact(row.weight[i]) * Exact(z[a]);
            for (int b = 0; b < 3; ++b)
                m[a][b] = m[a][b] + Exact(row.weight[i]) * Exact(z[a]) * Exact(z[b]);
        }
    }
    const auto both = [&](int a, int b) { return d[a] * xi[b] + d[b] * xi[a] - m[a][b]; };
    return {d[0],
            d[1],
            d[2],
            xi[0] - d[0],
            xi[1] - d[1],
            xi[2] - d[2],
            half(both(0, 0)),
            half(both(1, 1)),
            half(both(2, 2)),
            both(0, 1),
            both(0, 2),
            both(1, 2),
            d[1] * xi[2] - d[2] * xi[1],
            d[2] * xi[0] - d[0] * xi[2],
            d[0] * xi[1] - d[1] * xi[0]};
}

struct ExactRemainder {
    Exact s;
    Point<Exact> r;
};

// s_j and r_j for any numbers.
ExactRemainder remainder(const MomentFit& fit, const Vec3& z, const Vec3& centre, const AffineMap& map,
                         const Axis& axis)
{
    const auto extremum_at = [&](const Vec3& x) { return extremum<Exact>(x, Vec3::Zero(), map, axis).plus; };
    const Exact at_zero = extremum_at(Vec3::Zero());
    Point<Exact> q, hz;
    for (int a = 0; a < 3; ++a)
        q[static_cast<std::size_t>(a)] = extremum_at(Vec3::Unit(a)) - at_zero;
    ExactRemainder out{extremum_at(centre) - Exact(fit.phi), {}};
    for (std::size_t a = 0; a < 3; ++a) {
        const auto i = static_cast<int>(a);
        for (int b = 0; b < 3; ++b) {
            const double h = i == b ? fit.diagonal[i] : fit.beside[i + b == 1 ? 0 : i + b == 2 ? 1 : 2];
            hz[a] = hz[a] + Exact(h) * Exact(z[b]);
        }
        const int n = (i + 1) % 3, l = (i + 2) % 3;
        out.r[a] = q[a] - (Exact(fit.linear[i]) - Exact(fit.g[i])) - hz[a] -
                   (Exact(z[n]) * Exact(fit.k[l]) - Exact(z[l]) * Exact(fit.k[n]));
        out.s = out.s + half(Exact(z[i]) * hz[a]) - Exact(fit.g[i]) * Exact(z[i]);
    }
    return out;
}

Exact times(const Lifted& functional, const ExactLifted& x)
{
    Exact sum(0);
    for (std::size_t c = 0; c < lifted_size; ++c)
        sum = sum + Exact(functional[c]) * x[c];
    return sum;
}

struct Scene {
    explicit Scene(std::size_t vertices, std::size_t nodes, std::size_t leaf)
        : e(test::example(vertices, nodes)), bvh(build_bvh(e.surface, leaf)), data(rest_moments(bvh, e.surface))
    {
    }
    RestMoments moments(std::size_t bv) const { return data.of(bvh.bvs[bv], bv); }
    std::vector<std::uint32_t> vertices(std::size_t bv) const { return vertices_of(e.surface, bvh, bvh.bvs[bv]); }

    test::Example e;
    Bvh bvh;
    MomentData data;
};

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

} // namespace

TEST_CASE("the identity of the moment bound holds for any numbers, exactly")
{
    const Scene scene(200, 20, 4);
    Random random(1);
    std::size_t checked = 0;
    for (std::size_t bv = 0; bv < scene.bvh.bvs.size(); bv += 3) {
        const RestBv rest = scene.bvh.rest(bv);
        const RestMoments moments = scene.moments(bv);
        for (const Axis& axis : {all_axes[0], all_axes[5], all_axes[12]}) {
            MomentFit fit;
            fit.phi = uniform(random, 1);
            for (Vec3* vector : {&fit.linear, &fit.g, &fit.k, &fit.diagonal, &fit.beside})
                for (double& x : *vector)
                    x = uniform(random, 1);
            for (const std::uint32_t k : scene.vertices(bv)) {
                Exact sum = Exact(fit.phi) + times(fit.functional(), lifted(scene.e.surface, rest, moments, k));
                const Weights::Row row = scene.e.surface.weights.of(k);
                for (std::size_t i = 0; i < row.node.size(); ++i) {
                    const auto j = place_in(rest, row.node[i]);
                    const ExactRemainder own = remainder(fit, moments.influence[j].place, moments.centre,
                                                         scene.e.frames[2][row.node[i]], axis);
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

TEST_CASE("every vertex of a BV lies in its nodes' local boxes about the centre, and lifted within the slack of a "
          "convex combination of the points")
{
    const Scene scene(600, 25, 2);
    std::size_t all_are_points = 0, programs = 0;
    for (std::size_t bv = 0; bv < scene.bvh.bvs.size(); ++bv) {
        const RestBv rest = scene.bvh.rest(bv);
        const RestMoments moments = scene.moments(bv);
        const auto vertices = scene.vertices(bv);
        REQUIRE(moments.influence.size() == rest.node.size());
        REQUIRE(moments.point.size() == std::min<std::size_t>(vertices.size(), 64));
        for (std::size_t n = 0; n < vertices.size(); ++n) {
            const Weights::Row row = scene.e.surface.weights.of(vertices[n]);
            for (const std::uint32_t node : row.node) {
                const auto j = place_in(rest, node);
                for (int a = 0; a < 3; ++a) {
                    const RestBox& box = moments.influence[j].local;
                    const Exact off = Exact(scene.e.surface.mesh.vertices[vertices[n]][a]) - Exact(moments.centre[a]) -
                                      Exact(box.centre[a]);
                    REQUIRE(absolute(off) <= Exact(box.half[a]));
                }
            }
            const ExactLifted own = lifted(scene.e.surface, rest, moments, vertices[n]);
            if (moments.point.size() == vertices.size()) { // in the same order
                for (std::size_t c = 0; c < lifted_size; ++c) {
                    const Exact off = own[c] - Exact(moments.point[n][c]);
                    REQUIRE(off <= Exact(moments.greatest[c]));
                    REQUIRE(Exact(moments.least[c]) <= off);
                    REQUIRE(moments.greatest[c] - moments.least[c] < 1e-13); // the rounding of the points alone
                }
                ++all_are_points;
                continue;
            }
            if (n % 97 != bv % 97 % 11 || programs >= test::share_of(12))
                continue;
            CGAL::Quadratic_program<Exact> program(CGAL::SMALLER, true, Exact(0), false);
            for (int i = 0; i < static_cast<int>(moments.point.size()); ++i) {
                program.set_a(i, 0, Exact(1));
                for (int c = 0; c < static_cast<int>(lifted_size); ++c)
                    for (int side = 0; side < 2; ++side)
                        program.set_a(i, 1 + 2 * c + side,
                                      Exact(moments.point[static_cast<std::size_t>(i)][static_cast<std::size_t>(c)]));
            }
            program.set_b(0, Exact(1));
            program.set_r(0, CGAL::EQUAL);
            for (int c = 0; c < static_cast<int>(lifted_size); ++c) {
                const auto component = static_cast<std::size_t>(c);
                program.set_b(1 + 2 * c, own[component] - Exact(moments.least[component]));
                program.set_b(2 + 2 * c, own[component] - Exact(moments.greatest[component]));
                program.set_r(2 + 2 * c, CGAL::LARGER);
            }
            REQUIRE_FALSE(CGAL::solve_linear_program(program, Exact()).is_infeasible());
            ++programs;
        }
    }
    CHECK(all_are_points > 1000);
    CHECK(programs == test::share_of(12));
}

// By the very combinations from which it was made: it holds what they leave exactly, and little more.
TEST_CASE("the slack is what convex combinations of the points leave of lifted vertices")
{
    const Scene scene(900, 40, 16);
    std::size_t checked = 0;
    for (std::size_t bv = 0; bv < scene.bvh.bvs.size(); ++bv) {
        const RestBv rest = scene.bvh.rest(bv);
        const RestMoments moments = scene.moments(bv);
        const auto vertices = scene.vertices(bv);
        if (moments.point.size() == vertices.size())
            continue;
        std::vector<Lifted> rounded;
        for (const std::uint32_t k : vertices) {
            const Weights::Row row = scene.e.surface.weights.of(k);
            std::vector<Vec3> place;
            for (const std::uint32_t node : row.node)
                place.push_back(moments.influence[place_in(rest, node)].place);
            rounded.push_back(lift(scene.e.surface.mesh.vertices[k] - moments.centre, row, place).value);
        }
        const LiftedPoints points =
            choose_lifted(rounded, lifted_scale(scene.bvh.bvs[0].box.half.maxCoeff()), most_lifted_points);
        ExactLifted least, greatest;
        for (std::size_t n = 0; n < vertices.size(); ++n) {
            if (points.combination[n].empty())
                continue;
            const ExactLifted own = lifted(scene.e.surface, rest, moments, vertices[n]);
            Exact sum(0);
            for (const double alpha : points.combination[n]) {
                REQUIRE(alpha >= 0);
                sum = sum + Exact(alpha);
            }
            REQUIRE(sum == Exact(1));
            for (std::size_t c = 0; c < lifted_size; ++c) {
                Exact left = own[c];
                for (std::size_t i = 0; i < points.chosen.size(); ++i)
                    left = left - Exact(points.combination[n][i]) * Exact(moments.point[i][c]);
                least[c] = left < least[c] ? left : least[c];
                greatest[c] = maximum(greatest[c], left);
                ++checked;
            }
        }
        for (std::size_t c = 0; c < lifted_size; ++c) {
            REQUIRE(greatest[c] <= Exact(moments.greatest[c]));
            REQUIRE(Exact(moments.least[c]) <= least[c]);
            REQUIRE(moments.greatest[c] - CGAL::to_double(greatest[c]) < 1e-12);
            REQUIRE(CGAL::to_double(least[c]) - moments.least[c] < 1e-12);
        }
    }
    CHECK(checked > 10000);
}

TEST_CASE("no linear functional of lifted vertices exceeds its support over the points and the slack")
{
    const Scene scene(900, 40, 16);
    Random random(2);
    std::size_t checked = 0;
    for (std::size_t bv = 0; bv < scene.bvh.bvs.size(); ++bv) {
        const RestMoments moments = scene.moments(bv);
        const auto vertices = scene.vertices(bv);
        if (moments.point.size() == vertices.size())
            continue;
        std::vector<ExactLifted> all;
        for (const std::uint32_t k : vertices)
            all.push_back(lifted(scene.e.surface, scene.bvh.rest(bv), moments, k));
        for (int trial = 0; trial < 8; ++trial) {
            MomentFit fit;
            const double only = trial < 4 ? 1 : 0x1p-20; // in every other trial some components alone
            for (Vec3* vector : {&fit.linear, &fit.g, &fit.k, &fit.diagonal, &fit.beside})
                for (double& x : *vector)
                    x = uniform(random, random() % 4 == 0 ? 1 : only);
            const LiftedSupport support = lifted_support(moments, fit);
            for (const ExactLifted& x : all) {
                const Exact value = times(fit.functional(), x);
                REQUIRE(value <= Exact(support.along) + Exact(support.error));
                REQUIRE(-value <= Exact(support.against) + Exact(support.error));
                ++checked;
            }
        }
    }
    CHECK(checked > 3000);
}

// With the numbers as they are computed. What the errors allow is used to more than a hundredth, so that none is
// idle, and never beyond.
TEST_CASE("the parts of the moment bound are within their errors of exact arithmetic")
{
    const Scene scene(200, 20, 4);
    Random random(3);
    double used_by_nodes = 0, used_by_points = 0;
    const auto share = [](const Exact& off, double error) { return CGAL::to_double(absolute(off)) / error; };
    for (std::size_t bv = 0; bv < scene.bvh.bvs.size(); ++bv) {
        const RestBv rest = scene.bvh.rest(bv);
        const RestMoments moments = scene.moments(bv);
        std::vector<double> plus(rest.node.size()), minus(plus);
        for (const auto& frame : {scene.e.frames[1], scene.e.frames[2]})
            for (const Axis& axis : axes_of(14)) {
                const MomentFit fit = fit_moments(rest, moments, frame, axis);
                const double error = remainder_extrema(rest, moments, frame, axis, fit, plus, minus);
                for (std::size_t j = 0; j < rest.node.size(); ++j) {
                    const MomentInfluence& own = moments.influence[j];
                    const ExactRemainder exactly = remainder(fit, own.place, moments.centre, frame[rest.node[j]], axis);
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
    CAPTURE(used_by_nodes, used_by_points);
    CHECK(used_by_nodes <= 1);
    CHECK(used_by_nodes > 0.02);
    CHECK(used_by_points <= 1);
    CHECK(used_by_points > 0.02);
}

TEST_CASE("a quadratic motion is bounded by the moments to within rounding, whatever the weights")
{
    Random random(4);
    Scene scene(200, 30, 8);
    scene.e.surface.place.clear();
    for (std::size_t j = 0; j < scene.e.surface.weights.node_count; ++j)
        scene.e.surface.place.emplace_back(uniform(random, 1), uniform(random, 1), uniform(random, 1));
    std::size_t tight = 0;
    for (int trial = 0; trial < 2; ++trial) {
        const std::vector<AffineMap> maps = quadratic_maps(scene.e.surface.place, random);
        std::vector<double> bounds(scene.bvh.bvs.size() * 26);
        refit(scene.bvh, scene.e.surface, maps, {Method::moments, 26, Rounding::proven}, bounds);
        for (std::size_t bv = 0; bv < scene.bvh.bvs.size(); ++bv) {
            const auto vertices = scene.vertices(bv);
            for (std::size_t d = 0; d < 26; ++d) {
                Exact truth;
                for (std::size_t n = 0; n < vertices.size(); ++n) {
                    const Exact own = along(deformed<Exact>(scene.e.surface.mesh.vertices[vertices[n]],
                                                            scene.e.surface.weights.of(vertices[n]), maps),
                                            all_axes[d / 2], d % 2 == 1);
                    truth = n == 0 || truth < own ? own : truth;
                }
                const std::size_t place = bv * 26 + d;
                REQUIRE(truth <= Exact(bounds[place]));
                if (vertices.size() > 64)
                    continue;
                REQUIRE(bounds[place] - CGAL::to_double(truth) < 1e-12);
                ++tight;
            }
        }
    }
    CHECK(tight > 500);
}
