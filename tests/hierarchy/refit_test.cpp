// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cfenv>
#include <limits>
#include <numeric>
#include <random>
#include <type_traits>

#include <catch2/catch.hpp>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include "cinch/bounds.hpp"
#include "cinch/deform.hpp"
#include "cinch/refit.hpp"
#include "tests/support.hpp"
#include "toolkit/bounds/rounding.hpp"

using namespace cinch;

namespace {

std::vector<double> refitted(const Bvh& bvh, const test::Example& e, std::size_t frame, RefitOptions options)
{
    std::vector<double> supports(bvh.bvs.size() * static_cast<std::size_t>(options.kdop),
                                 std::numeric_limits<double>::quiet_NaN());
    refit(bvh, e.surface, e.frames[frame], options, supports);
    return supports;
}

const std::vector<Methods> methods = [] {
    std::vector<Methods> all(all_methods.begin(), all_methods.end());
    all.push_back(Method::local | Method::support);
    return all;
}();
constexpr Precision precisions[] = {Precision::float32, Precision::float64};

std::vector<std::pair<Methods, Precision>> every_choice()
{
    std::vector<std::pair<Methods, Precision>> all;
    for (Precision precision : precisions)
        for (Methods method : methods)
            all.emplace_back(method, precision);
    return all;
}

template <class BvhArgument, class SurfaceArgument> constexpr bool refits =
    std::is_constructible_v<Refitter, BvhArgument, SurfaceArgument, RefitOptions>;
static_assert(refits<const Bvh&, const DeformableSurface&>);
static_assert(!refits<Bvh, const DeformableSurface&> && !refits<const Bvh&, DeformableSurface> &&
              !refits<Bvh, DeformableSurface>); // they would dangle

} // namespace

TEST_CASE("in doubles vertices ≤ limited ≤ eq12 ≤ convex, and every computed vertex is inside")
{
    const test::Example e = test::example(600, 40);
    const Bvh bvh = build_bvh(e.surface, 3);
    const std::size_t frames[] = {2, 0, 1};
    for (const std::size_t frame : test::share_of(frames))
        for (int k : test::share_of(kdops)) {
            std::vector<std::vector<double>> s;
            const auto truth = refitted(bvh, e, frame, {Method::vertices, k, Rounding::plain});
            for (Precision precision : precisions) {
                const auto convex = refitted(bvh, e, frame, {Method::convex, k, Rounding::proven, precision});
                const auto eq12 = refitted(bvh, e, frame, {Method::eq12, k, Rounding::proven, precision});
                const auto limited = refitted(bvh, e, frame, {Method::limited, k, Rounding::proven, precision});
                for (std::size_t i = 0; i < convex.size(); ++i) {
                    REQUIRE(eq12[i] <= convex[i]);
                    REQUIRE(limited[i] <= eq12[i]);
                }
                for (Methods method : methods)
                    s.push_back(refitted(bvh, e, frame, {method, k, Rounding::proven, precision}));
                const auto support = refitted(bvh, e, frame, {Method::support, k, Rounding::proven, precision}),
                           linear = refitted(bvh, e, frame, {Method::linear, k, Rounding::proven, precision}),
                           both = refitted(bvh, e, frame,
                                           {Method::support | Method::linear, k, Rounding::proven, precision});
                for (std::size_t i = 0; i < both.size(); ++i)
                    REQUIRE(both[i] == std::min(support[i], linear[i]));
            }
            for (const auto& supports : s)
                for (std::size_t i = 0; i < truth.size(); ++i)
                    REQUIRE(supports[i] >= truth[i] - 1e-14);
            std::vector<Vec3> v(e.surface.mesh.vertices.size());
            evaluate(e.surface.mesh.vertices, e.surface.weights, e.frames[frame], v);
            for (std::size_t bv = 0; bv < bvh.bvs.size(); ++bv)
                for (std::uint32_t t = 0; t < bvh.bvs[bv].triangle_count; ++t)
                    for (std::uint32_t vertex : e.surface.mesh.triangles[bvh.triangle[bvh.bvs[bv].first_triangle + t]])
                        for (int axis = 0; axis < 3; ++axis)
                            for (const auto& supports : s) {
                                REQUIRE(
                                    v[vertex][axis] <=
                                    supports[bv * static_cast<std::size_t>(k) + 2 * static_cast<std::size_t>(axis)]);
                                REQUIRE(-v[vertex][axis] <= supports[bv * static_cast<std::size_t>(k) +
                                                                     2 * static_cast<std::size_t>(axis) + 1]);
                            }
        }
}

