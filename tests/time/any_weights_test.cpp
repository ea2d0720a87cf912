// SPDX-License-Identifier: GPL-3.0-or-later
// Morph targets whose weights a program sets: any of a range, at any time.
#include <random>

#include <catch2/catch.hpp>

#include "cinch/deform.hpp"
#include "cinch/io.hpp"
#include "exact/clip_enclosure.hpp"
#include "exact/time_check.hpp"
#include "experiments/fuzz/time_case.hpp"
#include "tests/support.hpp"
#include "toolkit/time/bound_over.hpp"
#include "toolkit/time/character_motion.hpp"

using namespace cinch;

namespace {

using Random = std::mt19937_64;

double between(Random& random, double low, double high)
{
    return std::uniform_real_distribution<double>(low, high)(random);
}

std::vector<double> bounds_of(const TimeCase& drawn, const Character& character, const RefitOptions& options,
                              double tolerance)
{
    const TimedMotion motion = character_motion(character, character.rest, drawn.surface);
    IntervalRefitter refit(drawn.bvh, drawn.surface, options, character.targets);
    std::vector<double> supports(drawn.bvh.bvs.size() * static_cast<std::size_t>(options.kdop));
    bound_over(refit, motion, motion.first_s(), motion.last_s(), tolerance, supports);
    return supports;
}

} // namespace

TEST_CASE("bounds for any weights of morph targets hold for all of them at all times, and smaller boxes are found out")
{
    Random random(19);
    std::size_t cases = 0, undecided = 0, found = 0, finite = 0;
    for (std::size_t i = 0; cases < test::share_of(60); ++i) {
        const TimeCase drawn = draw_time_case(random());
        if (drawn.character.targets.empty())
            continue;
        CAPTURE(i);
        const double least = i % 3 == 0 ? -0.5 : i % 3 == 1 ? 0 : 0.25, greatest = i % 3 == 2 ? 0.25 : 1;
        const Character any = with_any_weights(drawn.character, least, greatest);
        const RefitOptions options{.kdop = kdops[i % kdops.size()],
                                   .precision = i % 2 ? Precision::float64 : Precision::float32};
        const double tolerance = i % 2 ? 1e6 : 0.01;
        std::optional<exact::ClipEnclosure> clip;
        try {
            clip.emplace(drawn.character, drawn.character.rest, exact::Enclosure{least, greatest});
        } catch (const InputError&) { // half a turn to the bit
            continue;
        }
        ++cases;
        const exact::TimeChecker check(drawn.surface, drawn.bvh, *clip, drawn.character.targets, options.kdop, [] {});
        const double first_s = any.rest.first_s, last_s = any.rest.last_s;
        const std::vector<double> supports = bounds_of(drawn, any, options, tolerance);
        const exact::TimeVerdict verdict = check(first_s, last_s, supports);
        CHECK(verdict.violated == 0);
        undecided += verdict.undecided;
        finite += static_cast<std::size_t>(
            std::count_if(supports.begin(), supports.end(), [](double s) { return std::isfinite(s); }));

        // Vertices as they are computed, of weights at the ends of the range and between.
        const auto axes = axes_of(options.kdop);
        const TimedMotion motion = character_motion(any, any.rest, drawn.surface);
        for (int sample = 0; sample < 40; ++sample) {
            std::vector<Vec3> rest = drawn.surface.mesh.vertices, place(rest.size());
            for (const MorphTarget& target : drawn.character.targets) {
                const double a = sample % 2 ? between(random, least, greatest) : random() & 1 ? least : greatest;
                for (std::size_t n = 0; n < target.vertex.size(); ++n)
                    rest[target.vertex[n]] += a * target.displacement[n];
            }
            evaluate(rest, drawn.surface.weights, motion.at(between(random, first_s, last_s)), place);
            for (std::size_t bv = 0; bv < drawn.bvh.bvs.size(); ++bv)
                for (const std::uint32_t v : vertices_of(drawn.surface, drawn.bvh, drawn.bvh.bvs[bv]))
                    for (std::size_t d = 0; d < static_cast<std::size_t>(options.kdop); ++d) {
                        double along = 0;
                        for (std::size_t c = 0; c < 3; ++c)
                            along += (d % 2 ? -1 : 1) * axes[d / 2][c] * place[v][static_cast<int>(c)];
                        const double support = supports[bv * static_cast<std::size_t>(options.kdop) + d];
                        REQUIRE(along <= support + (d < 6 ? 0 : 1e-12 * std::abs(support)));
                    }
        }

        Character less = any;
        for (Vec3& half : less.targets.front().half)
            half *= 0.5;
        const exact::TimeVerdict damaged = check(first_s, last_s, bounds_of(drawn, less, options, 1e-3));
        found += least < greatest && damaged.violated > 0;
    }
    CHECK(undecided == 0);
    CHECK(finite > cases);
    CHECK(found > (cases < 40 ? 0 : cases / 4)); // a third of the ranges is a point
}

