// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <cstring>
#include <random>

#include "toolkit/surface/length.hpp"

using namespace cinch;

TEST_CASE("a length has the same bits wherever its vector stands, is near, and does not overflow on the way")
{
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> uniform(-1, 1), exponent(-300, 300);
    alignas(64) double place[16];
    for (int i = 0; i < 20000; ++i) {
        const double size = std::pow(10.0, exponent(random));
        const double v[3] = {size * uniform(random), size * uniform(random) * (i % 3 ? 1 : 1e-9),
                             size * uniform(random)};
        double first = 0;
        for (std::size_t at = 0; at < 8; ++at) {
            std::memcpy(place + at, v, sizeof v);
            const double found = length(Eigen::Map<const Vec3>(place + at));
            if (at == 0)
                first = found;
            REQUIRE(found == first);
        }
        const long double exact =
            std::sqrt(static_cast<long double>(v[0]) * v[0] + static_cast<long double>(v[1]) * v[1] +
                      static_cast<long double>(v[2]) * v[2]);
        REQUIRE(std::abs(static_cast<long double>(first) - exact) <= 5 * 0x1p-53L * exact);
    }
}
