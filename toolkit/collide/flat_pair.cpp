// SPDX-License-Identifier: Apache-2.0
#include "toolkit/collide/flat_pair.hpp"

#include <algorithm>
#include <utility>

namespace cinch {
namespace {

/// Coordinates in order: along any line this is the order of its points.
template <class Point> bool before(const Point& a, const Point& b) noexcept
{
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
}

Vec2 project(const Vec3& v, Eigen::Index dropped) noexcept { return {v[(dropped + 1) % 3], v[(dropped + 2) % 3]}; }

int projected_orientation(const Vec3& a, const Vec3& b, const Vec3& c, Eigen::Index dropped,
                          OrientationCounts* counts) noexcept
{
    return orientation(project(a, dropped), project(b, dropped), project(c, dropped), counts);
}

/// The corners of a convex hull: three of a proper triangle, or the two ends of a segment in order; a point is its own
/// two ends.
template <class Point> struct Hull {
    std::size_t size;
    std::array<Point, 3> corner;

    const Point& back() const noexcept { return corner[size - 1]; }
    std::size_t edges() const noexcept { return size == 3 ? 3 : 1; }
    const Point& after(std::size_t i) const noexcept { return corner[(i + 1) % size]; }
};

/// Points are collinear if and only if all three of their projections are.
Hull<Vec3> hull(const TrianglePoints& t, OrientationCounts* counts) noexcept
{
    for (Eigen::Index axis = 0; axis < 3; ++axis)
        if (projected_orientation(t[0], t[1], t[2], axis, counts) != 0)
            return {3, t};
    const auto [first, last] = std::minmax_element(t.begin(), t.end(), before<Vec3>);
    return {2, {*first, *last}};
}

using Hull2 = Hull<Vec2>;
using Table = std::array<std::array<int, 3>, 3>; ///< [edge of the one][corner of the other]: its orientation

Table orientations(const Hull2& edges, const Hull2& points, OrientationCounts* counts) noexcept
{
    Table table{};
    for (std::size_t e = 0; e < edges.edges(); ++e)
        for (std::size_t i = 0; i < points.size; ++i)
            table[e][i] = orientation(edges.corner[e], edges.after(e), points.corner[i], counts);
    return table;
}

/// Whether corner i of `points` is in the hull of the edges.
bool contains(const Hull2& edges, const Table& table, const Hull2& points, std::size_t i) noexcept
{
    if (edges.size == 3) {
        const auto [least, most] = std::minmax({table[0][i], table[1][i], table[2][i]});
        return least >= 0 || most <= 0;
    }
    // On the line of the ends and between them.
    return table[0][i] == 0 && !before(points.corner[i], edges.corner[0]) && !before(edges.back(), points.corner[i]);
}

/// A vertex of the common part of two hulls in a plane is a corner of one that the other contains, or a point where the
/// interiors of two edges cross.
bool overlap(const Hull2& a, const Hull2& b, OrientationCounts* counts) noexcept
{
    const Table of_b = orientations(a, b, counts), of_a = orientations(b, a, counts);
    for (std::size_t i = 0; i < b.size; ++i)
        if (contains(a, of_b, b, i))
            return true;
    for (std::size_t i = 0; i < a.size; ++i)
        if (contains(b, of_a, a, i))
            return true;
    for (std::size_t e = 0; e < a.edges(); ++e)
        for (std::size_t f = 0; f < b.edges(); ++f)
            if (of_b[e][f] * of_b[e][(f + 1) % b.size] < 0 && of_a[f][e] * of_a[f][(e + 1) % a.size] < 0)
                return true;
    return false;
}

Hull2 project(const Hull<Vec3>& h, Eigen::Index dropped) noexcept
{
    Hull2 flat{h.size, {}};
    for (std::size_t i = 0; i < h.size; ++i)
        flat.corner[i] = project(h.corner[i], dropped);
    if (flat.size == 2 && before(flat.corner[1], flat.corner[0]))
        std::swap(flat.corner[0], flat.corner[1]);
    return flat;
}

/// Hulls in one plane. A projection that keeps three of its points from being collinear is one to one on the plane.
bool intersect_coplanar(const Hull<Vec3>& a, const Hull<Vec3>& b, OrientationCounts* counts) noexcept
{
    std::array<Vec3, 6> point;
    const auto end = std::copy_n(b.corner.begin(), b.size, std::copy_n(a.corner.begin(), a.size, point.begin()));
    for (auto p = point.begin(); p != end; ++p)
        for (auto q = p + 1; q != end; ++q)
            for (auto r = q + 1; r != end; ++r)
                for (Eigen::Index axis = 0; axis < 3; ++axis)
                    if (projected_orientation(*p, *q, *r, axis, counts) != 0)
                        return overlap(project(a, axis), project(b, axis), counts);
    return !before(a.back(), b.corner[0]) && !before(b.back(), a.corner[0]); // intervals of one line
}

/// A segment whose line is not in the plane of the triangle.
bool intersect_across(const Hull<Vec3>& segment, const Hull<Vec3>& triangle, OrientationCounts* counts) noexcept
{
    std::array<int, 3> side;
    for (std::size_t i = 0; i < 3; ++i)
        side[i] = orientation(segment.corner[0], segment.corner[1], triangle.corner[i], triangle.after(i), counts);
    const auto [least, most] = std::minmax({side[0], side[1], side[2]});
    return least >= 0 || most <= 0;
}

} // namespace

bool intersect_flat(const TrianglePoints& a, const TrianglePoints& b, OrientationCounts* counts) noexcept
{
    const Hull<Vec3> of_a = hull(a, counts), of_b = hull(b, counts);
    const Hull<Vec3>&large = of_a.size >= of_b.size ? of_a : of_b, &small = of_a.size >= of_b.size ? of_b : of_a;
    if (small.size == 3)
        return intersect_coplanar(large, small, counts);
    const auto& [p, q, r] = large.corner;
    if (large.size == 3) {
        const int first = orientation(p, q, r, small.corner[0], counts),
                  last = orientation(p, q, r, small.back(), counts);
        if (first != last)
            return intersect_across(small, large, counts);
    } else if (orientation(p, q, small.corner[0], small.corner[1], counts) != 0) {
        return false;
    }
    return intersect_coplanar(large, small, counts);
}

} // namespace cinch
