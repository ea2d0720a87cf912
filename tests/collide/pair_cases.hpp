// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <sstream>

#include "tests/collide/clipper.hpp"
#include "tests/support.hpp"

namespace cinch::test {

using SmallTriangle = std::array<std::array<int, 3>, 3>;

inline IntegerTriangle<Int128> integers(const SmallTriangle& t)
{
    IntegerTriangle<Int128> result;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t axis = 0; axis < 3; ++axis)
            result[i][axis] = t[i][axis];
    return result;
}

/// The triangle with every axis scaled.
inline TrianglePoints doubles(const SmallTriangle& t, const Vec3& scale = Vec3::Ones())
{
    TrianglePoints result;
    for (std::size_t i = 0; i < 3; ++i)
        result[i] = Vec3(t[i][0], t[i][1], t[i][2]).cwiseProduct(scale);
    return result;
}

/// Coordinates of at most 10 keep the clipper below 2^104.
inline SmallTriangle random_triangle(std::mt19937_64& random, int greatest)
{
    SmallTriangle t;
    for (auto& v : t)
        for (int& x : v)
            x = static_cast<int>(random() % static_cast<unsigned>(2 * greatest + 1)) - greatest;
    return t;
}

/// Collapses a triangle: 1 to a point, 2 to a segment with a doubled end, 3 to one whose third point is in the middle,
/// 4 into the plane x = y + z, 5 into the plane z = 1, 6 is the triangle itself.
inline SmallTriangle collapse(SmallTriangle t, int how)
{
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (how == 1)
            t[1][axis] = t[2][axis] = t[0][axis];
        if (how == 2)
            t[2][axis] = t[1][axis];
        if (how == 3) {
            t[2][axis] = t[0][axis] + t[1][axis];
            t[0][axis] *= 2;
            t[1][axis] *= 2;
        }
    }
    for (auto& v : t) {
        if (how == 4)
            v[0] = v[1] + v[2];
        if (how == 5)
            v[2] = 1;
    }
    return t;
}

/// From one power of two to the next that is looked at: each at a share of 1 and more, every 16th at small ones.
inline int power_stride() { return static_cast<int>(std::ceil(std::clamp(1 / test_share(), 1.0, 16.0))); }
/// How often, from a share of 1 on.
inline int repeats() { return std::max(1, static_cast<int>(test_share())); }

inline constexpr std::array<std::array<std::size_t, 3>, 6> orders{
    {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};

/// How many of the 72 orders of vertices and triangles give another answer than the expected one.
inline int wrong_orders(const TrianglePoints& a, const TrianglePoints& b, bool expected)
{
    int wrong = 0;
    for (const auto& i : orders)
        for (const auto& j : orders) {
            const TrianglePoints p{a[i[0]], a[i[1]], a[i[2]]}, q{b[j[0]], b[j[1]], b[j[2]]};
            wrong += intersect(p, q) != expected;
            wrong += intersect(q, p) != expected;
        }
    return wrong;
}

struct Random {
    std::mt19937_64 bits;
    double unit() { return std::ldexp(static_cast<double>(bits() >> 11), -53); }
    double symmetric() { return 2 * unit() - 1; }
    Vec3 point() { return {symmetric(), symmetric(), symmetric()}; }
    std::size_t below(std::size_t n) { return bits() % n; }
    /// A point of the triangle, or of its plane, rounded: at a corner, on an edge or anywhere.
    Vec3 point_of(const TrianglePoints& t)
    {
        const std::size_t i = below(3);
        const double s = unit();
        switch (below(4)) {
        case 0:
            return t[i];
        case 1:
            return t[i] + s * (t[(i + 1) % 3] - t[i]);
        case 2:
            return t[0] + s * (t[1] - t[0]) + (1 - s) * unit() * (t[2] - t[0]);
        default:
            return t[0] + 2 * symmetric() * (t[1] - t[0]) + 2 * symmetric() * (t[2] - t[0]);
        }
    }
    /// Moved by a few units in the last place, or not.
    Vec3 nudged(Vec3 v)
    {
        for (double& x : v)
            for (std::size_t steps = below(3); steps > 0; --steps)
                x = std::nextafter(x, below(2) ? 2.0 : -2.0);
        return v;
    }
};

/// A triangle that touches `a` up to rounding: with a vertex on it, an edge through a point of it, two or three
/// vertices in its plane.
inline TrianglePoints near_touching(Random& random, const TrianglePoints& a)
{
    const Vec3 x = random.point_of(a), d = random.point();
    switch (random.below(6)) {
    case 0:
        return {random.nudged(x), random.point(), random.point()};
    case 1:
        return {x + random.unit() * d, x - random.unit() * d, random.point()};
    case 2:
        return {random.nudged(x), random.nudged(random.point_of(a)), random.point()};
    case 3:
        return {random.nudged(x), random.nudged(random.point_of(a)), random.nudged(random.point_of(a))};
    case 4:
        return {x, random.nudged(x), random.point_of(a)}; // a sliver
    default:
        return {x, x, random.below(2) ? random.point() : random.point_of(a)}; // a segment
    }
}

inline std::string text(const TrianglePoints& a, const TrianglePoints& b)
{
    std::ostringstream out;
    out << std::hexfloat;
    for (const TrianglePoints* t : {&a, &b})
        for (const Vec3& v : *t)
            out << "(" << v[0] << " " << v[1] << " " << v[2] << ") ";
    return out.str();
}

} // namespace cinch::test
