// SPDX-License-Identifier: GPL-3.0-or-later
// The verifier accepts what is right and bites when anything is damaged.
#include <algorithm>
#include <cmath>
#include <limits>

#include <map>

#include <catch2/catch.hpp>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "cinch/bounds.hpp"
#include "cinch/deform.hpp"
#include "cinch/refit.hpp"
#include "exact/verifier.hpp"
#include "tests/support.hpp"
#include "toolkit/deform/dyadic.hpp"

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

using namespace cinch;
using namespace cinch::exact;

namespace {

const std::vector<Methods> methods = [] {
    std::vector<Methods> all(all_methods.begin(), all_methods.end());
    all.insert(all.end(), {Method::support | Method::linear, Method::limited | Method::best});
    return all;
}();

struct Scene {
    test::Example e = test::example(400, 30);
    Bvh bvh = build_bvh(e.surface, 1);

    std::vector<double> supports(Methods methods_, int k, std::size_t frame = 2, Rounding rounding = Rounding::proven,
                                 Precision precision = Precision::float64) const
    {
        std::vector<double> s(bvh.bvs.size() * static_cast<std::size_t>(k));
        refit(bvh, e.surface, e.frames[frame], {methods_, k, rounding, precision}, s);
        return s;
    }
    FrameVerdict verdict(Methods methods_, int k, const std::vector<double>& s, std::size_t frame = 2) const
    {
        return Verifier(e.surface, bvh).check(e.frames[frame], methods_, k, s);
    }
};

std::size_t violated(const FrameVerdict& verdict, std::uint8_t statements = 0xff)
{
    return static_cast<std::size_t>(std::count_if(verdict.failed.begin(), verdict.failed.end(),
                                                  [&](auto mask) { return (mask & statements) != 0; }));
}

} // namespace

TEST_CASE("every method is proven for every k and frame, and the losses add up")
{
    const Scene scene;
    const Verifier verifier(scene.e.surface, scene.bvh);
    for (const std::string& fault : verifier.rest_data_faults())
        REQUIRE(fault.empty());
    for (Methods method : methods)
        for (int k : kdops)
            for (std::size_t frame : {0u, 1u, 2u}) {
                INFO(name_of(method) << ", k " << k << ", frame " << frame);
                const auto single = scene.supports(method, k, frame, Rounding::proven, Precision::float32);
                REQUIRE(violated(verifier.check(scene.e.frames[frame], method, k, single)) == 0);
                const auto s = scene.supports(method, k, frame);
                const FrameVerdict verdict = verifier.check(scene.e.frames[frame], method, k, s);
                REQUIRE(violated(verdict) == 0);
                REQUIRE(verdict.examples.empty());
                CHECK(static_cast<double>(verdict.decided_by_filter) >
                      0.95 * static_cast<double>(verdict.failed.size()));
                for (std::size_t i = 0; i < verdict.bvs.size(); ++i) {
                    const BvReport& bv = verdict.bvs[i];
                    REQUIRE(bv.bound_radius >= bv.true_radius - 1e-15);
                    REQUIRE(bv.loss.box >= -1e-13);
                    REQUIRE(bv.loss.interval >= -1e-13);
                    REQUIRE((bv.loss.corner >= -1e-13 || !method.within(weight_space_methods)));
                    if (k != 6)
                        continue;
                    // Mean over directions of bound − truth; the widths of truth are those of the `vertices` bound, up
                    // to rounding.
                    double width = 0;
                    for (std::size_t d = 6 * i; d < 6 * i + 6; ++d)
                        width += s[d] / 6;
                    const auto truth = scene.supports(Method::vertices, 6, frame, Rounding::plain);
                    for (std::size_t d = 6 * i; d < 6 * i + 6; ++d)
                        width -= truth[d] / 6;
                    REQUIRE(bv.loss.box + bv.loss.interval + bv.loss.corner + bv.loss.rounding ==
                            Approx(width).margin(1e-13));
                    if (i > 20)
                        break; // the truth above is refitted each time
                }
            }
}