TEST_CASE("the same bits for 1, 2 and 7 threads")
{
    const tbb::global_control seven(tbb::global_control::max_allowed_parallelism, 7);
    const test::Example e = test::example(2000, 60);
    const Bvh bvh = build_bvh(e.surface, 1);
    for (Precision precision : precisions)
        for (Methods method : test::share_of(methods)) {
            std::vector<std::vector<double>> results;
            for (int threads : {1, 2, 7})
                tbb::task_arena(threads).execute([&] {
                    results.push_back(refitted(bvh, e, 2, {method, 14, Rounding::proven, precision}));
                });
            INFO(name_of(method));
            CHECK(results[0] == results[1]);
            CHECK(results[0] == results[2]);
        }
}

TEST_CASE("a map that is not finite in any one entry makes all bounds of the BVs that it influences infinite, changes "
          "no other, and is counted")
{
    test::Example e = test::example(200, 20);
    const Bvh bvh = build_bvh(e.surface, 1);
    const double bad[] = {std::numeric_limits<double>::quiet_NaN(), infinite, -infinite};
    std::vector<std::pair<Methods, Precision>> choices = every_choice();
    choices.emplace_back(Method::corners | Method::eq12, Precision::float32);
    choices.emplace_back(Method::corners | Method::vertices, Precision::float32);
    std::ranges::shuffle(choices, std::mt19937(1)); // a share of them has some of everything
    for (const auto& [method, precision] : test::share_of(choices))
        for (const int k : kdops) {
            INFO(name_of(method) << ", k " << k);
            const auto places = static_cast<std::size_t>(k);
            Refitter refit(bvh, e.surface, {method, k, Rounding::proven, precision});
            std::vector<double> before(bvh.bvs.size() * places), after(before);
            refit(e.frames[2], before);
            for (int entry = 0; entry < 12; ++entry) {
                auto broken = e.frames[2];
                broken[5].m[entry / 4][entry % 4] = bad[entry % 3];
                CHECK(refit(broken, after).unbounded_nodes == 1);
                std::size_t infinite_bvs = 0;
                for (std::size_t bv = 0; bv < bvh.bvs.size(); ++bv) {
                    const RestBv rest = bvh.rest(bv);
                    const bool reached = std::find(rest.node.begin(), rest.node.end(), 5u) != rest.node.end();
                    infinite_bvs += reached;
                    for (std::size_t d = places * bv; d < places * (bv + 1); ++d)
                        REQUIRE(after[d] == (reached ? infinite : before[d]));
                }
                CHECK(infinite_bvs > 0);
                CHECK(infinite_bvs < bvh.bvs.size());
            }
        }
}

TEST_CASE("a BV of more simulation nodes than float takes is bounded in doubles")
{
    DeformableSurface surface;
    constexpr std::uint32_t nodes = 70'002; // each has a vertex of its own
    surface.weights.node_count = nodes;
    for (std::uint32_t k = 0; k < nodes; ++k) {
        surface.mesh.vertices.push_back({k % 251 * 0.1, k % 257 * 0.1, k * 1e-4});
        if (k % 3 == 2)
            surface.mesh.triangles.push_back({k - 2, k - 1, k});
        surface.weights.node.push_back(k);
        surface.weights.weight.push_back(1);
        surface.weights.row.push_back(k + 1);
    }
    std::vector<AffineMap> maps(nodes, identity_map);
    for (std::uint32_t j = 0; j < nodes; ++j)
        maps[j].m[j % 3][3] = j % 7;
    for (const std::size_t leaf :
         {std::size_t{nodes}, std::size_t{5000}}) { // alone, and over others that float would take
        const Bvh bvh = build_bvh(surface, leaf, RestDetail::boxes);
        REQUIRE(bvh.bvs[0].influence_count == nodes);
        std::vector<double> single(bvh.bvs.size() * 6), twice(single), truth(single);
        refit(bvh, surface, maps, {Method::eq12, 6, Rounding::proven, Precision::float32}, single);
        refit(bvh, surface, maps, {Method::eq12, 6, Rounding::proven, Precision::float64}, twice);
        refit(bvh, surface, maps, {Method::vertices, 6}, truth);
        CHECK(single == twice);
        for (std::size_t i = 0; i < truth.size(); ++i)
            REQUIRE(single[i] >= truth[i] - 1e-12);
    }
}

