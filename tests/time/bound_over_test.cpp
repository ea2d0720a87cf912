// SPDX-License-Identifier: GPL-3.0-or-later
// Bounds over time of random characters: proven by the exact side, which shares no formula with them, and found wrong
// by it where a term of theirs is dropped.
#include <cmath>
#include <random>

#include <catch2/catch.hpp>

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
std::size_t one_of(Random& random, std::size_t count)
{
    return std::uniform_int_distribution<std::size_t>(0, count - 1)(random);
}

exact::TimeVerdict verdict_on(const TimeCase& subject, const TimedMotion& motion, const RefitOptions& options,
                              CutInto by)
{
    const std::vector<double> supports = bounds_over_clip(subject, motion, options, by);
    const exact::ClipEnclosure clip(subject.character, subject.character.rest);
    const exact::TimeChecker check(subject.surface, subject.bvh, clip, subject.character.targets, options.kdop, [] {});
    return check(motion.first_s(), motion.last_s(), supports);
}

// The rest vertices at a time, morph targets added.
std::vector<Vec3> rest_at(const TimeCase& subject, const TimedMotion& motion, double t)
{
    std::vector<Vec3> out = subject.surface.mesh.vertices;
    const std::vector<double> weights = motion.weights ? motion.weights(t) : std::vector<double>();
    for (std::size_t i = 0; i < weights.size(); ++i) {
        const MorphTarget& target = subject.character.targets[i];
        for (std::size_t n = 0; n < target.vertex.size(); ++n)
            out[target.vertex[n]] += weights[i] * target.displacement[n];
    }
    return out;
}

Vec3 displacement_of(const MorphTarget& target, std::size_t vertex)
{
    const auto found = std::find(target.vertex.begin(), target.vertex.end(), vertex);
    return found == target.vertex.end() ? Vec3::Zero() : target.displacement[found - target.vertex.begin()];
}
Vec3 shift_of(const AffineMap& map) { return {map.m[0][3], map.m[1][3], map.m[2][3]}; }
Vec3 turned(const AffineMap& map, const Vec3& x) { return apply(map, x) - shift_of(map); }

} // namespace

TEST_CASE("bounds over time hold at all times, and whatever is dropped from them is found")
{
    Random random(7);
    std::size_t bounds = 0, undecided = 0, infinite_bounds = 0, dropped[3] = {};
    for (std::size_t i = 0, cases = test::share_of(120); i < cases; ++i) {
        const TimeCase subject = draw_time_case(random());
        const TimedMotion motion = character_motion(subject.character, subject.character.rest, subject.surface);
        const RefitOptions options{.methods = i % 3 == 0 ? Method::local : Method::best,
                                   .kdop = kdops[i % kdops.size()],
                                   .precision = i % 2 ? Precision::float64 : Precision::float32};
        const CutInto by = i % 4 == 1 ? CutInto::in_a_row : i % 2 ? CutInto::between_keys : CutInto::chosen;
        CAPTURE(i);
        exact::TimeVerdict verdict;
        try {
            verdict = verdict_on(subject, motion, options, by);
        } catch (const InputError&) { // half a turn to the bit
            continue;
        }
        CHECK(verdict.violated == 0);
        bounds += verdict.bounds;
        undecided += verdict.undecided;
        for (std::size_t kind = 0; kind < 3; ++kind) {
            TimedMotion wrong = motion;
            wrong.over = [&motion, kind](double a, double b) {
                MotionInterval out = motion.over(a, b);
                if (kind == 0)
                    for (auto& derivative : out.morph.at)
                        std::fill(derivative.begin(), derivative.end(), 0.0);
                for (std::size_t j = 0; j < out.limits.size(); ++j) {
                    auto& limit = out.limits[j];
                    if (kind == 0) { // no bump at all
                        out.bend[j] = {};
                        limit.remainder = limit.bump = 0;
                    } else if (kind == 1) { // half of it
                        for (auto& row : out.bend[j].m)
                            for (double& x : row)
                                x /= 2;
                        limit.remainder = limit.bump = limit.path = 0;
                    } else { // the end of the interval forgotten
                        out.last[j] = out.first[j];
                        limit.remainder = limit.bump = limit.path = 0;
                    }
                }
                return out;
            };
            dropped[kind] += verdict_on(subject, wrong, options, CutInto::between_keys).violated > 0;
        }
    }
    INFO(bounds << " bounds, " << undecided << " undecided, " << infinite_bounds << " infinite");
    CHECK(undecided == 0);
    for (std::size_t kind = 0; kind < 3; ++kind)
        CHECK(dropped[kind] > test::share_of(120) / 4);
}