TEST_CASE("oriented rest boxes are proven")
{
    const Scene scene;
    const Verifier verifier(scene.e.surface, scene.bvh);
    for (Method method : ladder_methods)
        for (Precision precision : {Precision::float32, Precision::float64})
            for (int k : kdops) {
                std::vector<double> s(scene.bvh.bvs.size() * static_cast<std::size_t>(k));
                refit(scene.bvh, scene.e.surface, scene.e.frames[2],
                      {method, k, Rounding::proven, precision, 1, RestShape::obb}, s);
                CHECK(violated(verifier.check(scene.e.frames[2], method, k, s, RestShape::obb)) == 0);
                CHECK(s != scene.supports(method, k, 2, Rounding::proven, precision));
            }
}

TEST_CASE("limited loses nothing at the corner, convex more than eq12")
{
    const Scene scene;
    std::map<Method, double> corner;
    for (Method method : box_methods)
        for (const BvReport& bv : scene.verdict(method, 6, scene.supports(method, 6)).bvs)
            corner[method] += bv.loss.corner;
    CHECK(corner[Method::convex] > corner[Method::eq12]);
    CHECK(corner[Method::corners] >= corner[Method::eq12] - 1e-12); // Eq. 12 is the value of one of the corners
    CHECK(corner[Method::eq12] > 0.01);
    CHECK(std::abs(corner[Method::limited]) < 1e-12);
}

TEST_CASE("mutation: without the rounding terms bounds are violated")
{
    const Scene scene;
    for (Method method : {Method::eq12, Method::limited}) { // convex is too loose to fall below the maximum over W'
        const FrameVerdict verdict = scene.verdict(method, 6, scene.supports(method, 6, 2, Rounding::plain));
        CHECK(violated(verdict, weight_space) > verdict.failed.size() / (method == Method::limited ? 20 : 1000));
        REQUIRE_FALSE(verdict.examples.empty());
        CHECK_THAT(verdict.examples[0].detail, Catch::Contains("exceeds the bound by ") && Catch::Contains("/"));
    }
    CHECK(violated(scene.verdict(Method::vertices, 6, scene.supports(Method::vertices, 6, 2, Rounding::plain)),
                   exact_vertices) > 100);
}

TEST_CASE("mutation: l and h swapped for one simulation node of one BV")
{
    Scene scene;
    const Bv& bv = scene.bvh.bvs[3];
    const auto j = bv.first_influence + 2;
    REQUIRE(scene.bvh.l[j] < scene.bvh.h[j]);
    std::swap(scene.bvh.l[j], scene.bvh.h[j]);
    const FrameVerdict verdict = scene.verdict(Method::limited, 6, scene.supports(Method::limited, 6));
    for (std::size_t d = 0; d < 6; ++d)
        CHECK((verdict.failed[18 + d] & rest_data));
    CHECK(violated(verdict) == 6); // that BV in all its directions, and no other
}

TEST_CASE("mutation: one h one unit of 2^-53 below the true maximum, or one l above the minimum")
{
    for (bool lower_h : {true, false}) {
        Scene scene;
        std::size_t found = scene.bvh.bvs.size();
        for (std::size_t i = 40; i < scene.bvh.bvs.size() && found == scene.bvh.bvs.size(); ++i) {
            const auto j = scene.bvh.bvs[i].first_influence;
            if (scene.bvh.l[j] > 0 && scene.bvh.l[j] < scene.bvh.h[j]) {
                (lower_h ? scene.bvh.h[j] : scene.bvh.l[j]) += lower_h ? -weight_unit : weight_unit;
                found = i;
            }
        }
        REQUIRE(found < scene.bvh.bvs.size());
        const FrameVerdict verdict = scene.verdict(Method::limited, 6, scene.supports(Method::limited, 6));
        CHECK((verdict.failed[6 * found] & rest_data));
        CHECK(violated(verdict) == 6);
        CHECK_THAT(verdict.examples.at(0).detail, Catch::Contains("lies outside"));
    }
}

