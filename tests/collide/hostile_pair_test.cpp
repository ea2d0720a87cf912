// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <limits>

#include <catch2/catch.hpp>

#include "tests/collide/pair_cases.hpp"
#include "tests/support.hpp"

using namespace cinch;
using namespace cinch::test;

namespace {

void check(const TrianglePoints& a, const TrianglePoints& b, bool expected)
{
    if (const int wrong = wrong_orders(a, b, expected))
        FAIL_CHECK(wrong << " of 72 orders are wrong, " << (expected ? "intersecting: " : "disjoint: ") << text(a, b));
}

} // namespace

TEST_CASE("triangle pairs agree with an exact clipper in every order: touching up to rounding, and flat")
{
    Random random{std::mt19937_64(3)};
    std::array<int, 2> answers{};
    OrientationCounts counts;
    for (int i = 0; i < 20000; ++i) {
        TrianglePoints a{random.point(), random.point(), random.point()};
        if (i % 5 == 0)
            a[2] = a[0] + random.unit() * (a[1] - a[0]); // collinear up to rounding
        if (i % 11 == 0)
            a[2] = a[i % 2 ? 1 : 0]; // exactly
        if (i % 7 == 0)
            for (Vec3& v : a)
                v[i % 3] = 0.3; // its plane is exact
        TrianglePoints b = near_touching(random, a);
        if (i % 14 == 0)
            for (Vec3& v : b)
                v[i % 3] = 0.3;
        const bool expected = exact_intersect(a, b);
        ++answers[expected];
        check(a, b, expected);
        intersect(a, b, &counts);
    }
    CHECK(answers[0] > 2000);
    CHECK(answers[1] > 2000);
    CHECK(counts.in_double > 20000);
    CHECK(counts.in_expansion > 20000);
    CHECK(counts.in_integer == 0);
}

TEST_CASE("a power of two per axis does not change the answer, down to subnormals and up to overflow")
{
    std::mt19937_64 random(4);
    OrientationCounts counts;
    std::vector<Vec3> scales{{1, 0x1p-1074, 0x1p1020}, {0x1p-330, 0x1p330, 1}, {0x1p-1000, 1, 0x1p-1074}};
    for (double scale : {0x1p-1074, 0x1p-1000, 0x1p-340, 0x1p-200, 0x1p200, 0x1p340, 0x1p1000, 0x1p1020})
        scales.push_back(Vec3::Constant(scale));
    for (int i = 0; i < 100000; ++i) {
        // Below 8·2^1020: coordinates are finite, differences are not.
        const SmallTriangle a = collapse(random_triangle(random, 3), 1 + i % 6),
                            b = collapse(random_triangle(random, 3), 1 + i / 6 % 6);
        const bool expected = Clipper<Int128>::intersect(integers(a), integers(b));
        const Vec3& scale = scales[static_cast<std::size_t>(i) % scales.size()];
        if (intersect(doubles(a, scale), doubles(b, scale), &counts) != expected)
            FAIL_CHECK("scale " << scale.transpose() << " " << text(doubles(a), doubles(b)));
    }
    CHECK(counts.in_double > 10000);
    CHECK(counts.in_expansion > 10000);
    CHECK(counts.in_integer > 10000);
}

TEST_CASE("triangle pairs agree with an exact clipper in every order: all magnitudes in one triangle")
{
    Random random{std::mt19937_64(5)};
    using limits = std::numeric_limits<double>;
    std::array<int, 2> answers{};
    const auto cases = static_cast<int>(share_of(1500));
    for (int i = 0; i < cases; ++i) {
        const double anchors[] = {0,  1, 0x1p-1074, 3 * 0x1p-1074, 1e-310, limits::min(), 1e-300, 1e300, limits::max(),
                                  0.1};
        const std::size_t few = 2 + random.below(3), offset = random.below(10);
        std::array<TrianglePoints, 2> t;
        for (TrianglePoints& triangle : t)
            for (Vec3& v : triangle)
                for (double& x : v)
                    x = anchors[(offset + 3 * random.below(few)) % 10] * (random.below(2) ? 1 : -1) *
                        (random.below(3) ? 1 : random.unit());
        const bool expected = exact_intersect(t[0], t[1]);
        ++answers[expected];
        check(t[0], t[1], expected);
    }
    CHECK(answers[0] > cases / 10);
    CHECK(answers[1] > cases / 10);
}