TEST_CASE("weights of a range that is a point are refuted and proven as known ones are")
{
    Random random(23);
    std::size_t violated = 0;
    for (std::size_t i = 0, cases = 0; cases < test::share_of(40); ++i) {
        const TimeCase drawn = draw_time_case(random());
        if (drawn.character.targets.empty())
            continue;
        CAPTURE(i);
        Character known = drawn.character;
        std::fill(known.target_weights.begin(), known.target_weights.end(), 0.25);
        known.rest.morphs.clear();
        const int kdop = kdops[i % kdops.size()];
        const TimedMotion motion = character_motion(known, known.rest, drawn.surface);
        IntervalRefitter refit(drawn.bvh, drawn.surface, {.kdop = kdop}, known.targets);
        std::vector<double> supports(drawn.bvh.bvs.size() * static_cast<std::size_t>(kdop)); // of one pose
        supports = refit.at(refit.all(), motion.at(motion.first_s()), known.target_weights).supports;
        exact::TimeVerdict verdict[2];
        try {
            for (const bool any : {false, true}) {
                const exact::ClipEnclosure clip(known, known.rest,
                                                any ? std::optional(exact::Enclosure{0.25, 0.25}) : std::nullopt);
                const exact::TimeChecker check(drawn.surface, drawn.bvh, clip, known.targets, kdop, [] {});
                verdict[any] = check(motion.first_s(), motion.last_s(), supports);
            }
        } catch (const InputError&) { // half a turn to the bit
            continue;
        }
        ++cases;
        CHECK(verdict[0].violated == verdict[1].violated);
        CHECK(verdict[0].proven() == verdict[1].proven());
        violated += verdict[1].violated;
    }
    CHECK(violated > 100);
}

TEST_CASE("what is displaced far from a bone that turns moves as far as it is displaced")
{
    Character character;
    character.mesh = {{{0, 0, 0}, {1e-3, 0, 0}, {0, 1e-3, 0}}, {{0, 1, 2}}};
    character.influences = {1, {0, 1, 2, 3}, {0, 0, 0}, {1, 1, 1}};
    character.joints = {{0, identity_map}};
    character.bones.resize(1);
    character.carried = 1;
    character.targets = {{{0, 1, 2}, {{1, 0, 0}, {1, 0, 0}, {1, 0, 0}}, {}}};
    character.target_weights = {0};
    character.rest.first_s = 0;
    character.rest.last_s = 1;
    character.rest.curves = {{0,
                              Curve::Target::rotation,
                              Curve::Interpolation::linear,
                              {0, 1},
                              {{0, 0, 0, 1}, {0, 0, std::sin(1.1), std::cos(1.1)}}}};
    TimeCase turning{character, surface_of(character), {}};
    turning.bvh = build_bvh(turning.surface, 1);
    const exact::ClipEnclosure clip(character, character.rest, exact::Enclosure{0, 1});
    const exact::TimeChecker check(turning.surface, turning.bvh, clip, character.targets, 6, [] {});
    const exact::TimeVerdict verdict = check(0, 1, bounds_of(turning, with_any_weights(character), {}, 1e6));
    CHECK(verdict.proven() == verdict.bounds);
}

TEST_CASE("one box stands for all weights of a character, and clips set none")
{
    Character character;
    character.targets = {{{0, 2}, {{1, -2, 0}, {0, 0, 1}}, {}}, {{0}, {{3, 1, 0}}, {}}, {}};
    character.target_weights = {0.5, 0, 0};
    character.animations.resize(1);
    character.animations[0].morphs = {{0, 2, Curve::Interpolation::linear, {0, 1}, {0, 0, 1, 1}}};
    const Character any = with_any_weights(character);
    REQUIRE(any.targets.size() == 3);
    CHECK(any.target_weights == std::vector<double>{1, 0, 0});
    CHECK(any.animations[0].morphs.empty());
    const MorphTarget& box = any.targets[0];
    CHECK(box.vertex == std::vector<std::uint32_t>{0, 2});
    CHECK(box.displacement[0] == Vec3(2, -0.5, 0)); // (0, -2, 0) to (4, 1, 0)
    CHECK((box.half[0] - Vec3(2, 1.5, 0)).norm() < 1e-14);
    CHECK((box.half[0] - Vec3(2, 1.5, 0)).minCoeff() > 0);
    CHECK(any.targets[1].vertex.empty());
    CHECK_THROWS_AS(with_any_weights(character, 1, 0), std::invalid_argument);
    CHECK_THROWS_AS(with_any_weights(character, 0, HUGE_VAL), std::invalid_argument);
    CHECK_THROWS_AS(with_any_weights(character, 0, 1e308), InputError); // 4e308

    // Sums that cancel: the box holds them as they are computed, in either order.
    Character cancelling;
    const double parts[] = {0.1, 1e10, -1e10, 0.7, 3e-9, -0.3};
    for (const double d : parts)
        cancelling.targets.push_back({{0}, {{d, 0, 0}}, {}});
    cancelling.target_weights.assign(std::size(parts), 0);
    const MorphTarget point = with_any_weights(cancelling, 1. / 3, 1. / 3).targets[0];
    double up = 0, down = 0;
    for (std::size_t i = 0; i < std::size(parts); ++i) {
        up += 1. / 3 * parts[i];
        down += 1. / 3 * parts[std::size(parts) - 1 - i];
    }
    CHECK(up != down);
    for (const double sum : {up, down})
        CHECK(std::abs(sum - point.displacement[0][0]) <= point.half[0][0]);
    CHECK(point.half[0][0] < 1e-4);
}
