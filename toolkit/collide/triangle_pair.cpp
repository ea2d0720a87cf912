// SPDX-License-Identifier: Apache-2.0
#include "toolkit/collide/triangle_pair.hpp"

#include <algorithm>
#include <utility>

#include "toolkit/collide/flat_pair.hpp"

namespace cinch {
namespace {

using Signs = std::array<int, 3>;

/// On which side of the plane of `triangle` each of the points is; all 0 if the triangle is degenerate.
Signs sides(const TrianglePoints& triangle, const TrianglePoints& points, OrientationCounts* counts) noexcept
{
    Signs s;
    for (std::size_t i = 0; i < 3; ++i)
        s[i] = orientation(triangle[0], triangle[1], triangle[2], points[i], counts);
    return s;
}

bool strictly_on_one_side(const Signs& s) noexcept { return s[0] != 0 && s[0] == s[1] && s[1] == s[2]; }

struct Apex {
    std::size_t vertex;
    int side;
};

/// The vertex that the other triangle's plane separates from the other two, and the side it is on; points of the plane
/// count for either side. The signs are neither all 0 nor all strictly the same.
Apex apex(const Signs& s) noexcept
{
    for (std::size_t i = 0; i < 3; ++i) {
        const int next = s[(i + 1) % 3], last = s[(i + 2) % 3];
        if (s[i] > 0 && next <= 0 && last <= 0)
            return {i, 1};
        if (s[i] < 0 && next >= 0 && last >= 0)
            return {i, -1};
    }
    // What is left is one 0 and two on the same strict side.
    const auto zero = static_cast<std::size_t>(std::find(s.begin(), s.end(), 0) - s.begin());
    return {zero, -s[(zero + 1) % 3]};
}

} // namespace

// [Guigue, Devillers 2003]: both triangles meet the line common to their planes in an interval whose ends lie on the
// two edges at the apex. With each apex on the positive side of the other's plane, the ends are in order along the
// line, and two orientations compare the ends of one interval with those of the other without constructing them.
bool intersect(const TrianglePoints& a, const TrianglePoints& b, OrientationCounts* counts) noexcept
{
    for (const TrianglePoints* triangle : {&a, &b})
        for (const Vec3& v : *triangle)
            if (!v.allFinite())
                return true;
    const Signs side_of_b = sides(a, b, counts);
    if (strictly_on_one_side(side_of_b))
        return false;
    const Signs side_of_a = sides(b, a, counts);
    if (strictly_on_one_side(side_of_a))
        return false;
    if (side_of_a == Signs{} || side_of_b == Signs{})
        return intersect_flat(a, b, counts); // a degenerate triangle, or coplanar ones

    const Apex of_a = apex(side_of_a), of_b = apex(side_of_b);
    const Vec3 *a0 = &a[of_a.vertex], *a1 = &a[(of_a.vertex + 1) % 3], *a2 = &a[(of_a.vertex + 2) % 3];
    const Vec3 *b0 = &b[of_b.vertex], *b1 = &b[(of_b.vertex + 1) % 3], *b2 = &b[(of_b.vertex + 2) % 3];
    if (of_b.side < 0) // turn a's plane round
        std::swap(a1, a2);
    if (of_a.side < 0)
        std::swap(b1, b2);
    return orientation(*b0, *b1, *a0, *a1, counts) <= 0 && orientation(*b0, *b2, *a2, *a0, counts) <= 0;
}

} // namespace cinch
