// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/find_inside.hpp"

#include <limits>
#include <map>

#include <Eigen/Geometry>

namespace cinch {
namespace {

// Shares of the corners in the triangle's point that is closest to p [Ericson 2005, 5.1.5].
std::array<double, 3> closest_point(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c)
{
    const Vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
    const double d1 = ab.dot(ap), d2 = ac.dot(ap), d3 = ab.dot(bp), d4 = ac.dot(bp), d5 = ab.dot(cp), d6 = ac.dot(cp);
    if (d1 <= 0 && d2 <= 0)
        return {1, 0, 0};
    if (d3 >= 0 && d4 <= d3)
        return {0, 1, 0};
    if (d6 >= 0 && d5 <= d6)
        return {0, 0, 1};
    const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
    if (vc <= 0 && d1 >= 0 && d3 <= 0)
        return {1 - d1 / (d1 - d3), d1 / (d1 - d3), 0};
    if (vb <= 0 && d2 >= 0 && d6 <= 0)
        return {1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)};
    if (va <= 0 && d4 >= d3 && d5 >= d6 && (d4 - d3) + (d5 - d6) > 0) {
        const double along = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return {0, 1 - along, along};
    }
    const double sum = va + vb + vc;
    if (!(sum > 0)) // a triangle without area
        return {1, 0, 0};
    return {va / sum, vb / sum, vc / sum};
}

struct Closest {
    std::uint32_t triangle = 0;
    std::array<double, 3> share{};
    double distance2 = std::numeric_limits<double>::infinity();
};

void take_closer(const PosedSurface& s, std::uint32_t triangle, const Vec3& p, Closest& best)
{
    const Triangle& t = s.mesh.triangles[triangle];
    const Vec3 &a = s.position[t[0]], &b = s.position[t[1]], &c = s.position[t[2]];
    const auto share = closest_point(p, a, b, c);
    const double distance2 = (share[0] * a + share[1] * b + share[2] * c - p).squaredNorm();
    if (distance2 < best.distance2 || (distance2 == best.distance2 && triangle < best.triangle))
        best = {triangle, share, distance2};
}

// From a triangle to the closest of those around its corners, and on while they get closer.
Closest walk(const PosedSurface& s, std::uint32_t start, const Vec3& p)
{
    Closest best;
    take_closer(s, start, p, best);
    for (double before = std::numeric_limits<double>::infinity(); best.distance2 < before;) {
        before = best.distance2;
        for (const std::uint32_t corner : s.mesh.triangles[best.triangle])
            for (const std::uint32_t t : s.around[corner])
                take_closer(s, t, p, best);
    }
    return best;
}

bool is_behind(const PosedSurface& s, const Closest& at, const Vec3& p)
{
    const Triangle& t = s.mesh.triangles[at.triangle];
    const Vec3& a = s.position[t[0]];
    return s.outside * (s.position[t[1]] - a).cross(s.position[t[2]] - a).dot(p - a) < 0;
}

} // namespace

TrianglesAround::TrianglesAround(const TriangleMesh& mesh)
    : first_(mesh.vertices.size() + 1, 0), triangle_(3 * mesh.triangles.size())
{
    for (const Triangle& t : mesh.triangles)
        for (const std::uint32_t k : t)
            ++first_[k + 1];
    for (std::size_t k = 1; k < first_.size(); ++k)
        first_[k] += first_[k - 1];
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
        for (const std::uint32_t k : mesh.triangles[t])
            triangle_[next[k]++] = t;
}

std::vector<InsideVertex> find_inside(const PosedSurface& a, const PosedSurface& b,
                                      std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs)
{
    std::vector<bool> meets(a.mesh.triangles.size(), false);
    std::map<std::uint32_t, Closest> border; // corners of triangles that meet b
    for (const auto& [own, other] : pairs) {
        meets[own] = true;
        for (const std::uint32_t k : a.mesh.triangles[own])
            take_closer(b, other, a.position[k], border[k]);
    }
    std::vector<InsideVertex> inside;
    std::vector<std::uint32_t> from(a.mesh.vertices.size(), 0); // triangle of b from which to walk
    std::vector<bool> seen(a.mesh.vertices.size(), false);
    std::vector<std::uint32_t> piece;
    for (const auto& [first, unused] : border) {
        if (seen[first])
            continue;
        piece.assign(1, first);
        seen[first] = true;
        int vote = 0;
        for (std::size_t i = 0; i < piece.size(); ++i) {
            const std::uint32_t k = piece[i];
            if (const auto at = border.find(k); at != border.end()) {
                from[k] = at->second.triangle;
                vote += is_behind(b, at->second, a.position[k]) ? 1 : -1;
            }
            for (const std::uint32_t t : a.around[k]) {
                if (meets[t])
                    continue;
                for (const std::uint32_t neighbour : a.mesh.triangles[t])
                    if (!seen[neighbour]) {
                        seen[neighbour] = true;
                        from[neighbour] = from[k];
                        piece.push_back(neighbour);
                    }
            }
        }
        if (vote <= 0)
            continue;
        for (const std::uint32_t k : piece) {
            const Closest at = walk(b, from[k], a.position[k]);
            inside.push_back({k, at.triangle, at.share});
        }
    }
    return inside;
}

} // namespace cinch
