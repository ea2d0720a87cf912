// SPDX-License-Identifier: Apache-2.0
#include "toolkit/collide/orientation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "toolkit/bounds/rounding.hpp"
#include "toolkit/collide/big_integer.hpp"
#include "toolkit/collide/expansion.hpp"

namespace cinch {
namespace {

template <class T> auto determinant(const std::array<T, 2>& p, const std::array<T, 2>& q) noexcept
{
    return p[0] * q[1] - p[1] * q[0];
}

template <class T>
auto determinant(const std::array<T, 3>& p, const std::array<T, 3>& q, const std::array<T, 3>& r) noexcept
{
    return (p[0] * (q[1] * r[2] - q[2] * r[1]) - q[0] * (p[1] * r[2] - p[2] * r[1])) +
           r[0] * (p[1] * q[2] - p[2] * q[1]);
}

// The filters. A computed difference is p̂ = p/(1 + δ), |δ| ≤ u, without underflow; M is the product of the greatest |p̂|
// of each coordinate, of which at least constant·(1 − u)³M is left as computed.
//   3 × 3: of 6 leaves ≤ M each passes 1 (×) + 1 (−) + 1 (×) + 2 (sum of three) = 5 roundings, and 3 of its
//   differences:
//     |computed − exact| ≤ 6γ₈M < 48u(1 + 10u)M; 49u leaves more than uM/2.
//   2 × 2: of 2 leaves ≤ M each passes 1 (×) + 1 (−) = 2 roundings, and 2 of its differences: 2γ₄M < 8u(1 + 5u)M; 9u
//   leaves as much.
// With every greatest difference m in [2^-320, 2^320]: nothing overflows, M ≤ 2^960. Products underflow by η/2 each: 6
// inner ones times m and 3 outer ones, together < 4ηm + 2η with η = 2^-1074, against uM/2 ≥ 2^-694·m and ≥ 2^-1014.
constexpr double constant_3 = 49 * unit_roundoff, constant_2 = 9 * unit_roundoff;
constexpr double least_difference = 0x1p-320, greatest_difference = 0x1p320;

constexpr int undecided = 2;

/// The sign of a computed determinant, if the filter allows it. The greatest difference of a coordinate is 0 only if
/// all are, exactly, since subtraction underflows gradually.
template <std::size_t N>
int filtered_sign(double computed, const std::array<double, N>& greatest, double constant) noexcept
{
    const auto [least, most] = std::minmax_element(greatest.begin(), greatest.end());
    if (*least == 0)
        return 0;
    if (!(*least >= least_difference && *most <= greatest_difference))
        return undecided;
    double error = constant;
    for (double m : greatest)
        error *= m;
    return computed > error ? 1 : computed < -error ? -1 : undecided;
}

/// In this range a coordinate is a multiple of 2^-352, so every term of a product of three differences is one of
/// 2^-1056, and no sum of six such products reaches 2^1023.
bool in_range_of_expansions(double x) noexcept { return x == 0 || (std::abs(x) >= 0x1p-300 && std::abs(x) <= 0x1p300); }

/// The sign of the determinant of the differences of the points from the first.
template <class Point, std::size_t N>
int exact_sign(const std::array<const Point*, N + 1>& points, OrientationCounts* counts) noexcept
{
    bool finite = true, in_range = true;
    for (const Point* point : points)
        for (double x : *point) {
            finite = finite && std::isfinite(x);
            in_range = in_range && in_range_of_expansions(x);
        }
    if (!finite)
        return 0;

    const auto sign = [&](auto difference) {
        std::array<std::array<decltype(difference(0.0, 0.0, 0)), N>, N> row;
        for (std::size_t i = 0; i < N; ++i)
            for (std::size_t axis = 0; axis < N; ++axis) {
                const auto a = static_cast<Eigen::Index>(axis);
                row[i][axis] = difference((*points[i + 1])[a], (*points[0])[a], axis);
            }
        return std::apply([](const auto&... rows) { return determinant(rows...).sign(); }, row);
    };
    if (in_range) {
        if (counts)
            ++counts->in_expansion;
        return sign([](double x, double y, std::size_t) { return exact_difference(x, y); });
    }
    if (counts)
        ++counts->in_integer;
    // A power of two per axis does not change the sign.
    std::array<int, N> unit;
    for (std::size_t axis = 0; axis < N; ++axis) {
        unit[axis] = 1024;
        for (const Point* point : points)
            if (const double x = (*point)[static_cast<Eigen::Index>(axis)]; x != 0)
                unit[axis] = std::min(unit[axis], unit_exponent(x));
    }
    return sign(
        [&unit](double x, double y, std::size_t axis) { return scaled(x, unit[axis]) - scaled(y, unit[axis]); });
}

} // namespace

int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, OrientationCounts* counts) noexcept
{
    const std::array<double, 3> p{b[0] - a[0], b[1] - a[1], b[2] - a[2]}, q{c[0] - a[0], c[1] - a[1], c[2] - a[2]},
        r{d[0] - a[0], d[1] - a[1], d[2] - a[2]};
    std::array<double, 3> greatest;
    for (std::size_t i = 0; i < 3; ++i)
        greatest[i] = std::max({std::abs(p[i]), std::abs(q[i]), std::abs(r[i])});
    const int sign = filtered_sign(determinant(p, q, r), greatest, constant_3);
    if (sign == undecided)
        return exact_sign<Vec3, 3>({&a, &b, &c, &d}, counts);
    if (counts)
        ++counts->in_double;
    return sign;
}

int orientation(const Vec2& a, const Vec2& b, const Vec2& c, OrientationCounts* counts) noexcept
{
    const std::array<double, 2> p{b[0] - a[0], b[1] - a[1]}, q{c[0] - a[0], c[1] - a[1]};
    const std::array<double, 2> greatest{std::max(std::abs(p[0]), std::abs(q[0])),
                                         std::max(std::abs(p[1]), std::abs(q[1]))};
    const int sign = filtered_sign(determinant(p, q), greatest, constant_2);
    if (sign == undecided)
        return exact_sign<Vec2, 2>({&a, &b, &c}, counts);
    if (counts)
        ++counts->in_double;
    return sign;
}

} // namespace cinch