TEST_CASE("a refitter of a tree without the rest data of a method is refused, and makes none up")
{
    const DeformableSurface surface = test::example(120, 8).surface;
    for (const RestDetail detail : {RestDetail::boxes, RestDetail::inner, RestDetail::all}) {
        const Bvh bvh = build_bvh(surface, 4, detail);
        for (const Method method : all_methods) {
            INFO(name_of(method));
            RefitOptions options;
            options.methods = method;
            const bool lacks = (detail == RestDetail::boxes && need(method, RestNeed::local)) ||
                               (detail == RestDetail::inner && need(method, RestNeed::points));
            if (lacks)
                CHECK_THROWS_AS(Refitter(bvh, surface, options), std::invalid_argument);
            else
                CHECK_NOTHROW(Refitter(bvh, surface, options));
        }
    }
}

TEST_CASE("the default is nowhere clearly looser than Eq. 12: by more than 1 % of the width of its bound")
{
    std::mt19937_64 random(5);
    auto uniform = [&](double most) { return most * (static_cast<double>(random() >> 11) * 0x1p-52 - 1); };
    std::size_t above = 0;
    const auto never_looser = [&](const DeformableSurface& surface, std::size_t leaf, std::span<const AffineMap> maps) {
        const Bvh bvh = build_bvh(surface, leaf);
        for (const Precision precision : precisions)
            for (const int k : {6, 26})
                for (const int passes : {0, 1, 3})
                    for (const bool remember : {false, true}) {
                        if (k == 26 && passes != 1)
                            continue;
                        std::vector<double> best(bvh.bvs.size() * static_cast<std::size_t>(k)), eq12(best);
                        Refitter refitter(
                            bvh, surface,
                            {Method::best, k, Rounding::proven, precision, passes, RestShape::aabb, remember});
                        for (int frame = 0; frame < 2; ++frame)
                            refitter(maps, best);
                        refit(bvh, surface, maps, {Method::eq12, k, Rounding::proven, precision}, eq12);
                        INFO(name_of(precision) << ", k " << k << ", " << passes << " passes, remembered " << remember);
                        for (std::size_t i = 0; i < best.size(); ++i) {
                            above += best[i] > eq12[i];
                            REQUIRE(best[i] - eq12[i] <=
                                    0.01 * (eq12[i] + eq12[i ^ 1]) + 8 * unit_roundoff * std::abs(eq12[i]));
                        }
                    }
    };
    test::Example e = test::example(500, 30);
    for (const auto& frame : e.frames)
        never_looser(e.surface, 4, frame);
    for (int scene = 0; scene < (test::test_share() < 1 ? 1 : 6);
         ++scene) { // joints that turn, mirror, stretch and flatten each on its own
        std::vector<AffineMap> maps(30, identity_map);
        for (AffineMap& map : maps) {
            const int kind = static_cast<int>(random() % 4);
            for (int r = 0; r < 3; ++r)
                for (int s = 0; s < 4; ++s)
                    map.m[r][s] = kind == 0   ? map.m[r][s]
                                  : kind == 1 ? uniform(1)
                                  : kind == 2 ? (s == (r + 1) % 3 ? -1
                                                 : s == 3         ? uniform(2)
                                                                  : 0)
                                              : (s == 3 ? uniform(9) : 0);
        }
        never_looser(e.surface, scene % 2 ? 1 : 8, maps);
    }
    const test::Example many = test::example(900, 150);
    for (const std::vector<AffineMap>& frame : many.frames)
        never_looser(many.surface, 8, frame);
    for (const test::Example& wild : {test::example(900, 60), many})
        for (const double strength : {0.1, 1.0, 4.0}) {
            std::vector<AffineMap> maps = wild.frames[1];
            for (AffineMap& map : maps)
                for (auto& row : map.m)
                    for (double& value : row)
                        value += uniform(strength);
            INFO("strength " << strength << ", " << maps.size() << " nodes");
            never_looser(wild.surface, 8, maps);
        }
    for (Vec3& x : e.surface.mesh.vertices) // a sheet, whose bounds have no width but their rounding
        x[1] = 0.25;
    never_looser(e.surface, 3, e.frames[0]);
    CHECK(above > 100);
}

