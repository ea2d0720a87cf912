// SPDX-License-Identifier: GPL-3.0-or-later
// Morph targets in single frames: weights known, bounds and their proof.
#include <cmath>
#include <limits>
#include <random>

#include <catch2/catch.hpp>

#include "cinch/deform.hpp"
#include "cinch/io.hpp"
#include "cinch/refit.hpp"
#include "exact/verifier.hpp"
#include "experiments/fuzz/time_case.hpp"
#include "tests/support.hpp"
#include "toolkit/time/character_motion.hpp"

using namespace cinch;

namespace {

using Random = std::mt19937_64;

std::size_t violated(const exact::FrameVerdict& verdict)
{
    return static_cast<std::size_t>(
        std::count_if(verdict.failed.begin(), verdict.failed.end(), [](auto mask) { return mask != 0; }));
}

// A sphere all of whose vertices are displaced far by many targets that nearly cancel: all that is left is rounding.
struct Cancelling {
    test::Example e = test::example(200, 6);
    Bvh bvh = build_bvh(e.surface, 4);
    std::vector<MorphTarget> targets{24};
    std::vector<double> weights;

    explicit Cancelling(double scale)
    {
        Random random(3);
        std::uniform_real_distribution<double> unit(-1, 1);
        for (std::size_t i = 0; i < targets.size(); ++i) {
            weights.push_back(i % 2 ? -weights.back() : unit(random));
            for (std::uint32_t v = 0; v < e.surface.mesh.vertices.size(); ++v) {
                targets[i].vertex.push_back(v);
                targets[i].displacement.push_back(i % 2 ? targets[i - 1].displacement[v]
                                                        : Vec3(scale * Vec3(unit(random), unit(random), unit(random))));
            }
        }
        std::shuffle(weights.begin(), weights.end(), Random(4)); // pairs are apart
        std::shuffle(targets.begin(), targets.end(), Random(4));
    }
};

} // namespace

TEST_CASE("frames with morph targets are proven by every method, and without what targets add they are not")
{
    Random random(23);
    std::vector<Methods> methods(all_methods.begin(), all_methods.end());
    methods.push_back(Method::support | Method::linear);
    std::size_t cases = 0, moved = 0, found = 0;
    for (std::size_t i = 0; cases < test::share_of(120); ++i) {
        const TimeCase drawn = draw_time_case(random());
        Clip clip;
        try {
            clip = sample(drawn.character, drawn.character.rest, 3);
            for (std::size_t f = 0; f < clip.frame_count(); ++f)
                clip.frame(f);
        } catch (const InputError&) { // overflows
            continue;
        }
        if (!clip.displaces())
            continue;
        CAPTURE(i);
        ++cases;
        const TimedMotion motion = character_motion(drawn.character, drawn.character.rest, drawn.surface);
        const RefitOptions options{.methods = methods[i % methods.size()],
                                   .kdop = kdops[i % kdops.size()],
                                   .precision = i % 2 ? Precision::float64 : Precision::float32};
        const auto& targets = drawn.character.targets;
        Refitter refit(drawn.bvh, drawn.surface, options, targets);
        const exact::Verifier verifier(drawn.surface, drawn.bvh, nullptr, targets);
        std::vector<double> supports(drawn.bvh.bvs.size() * static_cast<std::size_t>(options.kdop));
        bool moves = false, bites = false;
        for (std::size_t f = 0; f < clip.frame_count(); ++f) {
            const Clip::Frame maps = clip.frame(f);
            const std::vector<double> weights = clip.weights(f), also = motion.weights(clip.time_s(f));
            REQUIRE(weights.size() == targets.size());
            for (std::size_t t = 0; t < weights.size(); ++t)
                CHECK(weights[t] == Approx(also[t]).epsilon(1e-9).margin(1e-6)); // tangents of 1e6
            refit(maps, weights, supports);
            const auto verdict =
                verifier.check(maps, options.methods, options.kdop, supports, RestShape::aabb, weights);
            CHECK(violated(verdict) == 0);
            refit(maps, supports);
            moves = moves || std::any_of(weights.begin(), weights.end(), [](double a) { return a != 0; });
            bites = bites || violated(verifier.check(maps, options.methods, options.kdop, supports, RestShape::aabb,
                                                     weights)) > 0;
        }
        moved += moves;
        found += bites;
    }
    CAPTURE(moved, found);
    CHECK(10 * found > 6 * moved);
}

TEST_CASE("what displacing rounds is within bounds of displaced vertices, however large what cancels is")
{
    for (const double scale : {1.0, 1e3, 1e12, 1e-12, 1e-300, 1e150})
        for (const Method method : {Method::vertices, Method::best, Method::limited}) {
            CAPTURE(scale, name_of(method));
            const Cancelling c(scale);
            const RefitOptions options{.methods = method, .kdop = 26, .precision = Precision::float64};
            std::vector<double> supports(c.bvh.bvs.size() * 26);
            for (const auto& maps : c.e.frames) {
                Refitter(c.bvh, c.e.surface, options, c.targets)(maps, c.weights, supports);
                const exact::Verifier verifier(c.e.surface, c.bvh, nullptr, c.targets);
                const auto verdict = verifier.check(maps, options.methods, 26, supports, RestShape::aabb, c.weights);
                CHECK(violated(verdict) == 0);
                CHECK(std::isfinite(supports[0]));
            }
        }
}

TEST_CASE("targets change the bounds of what they displace alone")
{
    const test::Example e = test::example(400, 30);
    const Bvh bvh = build_bvh(e.surface, 2);
    MorphTarget nose{{7, 8}, {{0.1, 0, 0}, {0, 0.2, 0}}, {}};
    const std::vector<MorphTarget> targets{nose};
    const RefitOptions options{.kdop = 14};
    Refitter refit(bvh, e.surface, options, targets), plain(bvh, e.surface, options);
    std::vector<double> with(bvh.bvs.size() * 14), without(with.size());
    plain(e.frames[1], without);
    for (const double weight : {0.7, std::numeric_limits<double>::infinity(), std::nan("")}) {
        refit(e.frames[1], std::vector{weight}, with);
        std::size_t displaced = 0;
        for (std::size_t i = 0; i < bvh.bvs.size(); ++i) {
            const auto vertices = vertices_of(e.surface, bvh, bvh.bvs[i]);
            const bool meets = std::find(vertices.begin(), vertices.end(), 7u) != vertices.end() ||
                               std::find(vertices.begin(), vertices.end(), 8u) != vertices.end();
            displaced += meets;
            for (std::size_t d = 14 * i; d < 14 * (i + 1); ++d)
                CHECK((meets ? weight < 1 ? with[d] > without[d] : with[d] == HUGE_VAL : with[d] == without[d]));
        }
        CHECK(displaced > 0);
        CHECK(displaced < bvh.bvs.size());
    }
    refit(e.frames[1], std::vector<double>(), with);
    CHECK(with == without);
    refit(e.frames[1], std::vector{0.0}, with);
    CHECK(with == without);
    CHECK_THROWS_AS(refit(e.frames[1], std::vector{1.0, 1.0}, with), std::invalid_argument);
    const exact::Verifier verifier(e.surface, bvh, nullptr, targets);
    CHECK_THROWS_AS(verifier.check(e.frames[1], options.methods, 14, without, RestShape::aabb, std::vector{1.0, 1.0}),
                    std::invalid_argument);
    CHECK_THROWS_AS(
        verifier.check(e.frames[1], options.methods, 14, without, RestShape::aabb, std::vector{std::nan("")}),
        std::invalid_argument);
}
