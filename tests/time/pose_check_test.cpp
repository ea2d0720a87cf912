// SPDX-License-Identifier: GPL-3.0-or-later
// Bounds for all poses within limits of random characters: proven by the exact side, and refuted by it where the limits
// that they were made for are smaller.
#include <cmath>
#include <random>

#include <catch2/catch.hpp>

#include "exact/pose_check.hpp"
#include "experiments/fuzz/time_case.hpp"
#include "tests/support.hpp"
#include "toolkit/time/bound_over.hpp"

using namespace cinch;

namespace {

std::vector<double> bounds_of(const TimeCase& subject, const Character& character, std::span<const PoseLimit> limits,
                              const RefitOptions& options)
{
    const TimedMotion motion = poses_within(character, limits, subject.surface);
    IntervalRefitter refit(subject.bvh, subject.surface, options, character.targets);
    std::vector<double> supports(subject.bvh.bvs.size() * static_cast<std::size_t>(options.kdop));
    bound_over(refit, motion, motion.first_s(), motion.last_s(), 0.01, supports);
    return supports;
}

} // namespace

TEST_CASE("bounds of all poses within limits are proven, those of smaller limits refuted")
{
    std::mt19937_64 random(23);
    auto between = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
    std::size_t refuted[2] = {}, cases = test::share_of(120), bounds = 0;
    for (std::size_t i = 0; i < cases; ++i) {
        TimeCase subject = draw_time_case(random());
        subject.character.rest.curves.clear();
        subject.character.rest.morphs.clear();
        const bool any = i % 3 == 2 && !subject.character.targets.empty();
        const std::optional<exact::Enclosure> any_weights =
            any ? std::optional(exact::Enclosure{-0.5, 1}) : std::nullopt;
        const Character bounded = any ? with_any_weights(Character(subject.character), -0.5, 1) : subject.character;
        std::vector<PoseLimit> limits, smaller;
        for (std::size_t b = 0; b < bounded.bones.size(); ++b) {
            const double angles[] = {
                0, between(0, 1e-3), between(0, 1), between(0, 3.14159265358979), 0x1p-60, 0x1.921fb54442d18p+1, 4};
            limits.push_back({angles[random() % 7], random() % 2 ? 0 : between(0, 0.2)});
            smaller.push_back({limits[b].angle / 4, limits[b].move / 4});
        }
        const RefitOptions options{.methods = i % 3 == 0 ? Method::local : Method::best,
                                   .kdop = kdops[i % kdops.size()],
                                   .precision = i % 2 ? Precision::float64 : Precision::float32};
        const exact::PoseChecker check(subject.surface, subject.bvh, subject.character, limits, any_weights,
                                       options.kdop, [] {});
        CAPTURE(i, any);
        const exact::TimeVerdict verdict = check(bounds_of(subject, bounded, limits, options));
        CHECK(verdict.violated == 0);
        CHECK(verdict.undecided == 0);
        bounds += verdict.bounds;
        // A quarter of the limits; and none at all of the first bone, which carries the others.
        refuted[0] += check(bounds_of(subject, bounded, smaller, options)).violated > 0;
        smaller = limits;
        smaller[0] = {};
        refuted[1] += check(bounds_of(subject, bounded, smaller, options)).violated > 0;
    }
    INFO(bounds << " bounds, of " << cases << " refuted " << refuted[0] << " and " << refuted[1]);
    CHECK((cases < 12 || refuted[0] > cases / 6)); // a few may have none
    CHECK((cases < 12 || refuted[1] > cases / 6)); // a few may have none
}
