// SPDX-License-Identifier: GPL-3.0-or-later
#include <random>

#include <catch2/catch.hpp>

#include "exact/formulas.hpp"
#include "exact/optimum.hpp"

using namespace cinch;
using namespace cinch::exact;

namespace {

// The greatest value over all corners of W', found by trying every choice of one free coordinate and l or h for the
// others.
std::optional<Exact> best_corner(WeightSpace space, const std::vector<Exact>& b)
{
    const std::size_t n = b.size();
    std::optional<Exact> best;
    for (std::size_t free = 0; free < n; ++free)
        for (std::size_t choice = 0; choice < (std::size_t{1} << n); ++choice) {
            Exact sum(0), value(0);
            for (std::size_t j = 0; j < n; ++j) {
                if (j == free)
                    continue;
                const Exact w(choice >> j & 1 ? space.h[j] : space.l[j]);
                sum = sum + w;
                value = value + w * b[j];
            }
            const Exact last = Exact(1) - sum;
            if (last < Exact(space.l[free]) || last > Exact(space.h[free]))
                continue;
            value = value + last * b[free];
            if (!best || *best < value)
                best = value;
        }
    return best;
}

} // namespace

TEST_CASE("the optimum equals the best of all corners, and is empty where there are none")
{
    std::mt19937_64 random(7);
    auto uniform = [&] { return std::uniform_real_distribution<double>(0, 1)(random); };
    std::size_t feasible = 0, infeasible = 0;
    for (int trial = 0; trial < 3000; ++trial) {
        const std::size_t n = 1 + random() % 6;
        std::vector<double> l, h;
        std::vector<Exact> b;
        const bool coarse = random() % 2; // many coincident sums
        for (std::size_t j = 0; j < n; ++j) {
            double x = uniform() / static_cast<double>(n) * 2, y = uniform();
            if (coarse) {
                x = static_cast<double>(random() % 3) / 8;
                y = static_cast<double>(random() % 8) / 8;
            }
            l.push_back(std::min(x, y));
            h.push_back(std::max(x, y));
            b.push_back(Exact(coarse ? static_cast<double>(random() % 4) : 100 * uniform() - 50));
        }
        const auto found = optimum({l, h}, b);
        const auto wanted = best_corner({l, h}, b);
        REQUIRE(found.has_value() == wanted.has_value());
        (found ? feasible : infeasible) += 1;
        if (found)
            REQUIRE(found->value == *wanted);
    }
    CHECK(feasible > 500);
    CHECK(infeasible > 500);
}

TEST_CASE("spaces one unit from infeasible are told apart")
{
    const double below = 1 - 0x1p-53;
    const std::vector<Exact> one{Exact(3)}, two{Exact(3), Exact(4)};
    CHECK_FALSE(optimum({std::vector<double>{0}, std::vector<double>{below}}, one));
    CHECK(optimum({std::vector<double>{0}, std::vector<double>{1}}, one)->value == Exact(3));
    CHECK_FALSE(optimum({std::vector<double>{0.5, 0.5 + 0x1p-53}, std::vector<double>{1, 1}}, two));
    CHECK_FALSE(optimum({std::vector<double>{0.5, 0.25}, std::vector<double>{0.25, 1}}, two));
    CHECK_FALSE(optimum({std::span<const double>{}, std::span<const double>{}}, {}));
}

TEST_CASE("fractions are in lowest terms")
{
    CHECK(as_fraction(Exact(0.75)) == "3/4");
    CHECK(as_fraction(Exact(-2.5)) == "-5/2");
    CHECK(as_fraction(Exact(12)) == "12/1");
    CHECK(as_fraction(Exact(0)) == "0/1");
    CHECK(as_fraction(Exact(0x1p-60) * Exact(0x1p60)) == "1/1");
}
