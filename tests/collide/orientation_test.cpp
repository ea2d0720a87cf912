// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <sstream>

#include <catch2/catch.hpp>

#include "tests/collide/clipper.hpp"

using namespace cinch;
using namespace cinch::test;

namespace {

template <class Point> using Points = std::array<Point, Point::RowsAtCompileTime + 1>;

BigInt determinant(const std::array<std::array<BigInt, 3>, 3>& m)
{
    // By permutations, unlike the code under test.
    return m[0][0] * m[1][1] * m[2][2] + m[0][1] * m[1][2] * m[2][0] + m[0][2] * m[1][0] * m[2][1] - //
           m[0][2] * m[1][1] * m[2][0] - m[0][1] * m[1][0] * m[2][2] - m[0][0] * m[1][2] * m[2][1];
}

template <class Point> int exact(const Points<Point>& p)
{
    const int unit = common_unit(p);
    std::array<std::array<BigInt, 3>, 3> m{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    for (std::size_t i = 1; i < p.size(); ++i)
        for (std::size_t axis = 0; axis + 1 < p.size(); ++axis) {
            const auto a = static_cast<Eigen::Index>(axis);
            m[i - 1][axis] = scaled_integer(p[i][a], unit) - scaled_integer(p[0][a], unit);
        }
    return determinant(m).sign();
}

int computed(const Points<Vec3>& p, OrientationCounts* counts) { return orientation(p[0], p[1], p[2], p[3], counts); }
int computed(const Points<Vec2>& p, OrientationCounts* counts) { return orientation(p[0], p[1], p[2], counts); }

template <class Point> void check(const Points<Point>& p, OrientationCounts& counts)
{
    const int sign = exact<Point>(p), ours = computed(p, &counts);
    Points<Point> swapped = p;
    std::swap(swapped[0], swapped[1]);
    if (ours != sign || computed(swapped, nullptr) != -sign) {
        std::ostringstream out;
        out << std::hexfloat;
        for (const Point& v : p)
            out << "(" << v.transpose() << ") ";
        FAIL_CHECK(ours << " instead of " << sign << ": " << out.str());
    }
}

std::uint64_t total(const OrientationCounts& c) { return c.in_double + c.in_expansion + c.in_integer; }

/// Random, and in every third case a last point that is an affine combination of the others up to rounding and a few
/// units.
template <class Point> Points<Point> points(std::mt19937_64& random, double scale)
{
    std::uniform_real_distribution<double> uniform(-1, 1);
    Points<Point> p;
    for (Point& v : p)
        for (double& x : v)
            x = uniform(random) * scale;
    if (random() % 3 == 0) {
        Point last = p[0];
        for (std::size_t i = 1; i + 1 < p.size(); ++i)
            last += uniform(random) * (p[i] - p[0]);
        for (double& x : last)
            for (auto steps = random() % 3; steps > 0; --steps)
                x = std::nextafter(x, random() % 2 ? scale : -scale);
        if (last.allFinite())
            p.back() = last;
    }
    return p;
}

template <class Point> void check_stages()
{
    std::mt19937_64 random(6);
    OrientationCounts usual, small, large;
    for (int i = 0; i < 60000; ++i)
        check<Point>(points<Point>(random, 1), usual);
    CHECK(usual.in_double > 40000);
    CHECK(usual.in_expansion > 3000);
    CHECK(usual.in_integer == 0);
    CHECK(total(usual) == 60000);

    for (int i = 0; i < 5000; ++i)
        check<Point>(points<Point>(random, 0x1p-1040), small);
    CHECK(small.in_integer == total(small));
    CHECK(total(small) == 5000);
    for (int i = 0; i < 5000; ++i)
        check<Point>(points<Point>(random, 0x1.8p1023), large);
    CHECK(large.in_integer == total(large));
    CHECK(total(large) == 5000);
    // Products of all differences about the least subnormal: a computed determinant is all rounding.
    OrientationCounts underflowing;
    for (int exponent = -1080; exponent < -1060; ++exponent)
        for (int i = 0; i < 1000; ++i)
            check<Point>(points<Point>(random, std::exp2(exponent / Point::RowsAtCompileTime)), underflowing);
    CHECK(underflowing.in_integer == 20000);
    // The ends of the range of the expansions: coordinates of magnitude [scale, 2·scale], the last point nearly
    // coplanar.
    for (double scale : {0x1p-300, 0x1p299}) {
        OrientationCounts counts;
        for (int i = 0; i < 5000; ++i) {
            Points<Point> p = points<Point>(random, 1);
            for (Point& v : p)
                for (double& x : v)
                    x = scale * (1 + std::abs(x) / (std::abs(x) > 1 ? 16 : 1));
            Point sum = Point::Zero();
            for (std::size_t j = 0; j + 1 < p.size(); ++j)
                sum += p[j];
            if (i % 2 == 0)
                p.back() = sum / static_cast<double>(p.size() - 1);
            check<Point>(p, counts);
        }
        CHECK(counts.in_double > 2000);
        CHECK(counts.in_expansion > 1500);
        CHECK(counts.in_integer == 0);
    }
}

} // namespace

TEST_CASE("orientation is exact in every stage")
{
    SECTION("in space") { check_stages<Vec3>(); }
    SECTION("in the plane") { check_stages<Vec2>(); }
}

TEST_CASE("orientation is exact where the filter is closest to failing: small determinants of large differences")
{
    // Lattices of neighbouring doubles around nearly coplanar points [Kettner et al. 2008].
    OrientationCounts counts;
    for (int i = 0; i < 64; ++i)
        for (int j = 0; j < 64; ++j) {
            const double x = 0.5 + i * 0x1p-53, y = 0.5 + j * 0x1p-53;
            check<Vec2>({Vec2(x, y), Vec2(12, 12), Vec2(24, 24)}, counts);
            check<Vec3>({Vec3(x, y, 0.5), Vec3(12, 12, 12), Vec3(24, 24, 24), Vec3(17, 17, 18 + (i % 8) * 0x1p-48)},
                        counts);
            check<Vec3>({Vec3(x, y, 0.1), Vec3(12, 12, 0.7), Vec3(24, 24, -5.3), Vec3(7, 7, 3.3)}, counts);
        }
    CHECK(counts.in_expansion > 1000);
}

TEST_CASE("orientation of any finite doubles: random bits, and extreme ones")
{
    std::mt19937_64 random(7);
    const auto any = [&random] {
        double x;
        do {
            const std::uint64_t bits = random();
            std::memcpy(&x, &bits, sizeof x);
        } while (!std::isfinite(x));
        return x;
    };
    OrientationCounts counts;
    for (int i = 0; i < 3000; ++i) {
        Points<Vec3> p;
        Points<Vec2> q;
        for (Vec3& v : p)
            v = Vec3(any(), any(), any());
        for (Vec2& v : q)
            v = Vec2(any(), any());
        check<Vec3>(p, counts);
        check<Vec2>(q, counts);
    }
    CHECK(counts.in_integer > 5000);

    using limits = std::numeric_limits<double>;
    const double extremes[] = {0,  0x1p-1074,     -0x1p-1074,     limits::min(), -limits::min(), 1,
                               -1, limits::max(), -limits::max(), 0x1p300,       0x1p-300};
    for (int i = 0; i < 20000; ++i) {
        Points<Vec3> p;
        for (Vec3& v : p)
            for (double& x : v)
                x = extremes[random() % std::size(extremes)];
        check<Vec3>(p, counts);
    }
    // The same for the expansions: factors from one end of their range to the other.
    const double reached[] = {0,        1,         -0x1.fffffffffffffp-1, 0x1p300, -0x1p300, 0x1.fffffffffffffp299,
                              0x1p-300, -0x1p-300, 0x1.fffffffffffffp-300};
    OrientationCounts in_range;
    for (int i = 0; i < 20000; ++i) {
        Points<Vec3> p;
        for (Vec3& v : p)
            for (double& x : v)
                x = reached[random() % std::size(reached)];
        check<Vec3>(p, in_range);
    }
    CHECK(in_range.in_expansion > 2000);
    CHECK(in_range.in_integer == 0);
    // The largest determinant there is: every difference is 2·max.
    const double m = limits::max();
    check<Vec3>({Vec3(-m, -m, -m), Vec3(m, m, -m), Vec3(-m, m, m), Vec3(m, -m, m)}, counts);
    check<Vec3>({Vec3(-m, -m, -m), Vec3(m, m, -m), Vec3(-m, m, m), Vec3(m, -m, 0x1p-1074)}, counts);
    // Full length and full cancellation: coplanar but for the last bit of one coordinate.
    check<Vec3>({Vec3(-m, -m, -m), Vec3(m, m, m), Vec3(m, m, 0x1p-1074), Vec3(m, m, -0x1p-1074)}, counts);
    check<Vec3>({Vec3(-m, -m, 0), Vec3(m, m, 0), Vec3(-m, m, 0x1p-1074), Vec3(m, -m, 0x1p-1074)}, counts);
    check<Vec3>({Vec3(-m, -m, 0), Vec3(m, m, 0), Vec3(-m, m, 0x1p-1074), Vec3(m, -m, -0x1p-1074)}, counts);
}

TEST_CASE(
    "orientation has the signs of right-handed axes, counts what is decided at once, and is 0 for what is not finite")
{
    const Vec3 o = Vec3::Zero(), x = Vec3::UnitX(), y = Vec3::UnitY(), z = Vec3::UnitZ();
    OrientationCounts counts;
    CHECK(orientation(o, x, y, z, &counts) == 1);
    CHECK(orientation(o, y, x, z, &counts) == -1);
    CHECK(orientation(o, x, y, x - y, &counts) == 0); // in a coordinate plane: no more than a comparison
    CHECK(orientation(Vec2(0, 0), Vec2(1, 0), Vec2(0, 1), &counts) == 1);
    CHECK(orientation(Vec2(0, 0), Vec2(1, 0), Vec2(2, 0), &counts) == 0);
    CHECK(counts.in_double == 5);
    CHECK(total(counts) == 5);
    using limits = std::numeric_limits<double>;
    for (double unknown : {limits::quiet_NaN(), limits::infinity(), -limits::infinity()})
        for (Eigen::Index axis = 0; axis < 3; ++axis)
            for (int place = 0; place < 4; ++place) {
                Points<Vec3> p{o, x, y, z};
                p[static_cast<std::size_t>(place)][axis] = unknown;
                CHECK(computed(p, nullptr) == 0);
            }
}
