// SPDX-License-Identifier: GPL-3.0-or-later
// Small spaces with answers worked out by hand; the exact side checks the rest (tests/exact).
#include <limits>

#include <catch2/catch.hpp>
#include <rapidcheck/catch.h>

#include "toolkit/bounds/rounding.hpp"
#include "toolkit/bounds/weight_space.hpp"

using namespace cinch;

namespace {

struct Space {
    std::vector<double> l, h;
    WeightSpace view() const { return {l, h}; }
};

double best(const Space& space, const std::vector<double>& b)
{
    std::vector<std::pair<double, double>> scratch;
    return best_lambda(space.view(), b, scratch);
}

double plain(const Space& space, const std::vector<double>& b, double lambda)
{
    return dual_bound(space.view(), b, lambda, Rounding::plain);
}

} // namespace

TEST_CASE("the dual at the second-largest b is Eq. 12")
{
    const Space space{{0.125, 0.25, 0.125}, {0.5, 0.75, 0.5}};
    const std::vector<double> b{8, 2, 4};
    // h₁b₁ + (1 − h₁ − l₂)b₃ + l₂b₂ with j₁ = 0 and j₂ = 2: ½·8 + (1 − ½ − ¼)·4 + ¼·2
    CHECK(second_largest(b) == 4);
    CHECK(plain(space, b, 4) == 5.5);
    CHECK(second_largest(std::vector<double>{3, 3, 1}) == 3);
    CHECK(second_largest(std::vector<double>{7}) == 7);
}

TEST_CASE("the best λ attains the optimum")
{
    const Space space{{0, 0, 0, 0.25}, {0.25, 0.25, 0.5, 1}};
    const std::vector<double> b{10, 8, 6, 1};
    // From l: slack ¾ goes to 10 (¼), 8 (¼), then 6 (¼ of ½): λ = 6
    CHECK(best(space, b) == 6);
    CHECK(plain(space, b, 6) == 0.25 * 10 + 0.25 * 8 + 0.25 * 6 + 0.25 * 1);
    CHECK(plain(space, b, 8) > plain(space, b, 6));
    CHECK(plain(space, b, 5) > plain(space, b, 6));
    CHECK(best({{0, 0}, {0.5, 0.5}}, {3, 9}) == 3);         // Σ h = 1
    CHECK(best({{0.5, 0.5}, {0.5, 0.5}}, {3, 9}) == 9);     // Σ l = 1: any λ will do
    CHECK(best({{0.25, 0.25}, {0.25, 0.25}}, {3, 9}) == 3); // infeasible: still a λ
}

TEST_CASE("no λ gives less than the best λ, and the proven bound is not below the plain one")
{
    rc::prop("random dyadic spaces", [](std::vector<std::uint16_t> raw) {
        RC_PRE(raw.size() >= 4u);
        const std::size_t n = raw.size() / 3;
        RC_PRE(n >= 1u);
        Space space;
        std::vector<double> b;
        for (std::size_t j = 0; j < n; ++j) {
            const double x = raw[3 * j] % 257 / 256.0, y = raw[3 * j + 1] % 257 / 256.0;
            space.l.push_back(std::min(x, y) / 256);
            space.h.push_back(std::max(x, y));
            b.push_back(raw[3 * j + 2] % 64 - 32);
        }
        const double lambda = best(space, b), value = plain(space, b, lambda);
        for (double other : b)
            RC_ASSERT(plain(space, b, other) >= value); // small integers and 2⁻¹⁶: no rounding here
        RC_ASSERT(dual_bound(space.view(), b, lambda, Rounding::proven) >= value);
    });
}

TEST_CASE("what is not finite gives an infinite bound, never NaN or less")
{
    const double nan = std::numeric_limits<double>::quiet_NaN(), huge = std::numeric_limits<double>::max();
    const Space space{{0, 1}, {1, 1}};
    for (const auto& b : {std::vector<double>{nan, 0}, {0, nan}, {infinite, 0}, {-infinite, 0}, {huge, -huge}})
        for (double lambda : {0.0, huge, -huge, nan, infinite})
            for (Rounding rounding : {Rounding::proven, Rounding::plain}) {
                const double bound = dual_bound(space.view(), b, lambda, rounding);
                CHECK(bound > -infinite);
                if (!std::isfinite(b[0]) || !std::isfinite(b[1]) || !std::isfinite(lambda))
                    CHECK(bound == infinite);
            }
}