TEST_CASE("frames that are interpolated are proven between them, and a frame left out is found")
{
    Random random(19);
    std::size_t found = 0;
    constexpr std::size_t cases = 20;
    for (std::size_t i = 0; i < cases; ++i) {
        TimeCase subject = draw_time_case(random());
        subject.character.targets.clear(); // frames have none
        subject.character.target_weights.clear();
        subject.character.rest.morphs.clear();
        const TimedMotion curves = character_motion(subject.character, subject.character.rest, subject.surface);
        auto frames = [&](std::vector<double> times) {
            return Clip(
                "frames", times.size(), [times](std::size_t f) { return times[f]; },
                [times, &curves](std::size_t f) { return curves.at(times[f]); });
        };
        const Clip whole = frames({-0.2, 0.1, 0.3, 0.9, 1.4}), part = frames({-0.2, 0.1, 0.9, 1.4});
        const exact::LinearEnclosure enclosure(whole);
        const exact::TimeChecker check(subject.surface, subject.bvh, enclosure, {}, 6, [] {});
        for (const Clip* bounded : {&whole, &part}) {
            const TimedMotion motion = linear_motion(*bounded, subject.surface);
            IntervalRefitter refit(subject.bvh, subject.surface, {});
            std::vector<double> supports(subject.bvh.bvs.size() * 6);
            bound_over(refit, motion, -0.2, 1.4, 0.01, supports);
            const exact::TimeVerdict verdict = check(-0.2, 1.4, supports);
            if (bounded == &whole)
                CHECK(verdict.proven() == verdict.bounds);
            else
                found += verdict.violated > 0;
        }
    }
    CHECK(found > cases / 2);
}

TEST_CASE("two keys nearly half a turn apart are decided")
{
    const TimeCase subject = draw_time_case(6156331518490970231u);
    const TimedMotion motion = character_motion(subject.character, subject.character.rest, subject.surface);
    const exact::TimeVerdict verdict =
        verdict_on(subject, motion, {.kdop = 14, .precision = Precision::float64}, CutInto::chosen);
    CHECK(verdict.proven() == verdict.bounds);
}

TEST_CASE("a support that a vertex passes at one moment is refuted there")
{
    Random random(5);
    std::size_t refuted = 0, cases = 0;
    for (std::size_t i = 0, count = test::share_of(60); i < count; ++i) {
        const TimeCase subject = draw_time_case(random());
        const TimedMotion motion = character_motion(subject.character, subject.character.rest, subject.surface);
        std::optional<exact::ClipEnclosure> clip;
        try {
            clip.emplace(subject.character, subject.character.rest);
        } catch (const InputError&) {
            continue;
        }
        // The farthest place of the root along one direction among many moments, and a support barely below it.
        const std::size_t bvs = subject.bvh.bvs.size(), d = i % 6;
        std::vector<double> supports(6 * bvs, HUGE_VAL);
        std::vector<Vec3> place(subject.surface.mesh.vertices.size());
        double most = -HUGE_VAL, size = 0;
        for (int n = 1; n < 500; ++n) {
            const double t = motion.first_s() + (motion.last_s() - motion.first_s()) * n / 500;
            evaluate(rest_at(subject, motion, t), subject.surface.weights, motion.at(t), place);
            for (const Vec3& x : place) {
                most = std::max(most, (d % 2 ? -1 : 1) * x[static_cast<int>(d / 2)]);
                size = std::max(size, std::abs(x[static_cast<int>(d / 2)]));
            }
        }
        supports[d] = most - 1e-9 * size;
        const exact::TimeChecker check(subject.surface, subject.bvh, *clip, subject.character.targets, 6, [] {});
        const exact::TimeVerdict verdict = check(motion.first_s(), motion.last_s(), supports);
        ++cases;
        refuted += verdict.violated == 1 && verdict.worst && verdict.worst->at_least > supports[d];
        CAPTURE(i, verdict.undecided, most, size);
        CHECK(verdict.violated == 1);
        // And where it says so it is so.
        if (verdict.worst) {
            double reach = -HUGE_VAL; // then, or just before, where a curve jumps then
            for (const double t : {verdict.worst->time_s, std::nextafter(verdict.worst->time_s, -HUGE_VAL)}) {
                const Vec3 then = evaluate_vertex(rest_at(subject, motion, t)[verdict.worst->vertex],
                                                  subject.surface.weights.of(verdict.worst->vertex), motion.at(t));
                reach = std::max(reach, (d % 2 ? -1 : 1) * then[static_cast<int>(d / 2)]);
            }
            CHECK(reach >= verdict.worst->at_least - 1e-6 * size);
        }
    }
    CHECK(refuted == cases);
}

