// SPDX-License-Identifier: GPL-3.0-or-later
#include <cfenv>
#include <cstring>
#include <limits>
#include <random>

#include <catch2/catch.hpp>

#include "cinch/environment.hpp"
#include "toolkit/bounds/rounding.hpp"

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

using namespace cinch;

TEST_CASE("succ is at least the next double, at most two steps up")
{
    std::mt19937_64 random(1);
    auto check = [](double x) {
        const double next = std::nextafter(x, infinite), s = succ(x);
        REQUIRE(s >= next);
        REQUIRE(s <= std::nextafter(next, infinite));
    };
    for (double x : {0.0, -0.0, 1.0, -1.0, 0x1p-1022, -0x1p-1022, 0x1p-1074, -0x1p-1074, 0x1p-1021,
                     0x1.fffffffffffffp-1, 0x1p1000, -0x1p1000})
        check(x);
    for (int i = 0; i < 1000000; ++i) {
        const std::uint64_t bits = random();
        double x;
        std::memcpy(&x, &bits, sizeof x);
        if (std::isfinite(x) && std::abs(x) < 0x1p1022)
            check(x);
    }
    CHECK(succ(std::numeric_limits<double>::max()) == infinite);
}

TEST_CASE("a changed floating-point environment is refused")
{
    CHECK_NOTHROW(require_default_arithmetic());
    for (int mode : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
        std::fesetround(mode);
        bool refused = false;
        try {
            require_default_arithmetic();
        } catch (const std::runtime_error&) {
            refused = true;
        }
        std::fesetround(FE_TONEAREST);
        CHECK(refused);
    }
#if defined(__SSE2__)
    const unsigned int saved = _mm_getcsr();
    for (unsigned int bit : {0x8000u, 0x0040u}) { // flush to zero, denormals are zero
        _mm_setcsr(saved | bit);
        bool refused = false;
        try {
            require_default_arithmetic();
        } catch (const std::runtime_error&) {
            refused = true;
        }
        _mm_setcsr(saved);
        CHECK(refused);
    }
#endif
}