TEST_CASE("mutation: an unlisted simulation node, l > 0 beside a vertex without weight, too few influences")
{
    {
        Scene scene;
        Bv& bv = scene.bvh.bvs[5];
        --bv.influence_count;
        CHECK(violated(scene.verdict(Method::eq12, 6, scene.supports(Method::eq12, 6))) == 6);
    }
    {
        Scene scene;
        for (std::uint32_t j = 0; j < scene.bvh.bvs[0].influence_count; ++j)
            if (scene.bvh.l[j] == 0) {
                scene.bvh.l[j] = 0x1p-53;
                break;
            }
        CHECK(violated(scene.verdict(Method::eq12, 6, scene.supports(Method::eq12, 6)), rest_data) == 6);
    }
    {
        Scene scene;
        --scene.bvh.bvs[0].vertex_influences;
        CHECK(violated(scene.verdict(Method::eq12, 6, scene.supports(Method::eq12, 6)), rest_data) == 6);
    }
}

TEST_CASE("mutation: a rest box too small")
{
    Scene scene;
    Bv& bv = scene.bvh.bvs[1];
    bv.box.half.y() *=
        1 - 1e-13; // the stored half is a few units in the last place of the coordinates above the tightest
    CHECK(violated(scene.verdict(Method::limited, 6, scene.supports(Method::limited, 6)), rest_data) == 6);
}

TEST_CASE("mutation: local data and weight models that do not hold")
{
    auto faults = [](auto&& damage) {
        Scene scene;
        damage(scene.bvh);
        return violated(scene.verdict(Method::best, 6, scene.supports(Method::best, 6)), rest_data);
    };
    CHECK(faults([](Bvh&) {}) == 0);
    const std::size_t place = 3; // an entry of the root
    CHECK(faults([&](Bvh& bvh) { bvh.local[place].half.x() *= 1 - 1e-13; }) == 6);
    CHECK(faults([&](Bvh& bvh) { bvh.bvs[0].oriented.axis[0] *= 1 - 1e-12; }) == 6);
    CHECK(faults([&](Bvh& bvh) { bvh.bvs[0].oriented.centre.y() += 1e-9; }) == 6);
    CHECK(faults([&](Bvh& bvh) { bvh.radius[place] *= 1 - 1e-13; }) == 6);
    CHECK(faults([&](Bvh& bvh) { bvh.model[place].residual *= 1 - 1e-12; }) == 6);
    CHECK(faults([&](Bvh& bvh) { bvh.model[place].moment.z() *= 1 - 1e-13; }) == 6);
    CHECK(faults([&](Bvh& bvh) { bvh.model[place].gradient.y() += 0.5; }) == 6);
    CHECK(faults([&](Bvh& bvh) { bvh.model[place].mean += 0x1p-53; }) == 6);
    CHECK(faults([&](Bvh& bvh) { std::swap(bvh.model[place].mean, bvh.model[place + 1].mean); }) == 6);
    CHECK(faults([&](Bvh& bvh) { bvh.bvs[0].pivot.x() += 1e-6; }) == 6);
}

