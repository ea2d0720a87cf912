// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Whether two triangles meet, decided without orientations of input points: triangle a, as a polygon in homogeneous
// integers, is clipped against the half-spaces whose intersection is triangle b. Exact as long as Integer does not
// overflow.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <boost/multiprecision/cpp_int.hpp>

#include "toolkit/collide/triangle_pair.hpp"

namespace cinch::test {

__extension__ typedef __int128 Int128;
using BigInt = boost::multiprecision::cpp_int;

inline std::uint64_t low_zeros(unsigned __int128 x)
{
    const auto low = static_cast<std::uint64_t>(x);
    return static_cast<std::uint64_t>(low != 0 ? __builtin_ctzll(low)
                                               : 64 + __builtin_ctzll(static_cast<std::uint64_t>(x >> 64)));
}

inline Int128 greatest_common_divisor(Int128 a, Int128 b)
{
    auto x = static_cast<unsigned __int128>(a < 0 ? -a : a), y = static_cast<unsigned __int128>(b < 0 ? -b : b);
    if (x == 0 || y == 0)
        return static_cast<Int128>(x | y);
    const std::uint64_t common = low_zeros(x | y);
    x >>= low_zeros(x);
    while (y != 0) {
        y >>= low_zeros(y);
        if (x > y)
            std::swap(x, y);
        y -= x;
    }
    return static_cast<Int128>(x << common);
}
inline BigInt greatest_common_divisor(const BigInt& a, const BigInt& b) { return gcd(a, b); }

template <class Integer> using Vector = std::array<Integer, 3>;
template <class Integer> using IntegerTriangle = std::array<Vector<Integer>, 3>;

template <class Integer> class Clipper {
public:
    static bool intersect(const IntegerTriangle<Integer>& a, const IntegerTriangle<Integer>& b)
    {
        std::vector<Point> polygon;
        for (const V& v : a)
            polygon.push_back({v, 1});
        for (const HalfSpace& side : half_spaces(b)) {
            polygon = clip(polygon, side);
            if (polygon.empty())
                return false;
        }
        return true;
    }

private:
    using V = Vector<Integer>;
    struct Point {
        V x;
        Integer w; // > 0: the point x/w
    };
    struct HalfSpace {
        V normal;
        Integer offset;
        Integer value(const Point& p) const
        {
            return dot(normal, p.x) + offset * p.w;
        } // of the sign of the distance; inside is ≥ 0
    };

    static V minus(const V& a, const V& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
    static Integer dot(const V& a, const V& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
    static V cross(const V& a, const V& b)
    {
        return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    }
    static bool is_zero(const V& a) { return a[0] == 0 && a[1] == 0 && a[2] == 0; }

    static void add(std::vector<HalfSpace>& sides, const V& normal, const V& through)
    {
        sides.push_back({normal, -dot(normal, through)});
    }
    static void add_plane(std::vector<HalfSpace>& sides, const V& normal, const V& through)
    {
        add(sides, normal, through);
        add(sides, minus(V{0, 0, 0}, normal), through);
    }

    static std::vector<HalfSpace> half_spaces(const IntegerTriangle<Integer>& t)
    {
        std::vector<HalfSpace> sides;
        const V normal = cross(minus(t[1], t[0]), minus(t[2], t[0]));
        if (!is_zero(normal)) {
            add_plane(sides, normal, t[0]);
            for (std::size_t i = 0; i < 3; ++i)
                add(sides, cross(normal, minus(t[(i + 1) % 3], t[i])), t[i]);
            return sides;
        }
        std::size_t longest = 0; // edge
        for (std::size_t i = 1; i < 3; ++i)
            if (squared_length(t, i) > squared_length(t, longest))
                longest = i;
        const V &first = t[longest], &last = t[(longest + 1) % 3], along = minus(last, first);
        for (const V& axis : {V{1, 0, 0}, V{0, 1, 0}, V{0, 0, 1}})
            add_plane(sides, is_zero(along) ? axis : cross(along, axis), first);
        add(sides, along, first);
        add(sides, minus(first, last), last);
        return sides;
    }
    static Integer squared_length(const IntegerTriangle<Integer>& t, std::size_t edge)
    {
        const V d = minus(t[(edge + 1) % 3], t[edge]);
        return dot(d, d);
    }

    /// Sutherland–Hodgman. The hull of the result is the part of the hull of `polygon` in the half-space, also if it is
    /// degenerate.
    static std::vector<Point> clip(const std::vector<Point>& polygon, const HalfSpace& side)
    {
        std::vector<Point> inside;
        std::vector<Integer> value;
        for (const Point& p : polygon)
            value.push_back(side.value(p));
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            const std::size_t j = (i + 1) % polygon.size();
            if (value[i] >= 0)
                inside.push_back(polygon[i]);
            if (value[i] < 0 && value[j] > 0)
                inside.push_back(between(polygon[i], polygon[j], -value[i], value[j]));
            if (value[i] > 0 && value[j] < 0)
                inside.push_back(between(polygon[i], polygon[j], value[i], -value[j]));
        }
        return inside;
    }
    /// Where the value is 0, given its magnitudes at p and q.
    static Point between(const Point& p, const Point& q, Integer from_p, Integer from_q)
    {
        const Integer shared = greatest_common_divisor(from_p, from_q);
        from_p /= shared;
        from_q /= shared;
        Point r{{0, 0, 0}, p.w * from_q + q.w * from_p};
        Integer divisor = r.w;
        for (std::size_t i = 0; i < 3; ++i) {
            r.x[i] = p.x[i] * from_q + q.x[i] * from_p;
            if (divisor != 1)
                divisor = greatest_common_divisor(divisor, r.x[i]);
        }
        if (divisor != 1) {
            for (Integer& x : r.x)
                x /= divisor;
            r.w /= divisor;
        }
        return r;
    }
};

/// x·2^-unit exactly, for a double that is a multiple of 2^unit.
inline BigInt scaled_integer(double x, int unit)
{
    int exponent;
    const auto mantissa = static_cast<std::int64_t>(std::ldexp(std::frexp(x, &exponent), 53));
    BigInt result = mantissa;
    const int shift = exponent - 53 - unit;
    return shift >= 0 ? result << shift : BigInt(result / (BigInt(1) << -shift));
}

/// 2 to the power of this divides every one of the finite doubles.
template <class Points> int common_unit(const Points& points)
{
    int unit = 1024;
    for (const auto& p : points)
        for (double x : p)
            if (x != 0)
                unit = std::min(unit, std::max(std::ilogb(x) - 52, -1074));
    return unit;
}

/// The truth for triangles of finite doubles.
inline bool exact_intersect(const TrianglePoints& a, const TrianglePoints& b)
{
    std::vector<Vec3> points(a.begin(), a.end());
    points.insert(points.end(), b.begin(), b.end());
    const int unit = common_unit(points);
    std::array<IntegerTriangle<BigInt>, 2> t;
    for (std::size_t i = 0; i < 6; ++i)
        for (std::size_t axis = 0; axis < 3; ++axis)
            t[i / 3][i % 3][axis] = scaled_integer(points[i][static_cast<Eigen::Index>(axis)], unit);
    return Clipper<BigInt>::intersect(t[0], t[1]);
}

} // namespace cinch::test