TEST_CASE("wrong sizes and a changed rounding mode are refused")
{
    const test::Example e = test::example(100, 10);
    const Bvh bvh = build_bvh(e.surface, 1);
    std::vector<double> supports(bvh.bvs.size() * 6);
    CHECK_THROWS_AS(refit(bvh, e.surface, e.frames[0], {Method::eq12, 8}, supports), std::invalid_argument);
    CHECK_THROWS_AS(refit(bvh, e.surface, e.frames[0], {Method::eq12, 14}, supports), std::invalid_argument);
    CHECK_THROWS_AS(refit(bvh, e.surface, std::span(e.frames[0]).first(9), {Method::eq12, 6}, supports),
                    std::invalid_argument);
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

TEST_CASE("infinite and NaN transforms are reported, and a Refitter forgets them with the frame")
{
    test::Example e = test::example(600, 40);
    const Bvh bvh = build_bvh(e.surface, 4);
    for (Precision precision : precisions) {
        Refitter refit(bvh, e.surface, {Method::best, 6, Rounding::proven, precision});
        std::vector<double> before(bvh.bvs.size() * 6), after(before);
        CHECK(refit(e.frames[2], before).unbounded_nodes == 0);
        auto broken = e.frames[2];
        broken[3].m[0][0] = std::numeric_limits<double>::infinity();
        broken[7].m[2][1] = std::numeric_limits<double>::quiet_NaN();
        const RefitReport report = refit(broken, after);
        CHECK(report.unbounded_nodes == 2);
        CHECK(report.infinite > 0);
        CHECK(report.infinite == static_cast<std::size_t>(std::count(after.begin(), after.end(), infinite)));
        refit(e.frames[2], after);
        CHECK(after == before);
    }
}

TEST_CASE("every pass of the dual evaluation tightens the bound, and a remembered λ converges without more")
{
    const test::Example e = test::example(2000, 60);
    const Bvh bvh = build_bvh(e.surface, 8);
    auto width = [](const std::vector<double>& s) { return std::accumulate(s.begin(), s.end(), 0.0); };
    for (Method method : {Method::local, Method::support}) {
        std::vector<double> looser;
        for (int passes : {0, 1, 2, 3, 6}) {
            const auto s = refitted(bvh, e, 2, {method, 6, Rounding::proven, Precision::float64, passes});
            for (std::size_t i = 0; i < looser.size(); ++i)
                REQUIRE(s[i] <= looser[i] + 1e-14); // one step up or down in the last pass
            if (!looser.empty())
                CHECK(width(s) <= width(looser));
            looser = s;
        }
        Refitter remembering(bvh, e.surface,
                             {method, 6, Rounding::proven, Precision::float64, 1, RestShape::aabb, true});
        std::vector<double> s(looser.size());
        for (int frame = 0; frame < 24; ++frame) // one evaluation each
            remembering(e.frames[2], s);
        CHECK(width(s) <= width(refitted(bvh, e, 2, {method, 6, Rounding::proven, Precision::float64, 1})));
        CHECK(width(s) == Approx(width(looser)).epsilon(1e-4));
    }
}