TEST_CASE("limits of an interval hold divided differences of the places, and not by far more")
{
    Random random(13);
    double nearest[3] = {};
    for (std::size_t i = 0, cases = test::share_of(200); i < cases; ++i) {
        const TimeCase subject = draw_time_case(random());
        const TimedMotion motion = character_motion(subject.character, subject.character.rest, subject.surface);
        for (std::size_t k = 1; k < motion.keys.size(); ++k) {
            const double a = motion.keys[k - 1], b = motion.keys[k], length = b - a, step = length / 32;
            const MotionInterval interval = motion.over(a, b);
            std::vector<std::vector<AffineMap>> maps;
            std::vector<std::vector<Vec3>> rest;
            for (int n = 1; n < 32; ++n) { // inside, where jumps at keys do not count
                maps.push_back(motion.at(a + n * step));
                rest.push_back(rest_at(subject, motion, a + n * step));
            }
            for (std::size_t v = 0; v < subject.surface.mesh.vertices.size(); ++v)
                for (const std::uint32_t j : subject.surface.weights.of(v).node) {
                    std::vector<Vec3> x;
                    double size = 0;
                    for (std::size_t n = 0; n < maps.size(); ++n) {
                        x.push_back(apply(maps[n][j], rest[n][v]));
                        size = std::max(size, x.back().norm());
                    }
                    const MotionInterval::Limits& limit = interval.limits[j];
                    // −(D²/8) x″(m), and the same at some time within a 32th of the interval, where it differs by a
                    // 32th of (D³/8) ‖x‴‖ at most.
                    Vec3 bend = turned(interval.bend[j], rest[15][v]) + shift_of(interval.bend[j]);
                    for (std::size_t i_ = 0; i_ < interval.morph.at[1].size(); ++i_) {
                        const Vec3 d = displacement_of(subject.character.targets[i_], v);
                        bend += interval.morph.at[1][i_] * turned(interval.morph.slope[j], d) +
                                interval.morph.at[2][i_] * turned(interval.morph.still[j], d);
                    }
                    const Vec3 second = (x[16] - 2 * x[15] + x[14]) * (-32 * 32 / 8.0);
                    CHECK((second - bend).norm() <= limit.remainder / 8 + limit.bend_error + 1e-11 * size);
                    // D ‖x′‖, (D²/8) ‖x″‖ and (D³/32) ‖x‴‖, each at some time between.
                    const double most[3] = {limit.path, limit.bump, limit.remainder}, part[3] = {1, 1.0 / 8, 1.0 / 32};
                    double times = 1;
                    for (std::size_t order = 0; order < 3; ++order) {
                        times *= 32;
                        for (std::size_t n = 0; n + 1 < x.size(); ++n)
                            x[n] = x[n + 1] - x[n];
                        x.pop_back();
                        double found = 0;
                        for (const Vec3& difference : x)
                            found = std::max(found, difference.norm() * times * part[order]);
                        const double rounding = 1e-13 * size * times;
                        CAPTURE(i, k, j, order);
                        CHECK(found <= most[order] + rounding);
                        if (found > 1e3 * rounding)
                            nearest[order] = std::max(nearest[order], found / most[order]);
                    }
                }
        }
    }
    for (const double share : nearest)
        CHECK(share > 0.9);
}

TEST_CASE("BVs are bounded over an interval as they are among all, with what is below them")
{
    Random random(17);
    for (std::size_t i = 0; i < 20; ++i) {
        TimeCase subject = draw_time_case(random());
        if (i % 2) // morph targets alone move it
            subject.character.rest.curves.clear();
        const TimedMotion motion = character_motion(subject.character, subject.character.rest, subject.surface);
        const RefitOptions options{.kdop = 6};
        IntervalRefitter refit(subject.bvh, subject.surface, options, subject.character.targets);
        const std::vector<double>& keys = motion.keys;
        for (std::size_t n = 0; n < 12; ++n) {
            const std::size_t k = 1 + one_of(random, keys.size() - 1);
            const double middle = keys[k - 1] + (keys[k] - keys[k - 1]) / 2;
            const MotionInterval interval = n % 2 ? motion.over(keys[k - 1], middle) : motion.over(middle, keys[k]);
            std::vector<std::uint32_t> some; // and all below them
            std::vector<bool> marked(subject.bvh.bvs.size());
            for (std::uint32_t bv = 0; bv < marked.size(); ++bv) {
                if (!marked[bv] && one_of(random, 4) > 0)
                    continue;
                some.push_back(bv);
                if (const Bv& of = subject.bvh.bvs[bv]; !of.is_leaf())
                    marked[of.first_child] = marked[of.first_child + 1] = true;
            }
            auto bounds_of = [&](BvList bvs) {
                std::vector<double> out(bvs.size() * 6);
                const InstantBounds first = refit.at(bvs, interval.first, interval.morph.first),
                                    last = refit.at(bvs, interval.last, interval.morph.last);
                refit(bvs, interval, first, last, n % 3 == 0 ? 0.01 : 0, out);
                return out;
            };
            const std::vector<double> all = bounds_of(refit.all()), own = bounds_of(some);
            for (std::size_t s = 0; s < own.size(); ++s)
                CHECK(own[s] == all[some[s / 6] * 6 + s % 6]);
        }
    }
}

