// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <limits>
#include <random>

#include "cinch/bounds.hpp"
#include "exact/absolute.hpp"
#include "exact/number.hpp"

using namespace cinch;
using exact::Exact;

TEST_CASE("absolute supports are at most the relative ones about their origin, exactly, and near them")
{
    std::mt19937_64 random(11);
    std::uniform_real_distribution<double> uniform(-1, 1);
    std::size_t below = 0;
    for (const int k : kdops)
        for (const double far : {0.0, 1e-9, 1.0, 1e7, 1e15})
            for (int i = 0; i < 200; ++i) {
                const Vec3 origin(far * uniform(random), far * uniform(random), far * uniform(random));
                std::vector<float> relative(static_cast<std::size_t>(k));
                for (float& s : relative)
                    s = static_cast<float>(uniform(random));
                std::vector<double> supports(relative.size());
                exact::absolute_supports(k, relative, origin, supports);
                for (std::size_t d = 0; d < supports.size(); ++d) {
                    Exact sum(static_cast<double>(relative[d]));
                    for (int r = 0; r < 3; ++r) {
                        const Exact along = Exact(static_cast<double>(axes_of(k)[d / 2][static_cast<std::size_t>(r)])) *
                                            Exact(origin[r]);
                        sum = d % 2 ? sum - along : sum + along;
                    }
                    REQUIRE(Exact(supports[d]) <= sum);
                    // three sums, each off by 2^-52 of at most twice the greatest
                    const double unit = std::max(std::abs(static_cast<double>(relative[d])), 3 * far) * 0x1p-49;
                    REQUIRE(sum <= Exact(supports[d]) + Exact(unit));
                    below += Exact(supports[d]) < sum;
                }
            }
    CHECK(below > 1000); // rounding was needed
}

TEST_CASE("of what is not finite, only plus infinity bounds anything")
{
    constexpr float infinity = std::numeric_limits<float>::infinity();
    const float relative[] = {infinity, -infinity, std::numeric_limits<float>::quiet_NaN(), 1, 2, 3};
    double supports[6];
    exact::absolute_supports(6, relative, {1, 2, 3}, supports);
    CHECK(supports[0] == std::numeric_limits<double>::infinity());
    CHECK(supports[1] == -std::numeric_limits<double>::infinity());
    CHECK(supports[2] == -std::numeric_limits<double>::infinity());
    CHECK(supports[3] == -1);
    CHECK(supports[4] == 5);
    CHECK(supports[5] == 0);
    CHECK_THROWS_AS(exact::absolute_supports(14, relative, {0, 0, 0}, supports), std::invalid_argument);
}