TEST_CASE("mutation: a bound just below the truth, per statement")
{
    const Scene scene;
    auto s = scene.supports(Method::vertices, 14);
    const auto plain = scene.supports(Method::vertices, 14, 2, Rounding::plain);
    s[14 * 7 + 4] = std::nextafter(plain[14 * 7 + 4], -1e9); // a face direction: the computed vertex itself
    const FrameVerdict verdict = scene.verdict(Method::vertices, 14, s);
    CHECK(verdict.failed[14 * 7 + 4] & computed_vertices);
    CHECK(violated(verdict) == 1);
    REQUIRE(verdict.examples.size() >= 1);
    CHECK(verdict.examples[0].bv == 7);
    CHECK(verdict.examples[0].direction == 4);

    s = scene.supports(Method::limited, 6);
    s[6 * 2 + 1] = -1e9;
    const FrameVerdict worse = scene.verdict(Method::limited, 6, s);
    CHECK(worse.failed[6 * 2 + 1] == (weight_space | exact_vertices | computed_vertices));
    s[6 * 2 + 1] = std::numeric_limits<double>::quiet_NaN();
    CHECK(scene.verdict(Method::limited, 6, s).failed[6 * 2 + 1] != 0);
    s[6 * 2 + 1] = -std::numeric_limits<double>::infinity();
    CHECK(scene.verdict(Method::limited, 6, s).failed[6 * 2 + 1] ==
          (weight_space | exact_vertices | computed_vertices));
    s[6 * 2 + 1] = std::numeric_limits<double>::infinity();
    CHECK(violated(scene.verdict(Method::limited, 6, s)) == 0);
}

TEST_CASE("broken trees, weights and transforms are refused")
{
    const auto refused = [](auto&& damage) {
        Scene scene;
        damage(scene);
        CHECK_THROWS_AS(Verifier(scene.e.surface, scene.bvh), std::invalid_argument);
    };
    refused([](Scene& s) { s.bvh.triangle[0] = s.bvh.triangle[1]; });
    refused([](Scene& s) { s.bvh.bvs[0].triangle_count -= 1; });
    refused([](Scene& s) { s.bvh.bvs[2].first_child = s.bvh.bvs[1].first_child; });
    refused([](Scene& s) { s.bvh.bvs[1].first_child = 0; });
    refused([](Scene& s) { s.bvh.bvs.back().first_influence += 1; });
    refused([](Scene& s) { s.e.surface.weights.weight[0] += 0x1p-53; });
    refused([](Scene& s) { s.e.surface.weights.weight[0] += 0x1p-54; });
    refused([](Scene& s) { s.e.surface.weights.row.back() += 1; });
    refused([](Scene& s) { std::swap(s.e.surface.weights.row[3], s.e.surface.weights.row[4]); });
    refused([](Scene& s) { s.e.surface.mesh.triangles[7][1] = 400; });
    refused([](Scene& s) { s.e.surface.mesh.vertices[7].y() = std::numeric_limits<double>::quiet_NaN(); });
    refused([](Scene& s) { s.e.surface.mesh.vertices[7].y() = std::numeric_limits<double>::infinity(); });
    Scene scene;
    const auto s = scene.supports(Method::limited, 6);
    scene.e.frames[2][0].m[0][0] = std::numeric_limits<double>::infinity();
    CHECK_THROWS_AS(scene.verdict(Method::limited, 6, s), std::invalid_argument);
}

TEST_CASE("damaged rest data are faults, whatever they hold")
{
    const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
    auto faulty = [](auto&& damage) {
        Scene scene;
        const auto s = scene.supports(Method::limited, 6);
        damage(scene.bvh);
        for (Method method : {Method::limited, Method::vertices})
            CHECK((scene.verdict(method, 6, s).failed[0] & rest_data));
    };
    faulty([](Bvh& bvh) { bvh.node[0] = 0xfffffff0u; });
    faulty([](Bvh& bvh) { bvh.bvs[0].influence_count = 0; });
    faulty([&](Bvh& bvh) { bvh.bvs[0].box.centre.x() = nan; });
    faulty([&](Bvh& bvh) { bvh.bvs[0].box.centre.x() = inf; });
    faulty([&](Bvh& bvh) { bvh.bvs[0].box.half.x() = nan; });
    faulty([&](Bvh& bvh) { bvh.bvs[0].box.half.x() = -1; });
    faulty([&](Bvh& bvh) { bvh.h[0] = nan; });
    Scene scene; // an infinite rest box holds everything, but then no finite bound follows from it
    const auto s = scene.supports(Method::limited, 6);
    scene.bvh.bvs[0].box.half.x() = inf;
    CHECK(scene.verdict(Method::limited, 6, s).failed[0] == weight_space);
    CHECK(violated(scene.verdict(Method::limited, 6, scene.supports(Method::limited, 6))) == 0);
}

