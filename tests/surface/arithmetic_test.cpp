// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include "cinch/environment.hpp"

namespace {

struct Two {
    double x, y;
};

// What conversion to float loses, side by side, as compilers like to vectorise it.
__attribute__((noinline)) Two lost(Two p, float* out)
{
    out[0] = static_cast<float>(p.x);
    out[1] = static_cast<float>(p.y);
    return {p.x - static_cast<double>(out[0]), p.y - static_cast<double>(out[1])};
}

} // namespace

TEST_CASE("conversions to float and back are made, not optimised away")
{
    float out[2];
    const Two p = lost({0.1, 0.2}, out);
    CHECK(p.x == 0x1.999999999999ap-4 - 0x1.99999ap-4);
    CHECK(p.y == 2 * (0x1.999999999999ap-4 - 0x1.99999ap-4));
    cinch::require_default_arithmetic();
}
