// SPDX-License-Identifier: GPL-3.0-or-later
#include <cfenv>
#include <limits>

#include <catch2/catch.hpp>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include "tests/support.hpp"
#include "toolkit/bounds/rounding.hpp"
#include "toolkit/deform/evaluate.hpp"
#include "toolkit/hierarchy/refit.hpp"

using namespace cinch;

namespace {

std::vector<double> refitted(const Bvh& bvh, const test::Example& e, std::size_t frame, RefitOptions options)
{
    std::vector<double> supports(bvh.bvs.size() * static_cast<std::size_t>(options.kdop), std::numeric_limits<double>::quiet_NaN());
    refit(bvh, e.surface, e.frames[frame], options, supports);
    return supports;
}

constexpr Method methods[] = {Method::convex, Method::eq12, Method::limited, Method::vertices};

} // namespace

TEST_CASE("in doubles vertices ≤ limited ≤ eq12 ≤ convex, and every computed vertex is inside")
{
    const test::Example e = test::example(600, 40);
    const Bvh bvh = build_bvh(e.surface, 3);
    for (std::size_t frame : {0u, 1u, 2u})
        for (int k : {6, 14, 18, 26}) {
            std::vector<std::vector<double>> s;
            for (Method method : methods)
                s.push_back(refitted(bvh, e, frame, {method, k}));
            for (std::size_t i = 0; i < s[0].size(); ++i) {
                REQUIRE(s[1][i] <= s[0][i]);
                REQUIRE(s[2][i] <= s[1][i]);
                REQUIRE(s[3][i] <= s[2][i] + 1e-12);
            }
            std::vector<Vec3> v(e.surface.mesh.vertices.size());
            evaluate(e.surface.mesh.vertices, e.surface.weights, e.frames[frame], v);
            for (std::size_t bv = 0; bv < bvh.bvs.size(); ++bv)
                for (std::uint32_t t = 0; t < bvh.bvs[bv].triangle_count; ++t)
                    for (std::uint32_t vertex : e.surface.mesh.triangles[bvh.triangle[bvh.bvs[bv].first_triangle + t]])
                        for (int axis = 0; axis < 3; ++axis)
                            for (const auto& supports : s) {
                                REQUIRE(v[vertex][axis] <= supports[bv * static_cast<std::size_t>(k) + 2 * static_cast<std::size_t>(axis)]);
                                REQUIRE(-v[vertex][axis] <= supports[bv * static_cast<std::size_t>(k) + 2 * static_cast<std::size_t>(axis) + 1]);
                            }
        }
}

TEST_CASE("the same bits for 1, 2 and 7 threads")
{
    const tbb::global_control seven(tbb::global_control::max_allowed_parallelism, 7);
    const test::Example e = test::example(2000, 60);
    const Bvh bvh = build_bvh(e.surface, 1);
    for (Method method : methods) {
        std::vector<std::vector<double>> results;
        for (int threads : {1, 2, 7})
            tbb::task_arena(threads).execute([&] { results.push_back(refitted(bvh, e, 2, {method, 14})); });
        CHECK(results[0] == results[1]);
        CHECK(results[0] == results[2]);
    }
}

TEST_CASE("a map that is not finite makes the BVs that it influences infinite and changes no other")
{
    test::Example e = test::example(600, 40);
    const Bvh bvh = build_bvh(e.surface, 1);
    for (Method method : methods) {
        const auto before = refitted(bvh, e, 2, {method, 6});
        test::Example broken = e;
        for (auto& row : broken.frames[2][5].m)
            row[3] = std::numeric_limits<double>::quiet_NaN();
        const auto after = refitted(bvh, broken, 2, {method, 6});
        std::size_t infinite_bvs = 0;
        for (std::size_t bv = 0; bv < bvh.bvs.size(); ++bv) {
            const RestBv rest = bvh.rest(bv);
            const bool reached = std::find(rest.node.begin(), rest.node.end(), 5u) != rest.node.end();
            infinite_bvs += reached;
            for (std::size_t d = 6 * bv; d < 6 * bv + 6; ++d)
                REQUIRE(after[d] == (reached ? infinite : before[d]));
        }
        CHECK(infinite_bvs > 0);
        CHECK(infinite_bvs < bvh.bvs.size());
    }
}

TEST_CASE("wrong sizes and a changed rounding mode are refused")
{
    const test::Example e = test::example(100, 10);
    const Bvh bvh = build_bvh(e.surface, 1);
    std::vector<double> supports(bvh.bvs.size() * 6);
    CHECK_THROWS_AS(refit(bvh, e.surface, e.frames[0], {Method::eq12, 8}, supports), std::invalid_argument);
    CHECK_THROWS_AS(refit(bvh, e.surface, e.frames[0], {Method::eq12, 14}, supports), std::invalid_argument);
    CHECK_THROWS_AS(refit(bvh, e.surface, std::span(e.frames[0]).first(9), {Method::eq12, 6}, supports), std::invalid_argument);
    std::fesetround(FE_UPWARD);
    bool refused = false;
    try {
        refit(bvh, e.surface, e.frames[0], {Method::eq12, 6}, supports);
    } catch (const std::runtime_error&) {
        refused = true;
    }
    std::fesetround(FE_TONEAREST);
    CHECK(refused);
}