TEST_CASE("what overflows is bounded by infinity and nothing less")
{
    Scene scene;
    double greatest = 0;
    for (const AffineMap& map : scene.e.frames[2])
        for (const auto& row : map.m)
            for (double x : row)
                greatest = std::max(greatest, std::abs(x));
    for (AffineMap& map : scene.e.frames[2])
        for (auto& row : map.m)
            for (double& x : row)
                x = x / greatest * 1.7e308;
    for (Methods method : methods)
        for (int k : {6, 14}) {
            auto s = scene.supports(method, k);
            CHECK(std::count(s.begin(), s.end(), std::numeric_limits<double>::infinity()) > 0);
            CHECK(violated(scene.verdict(method, k, s)) == 0);
            std::replace(s.begin(), s.end(), std::numeric_limits<double>::infinity(),
                         std::numeric_limits<double>::max());
            CHECK(violated(scene.verdict(method, k, s)) > 0);
        }
}

#if defined(__SSE2__)
TEST_CASE("a floating-point environment that TBB took over earlier does not reach the bounds or the verifier")
{
    const unsigned int saved = _mm_getcsr();
    _mm_setcsr(saved | 0x8040u); // flush to zero while TBB starts: its tasks would keep that
    tbb::parallel_for(0, 1000, [](int) {});
    _mm_setcsr(saved);

    Scene scene;
    for (Vec3& v : scene.e.surface.mesh.vertices)
        v *= 1e-160;
    for (AffineMap& map : scene.e.frames[2])
        for (auto& row : map.m)
            for (int c = 0; c < 4; ++c)
                row[c] *= c < 3 ? 1e-150 : 1e-310;
    scene.bvh = build_bvh(scene.e.surface, 1);
    std::vector<Vec3> computed(scene.e.surface.mesh.vertices.size());
    evaluate(scene.e.surface.mesh.vertices, scene.e.surface.weights, scene.e.frames[2], computed);
    for (std::size_t k = 0; k < computed.size(); ++k)
        REQUIRE(computed[k] ==
                evaluate_vertex(scene.e.surface.mesh.vertices[k], scene.e.surface.weights.of(k), scene.e.frames[2]));
    CHECK(computed[0] != Vec3(0, 0, 0));
    for (Methods method : methods)
        CHECK(violated(scene.verdict(method, 6, scene.supports(method, 6))) == 0);
    CHECK(violated(scene.verdict(Method::limited, 6, std::vector<double>(scene.bvh.bvs.size() * 6, 0.0))) > 0);
}
#endif

TEST_CASE("the verdict does not depend on the thread count")
{
    const tbb::global_control seven(tbb::global_control::max_allowed_parallelism, 7);
    const Scene scene;
    const auto s = scene.supports(Method::limited, 6, 2, Rounding::plain);
    std::vector<FrameVerdict> verdicts;
    for (int threads : {1, 2, 7})
        tbb::task_arena(threads).execute([&] { verdicts.push_back(scene.verdict(Method::limited, 6, s)); });
    for (std::size_t i : {1u, 2u}) {
        CHECK(verdicts[0].failed == verdicts[i].failed);
        CHECK(verdicts[0].decided_by_filter == verdicts[i].decided_by_filter);
        for (std::size_t bv = 0; bv < verdicts[0].bvs.size(); ++bv)
            REQUIRE(verdicts[0].bvs[bv].loss.box == verdicts[i].bvs[bv].loss.box);
    }
}
