// SPDX-License-Identifier: GPL-3.0-or-later
// Bounds that tighten: proven at every step, never looser, and in the end those of the vertices.
#include <cmath>

#include <catch2/catch.hpp>

#include "cinch/refit.hpp"
#include "exact/verifier.hpp"
#include "tests/support.hpp"

using namespace cinch;
using namespace cinch::exact;

namespace {

// Supports of one BV that are below a vertex, exactly deformed or as computed.
int violated(const Verifier& verifier, std::size_t bvs, std::span<const AffineMap> maps, int kdop, std::size_t bv,
             std::span<const double> own)
{
    const auto k = static_cast<std::size_t>(kdop);
    std::vector<double> all(bvs * k, HUGE_VAL);
    std::copy(own.begin(), own.end(), all.begin() + static_cast<std::ptrdiff_t>(bv * k));
    const FrameVerdict verdict = verifier.check(maps, Method::vertices, kdop, all);
    return static_cast<int>(
        std::count_if(verdict.failed.begin(), verdict.failed.end(), [](auto mask) { return mask != 0; }));
}

} // namespace

TEST_CASE("a bound that tightens is proven at every step, never grows, and ends at the vertices")
{
    const test::Example e = test::example(400, 12);
    std::size_t steps = 0, tighter = 0;
    for (const std::size_t leaf : {1u, 7u})
        for (const int kdop : {6, 14, 26})
            for (const Precision precision : {Precision::float32, Precision::float64}) {
                const Bvh bvh = build_bvh(e.surface, leaf);
                const Verifier verifier(e.surface, bvh);
                const RefitOptions options{Method::best, kdop, Rounding::proven, precision};
                AnytimeBounder bounder(bvh, e.surface, options);
                const auto& maps = e.frames[2];
                std::vector<double> bound(bvh.bvs.size() * static_cast<std::size_t>(kdop)), truth(bound);
                refit(bvh, e.surface, maps, options, bound);
                refit(bvh, e.surface, maps, {Method::vertices, kdop}, truth);
                bounder.begin(maps);
                for (const std::size_t bv : {std::size_t{0}, std::size_t{2}, bvh.bvs.size() - 1}) {
                    CAPTURE(leaf, kdop, bv);
                    const std::size_t at = bv * static_cast<std::size_t>(kdop);
                    bounder.begin(bv);
                    std::vector<double> before(bounder.supports().begin(), bounder.supports().end());
                    for (std::size_t d = 0; d < before.size(); ++d)
                        REQUIRE(before[d] == bound[at + d]);
                    for (std::size_t step = 0;; ++step) {
                        if (step < 4 || step % 8 == 0)
                            REQUIRE(violated(verifier, bvh.bvs.size(), maps, kdop, bv, bounder.supports()) == 0);
                        if (!bounder.refine())
                            break;
                        ++steps;
                        for (std::size_t d = 0; d < before.size(); ++d) {
                            REQUIRE(bounder.supports()[d] <= before[d]);
                            REQUIRE(bounder.reached()[d] <= truth[at + d]);
                            tighter += bounder.supports()[d] < before[d];
                            before[d] = bounder.supports()[d];
                        }
                    }
                    REQUIRE(violated(verifier, bvh.bvs.size(), maps, kdop, bv, bounder.supports()) == 0);
                    for (std::size_t d = 0; d < before.size(); ++d)
                        REQUIRE(before[d] == std::min(truth[at + d], bound[at + d]));
                    REQUIRE_FALSE(bounder.refine());
                    REQUIRE(std::equal(before.begin(), before.end(), bounder.supports().begin()));
                }
            }
    CHECK(steps > 1000);
    CHECK(tighter > 1000);
}

TEST_CASE("a bound that tightens stops at its tolerance, or when its time is over, and begins anew with each frame")
{
    const test::Example e = test::example(2000, 30);
    const Bvh bvh = build_bvh(e.surface, 4);
    AnytimeBounder bounder(bvh, e.surface);
    std::vector<double> truth(6 * bvh.bvs.size());
    std::size_t before = 0;
    for (const auto& maps : e.frames) {
        refit(bvh, e.surface, maps, {Method::vertices, 6}, truth);
        bounder.begin(maps);
        for (const double tolerance : {1.0, 0.1, 0.01, 0.0}) {
            bounder.begin(0);
            const std::size_t steps = bounder.refine_to(tolerance);
            for (std::size_t d = 0; d < 6; ++d) {
                const double width = truth[d] + truth[d ^ 1];
                CHECK(bounder.supports()[d] <= truth[d] + tolerance * width * (1 + 1e-12));
                CHECK(bounder.supports()[d] >= bounder.reached()[d] * (1 - 1e-12));
            }
            CHECK(steps > 0);
            CHECK(steps >= before);
            CHECK(steps < 2 * bvh.bvs.size() / 3); // few of them are looked at
            before = tolerance == 0 ? 0 : steps;
        }
        bounder.begin(0);
        CHECK(bounder.refine_for(std::chrono::nanoseconds(0)) == 0);
        CHECK(bounder.reached()[0] == -bounder.supports()[1]);
        CHECK(bounder.refine_for(std::chrono::hours(1)) > 0);
        CHECK_FALSE(bounder.refine());
    }
    CHECK_THROWS_AS(bounder.begin(bvh.bvs.size()), std::out_of_range);
    CHECK_THROWS_AS(bounder.begin(std::span<const AffineMap>()), std::invalid_argument);
    CHECK_THROWS_AS(AnytimeBounder(bvh, e.surface, {Method::best, 7}), std::invalid_argument);
}

TEST_CASE("a bound that tightens stays infinite where a transform is not finite, and ends")
{
    const test::Example e = test::example(400, 12);
    const Bvh bvh = build_bvh(e.surface, 4);
    AnytimeBounder bounder(bvh, e.surface);
    auto maps = e.frames[1];
    for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL, 1e308}) {
        maps[3].m[1][2] = bad;
        bounder.begin(maps);
        bounder.begin(0);
        CHECK(bounder.refine_to(0) < 2 * bvh.bvs.size());
        if (std::isfinite(bad)) { // too large for the kernels, but not for the vertices
            const Verifier verifier(e.surface, bvh);
            CHECK(violated(verifier, bvh.bvs.size(), maps, 6, 0, bounder.supports()) == 0);
        } else {
            CHECK(bounder.supports()[2] == HUGE_VAL);
            CHECK(bounder.supports()[3] == HUGE_VAL);
        }
        CHECK_FALSE(bounder.refine());
    }
}