TEST_CASE("joint matrices are as near to the exact ones as their errors say, at all times")
{
    Random random(11);
    for (std::size_t i = 0, cases = test::share_of(200); i < cases; ++i) {
        const TimeCase subject = draw_time_case(random());
        const TimedMotion motion = character_motion(subject.character, subject.character.rest, subject.surface);
        std::optional<exact::ClipEnclosure> clip;
        try {
            clip.emplace(subject.character, subject.character.rest);
        } catch (const InputError&) {
            continue;
        }
        for (std::size_t k = 1; k < motion.keys.size(); ++k) {
            const double a = motion.keys[k - 1], b = motion.keys[k];
            const MotionInterval interval = motion.over(a, b);
            std::vector<exact::MapEnclosure> maps, slopes;
            for (const bool last : {false, true}) {
                clip->at(last ? b : a, last ? b : a, a, b, maps, slopes);
                for (std::size_t v = 0; v < subject.surface.mesh.vertices.size(); ++v)
                    for (const std::uint32_t j : subject.surface.weights.of(v).node) {
                        const Vec3& y = subject.surface.mesh.vertices[v];
                        const Vec3 computed = apply((last ? interval.last : interval.first)[j], y);
                        for (int r = 0; r < 3; ++r) {
                            double low = maps[j].m[r][3].low, high = maps[j].m[r][3].high,
                                   wide = 1e-12 * computed.norm();
                            for (int c = 0; c < 3; ++c) {
                                const double x = maps[j].m[r][c].low * y[c], z = maps[j].m[r][c].high * y[c];
                                low += std::min(x, z);
                                high += std::max(x, z);
                                wide += 1e-15 * (std::abs(x) + std::abs(z));
                            }
                            const double error = interval.limits[j].error;
                            CHECK(computed[r] >= low - error - 1e-3 * wide);
                            CHECK(computed[r] <= high + error + 1e-3 * wide);
                        }
                    }
            }
        }
    }
}

TEST_CASE("the greatest value between two ends")
{
    const double infinity = HUGE_VAL;
    CHECK(greatest_between(1, 2, 0, infinity) >= 2);
    CHECK(greatest_between(1, 2, 0, infinity) < 2.0000001);
    CHECK(greatest_between(1, 2, -5, infinity) < 2.0000001);      // convex: an end
    CHECK(greatest_between(0, 0, 3, infinity) == Approx(3));      // symmetric: the bump
    CHECK(greatest_between(0, 1, 1, infinity) == Approx(1.5625)); // 1/2 + 1 + 1/16
    CHECK(greatest_between(0, 8, 1, infinity) == Approx(8));      // steep: an end
    CHECK(greatest_between(0, 4, 1, infinity) == Approx(4));      // where both say the same
    CHECK(greatest_between(0, 1, 10, 1) == Approx(1));            // no way to go further
    CHECK(greatest_between(0, 0, 10, 1) == Approx(0.5));          // half there, half back
    CHECK(greatest_between(infinity, 0, 1, 1) == infinity);
    CHECK(greatest_between(0, 0, std::nan(""), infinity) == infinity);
    CHECK(greatest_between(0, 1e-170, 0.5e-170, infinity) >= 1.125e-170); // squares of which vanish
    CHECK(greatest_between(0, 1e-170, 0.5e-170, infinity) < 1.1251e-170);
    CHECK(greatest_between(0, 0x1p-1074, 0x1p-1074, infinity) >= 0x1p-1073); // 1.5625 of the least number
    CHECK(greatest_between(-1.7e308, 1.7e308, 0x1p1023, infinity) == infinity);
    CHECK(greatest_between(0, 1, HUGE_VAL, 1) == Approx(1)); // its way says enough
    Random random(3);
    for (int i = 0; i < 10000; ++i) { // against the parabola itself
        const double a = between(random, -1, 1), b = between(random, -1, 1), s = between(random, -1, 1);
        double most = -infinity;
        for (int n = 0; n <= 200; ++n) {
            const double w = n / 200.0;
            most = std::max(most, (1 - w) * a + w * b + 4 * w * (1 - w) * std::max(s, 0.0));
        }
        CHECK(greatest_between(a, b, s, infinity) >= most);
        CHECK(greatest_between(a, b, s, infinity) <= most + 1e-4);
    }
}
