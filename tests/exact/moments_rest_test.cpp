// SPDX-License-Identifier: GPL-3.0-or-later
// Rest data of the moment bound in exact arithmetic.
#include <CGAL/QP_functions.h>
#include <CGAL/QP_models.h>
#include <catch2/catch.hpp>

#include "tests/exact/lifted_exactly.hpp"
#include "toolkit/bounds/pack_moments.hpp"
#include "toolkit/bounds/rounding.hpp"
#include "toolkit/hierarchy/lifted_points.hpp"
#include "toolkit/hierarchy/packed_bvh.hpp"

using namespace cinch;
using namespace cinch::exact;

TEST_CASE("every vertex of a BV lies in its nodes' local boxes about the centre, and lifted within the slack of a "
          "convex combination of the points")
{
    const MomentScene scene(600, 25, 2);
    std::size_t all_are_points = 0, programs = 0;
    for (std::size_t bv = 0; bv < scene.bvh.bvs.size(); ++bv) {
        const RestBv rest = scene.bvh.rest(bv);
        const RestMoments moments = scene.moments(bv);
        const auto vertices = scene.vertices(bv);
        REQUIRE(moments.influence.size() == rest.node.size());
        REQUIRE(moments.point.size() == std::min<std::size_t>(vertices.size(), lifted_points_of(vertices.size())));
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
    const MomentScene scene(900, 40, 16);
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
            rounded.push_back(lift(scene.e.surface.mesh.vertices[k] - moments.centre, row, place, moments.unit).value);
        }
        const LiftedPoints points =
            choose_lifted(rounded, lifted_scale(moments.unit), lifted_points_of(rounded.size()));
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
    const MomentScene scene(900, 40, 16);
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
            const MomentFit fit = any_numbers(random, trial < 4 ? 1 : 0x1p-20); // or some components alone
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

namespace {

// Exactly: intervals of weights, boxes, centre and places; and every point with all of its slack.
template <class T> void check_packed(const MomentScene& scene)
{
    const RestExtent extent = rest_extent(scene.bvh, scene.e.surface);
    const auto exactly = [](T x) { return Exact(static_cast<double>(x)); };
    std::size_t rounded = 0;
    for (std::size_t i = 0; i < scene.bvh.bvs.size(); ++i) {
        const RestBv rest = scene.bvh.rest(i);
        const RestMoments moments = scene.moments(i);
        std::vector<double> means;
        for (const WeightModel& model : rest.model)
            means.push_back(model.mean);
        PackedBv<T> bv;
        bv.kind = Method::moments;
        AlignedVector<T> value;
        pack_moments<T>(rest, moments, means, extent, bv, value);
        REQUIRE(bv.error_factor < infinite);
        REQUIRE(value.size() == bv.values_before() + rest.node.size() * moment_values);
        const T* head = value.data() + bv.values_before() - moment_head;
        for (std::size_t c = 0; c < lifted_size; ++c)
            for (std::size_t p = 0; p < moments.point.size(); ++p) {
                const Exact packed = exactly(value[p * moment_point + moment_place[c]]),
                            half = exactly(head[moment_head_slack + moment_place[c]]), point(moments.point[p][c]);
                REQUIRE(packed - half <= point + Exact(moments.least[c]));
                REQUIRE(point + Exact(moments.greatest[c]) <= packed + half);
                rounded += packed != point;
            }
        for (std::size_t j = 0; j < rest.node.size(); ++j) {
            const T* own = head + moment_head + j * moment_values;
            REQUIRE(exactly(own[moment_l]) <= Exact(rest.space.l[j]));
            REQUIRE(Exact(rest.space.h[j]) <= exactly(own[moment_l]) + exactly(own[moment_r]));
            for (std::size_t s = 0; s < 3; ++s) {
                const auto a = static_cast<int>(s);
                REQUIRE(exactly(own[moment_z + s]) == Exact(moments.influence[j].place[a]));
                REQUIRE(exactly(bv.pivot[s]) == Exact(moments.centre[a]) - Exact(extent.origin[a]));
                const Exact centre = exactly(own[moment_box + s]) + Exact(extent.origin[a]),
                            half = exactly(own[moment_box + 4 + s]), box(rest.local[j].centre[a]),
                            own_half(rest.local[j].half[a]);
                REQUIRE(centre - half <= box - own_half);
                REQUIRE(box + own_half <= centre + half);
            }
        }
    }
    CHECK(rounded > 1000);
}

} // namespace

TEST_CASE("what is packed for the moment bound holds what it is made of, exactly")
{
    MomentScene scene(600, 25, 2);
    check_packed<float>(scene);
    check_packed<double>(scene);
    MomentScene far(scene);
    for (Vec3& x : far.e.surface.mesh.vertices) // from the origin
        x += Vec3(1e7, -3e5, 1 / 3.0);
    far.bvh = build_bvh(far.e.surface, 2);
    far.data = rest_moments(far.bvh, far.e.surface);
    check_packed<float>(far);
}
