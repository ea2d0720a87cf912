// SPDX-License-Identifier: Apache-2.0
#include "toolkit/surface/triangle_mesh.hpp"

#include "cinch/environment.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include <Eigen/Geometry>

namespace cinch {

Extent extent(const TriangleMesh& mesh)
{
    if (mesh.vertices.empty())
        return {};
    Vec3 low = mesh.vertices.front(), high = low;
    for (const Vec3& v : mesh.vertices) {
        low = low.cwiseMin(v);
        high = high.cwiseMax(v);
    }
    // Halves first: high - low may overflow where the coordinates do not.
    const Vec3 half = 0.5 * high - 0.5 * low;
    return {0.5 * high + 0.5 * low, half.maxCoeff()};
}

void centre_and_scale(TriangleMesh& mesh, double half)
{
    require_default_arithmetic();
    const Extent e = extent(mesh);
    for (Vec3& v : mesh.vertices) {
        v -= e.centre;
        if (e.longest_half > 0)
            v = (v / e.longest_half) * half;
    }
}

double signed_volume(const TriangleMesh& mesh)
{
    double six = 0;
    const Vec3 o = extent(mesh).centre;
    for (const Triangle& t : mesh.triangles)
        six += (mesh.vertices[t[0]] - o).dot((mesh.vertices[t[1]] - o).cross(mesh.vertices[t[2]] - o));
    return six / 6;
}

TriangleMesh subdivide(const TriangleMesh& mesh)
{
    TriangleMesh fine;
    fine.vertices = mesh.vertices;
    fine.triangles.reserve(4 * mesh.triangles.size());
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> midpoint;
    auto middle = [&](std::uint32_t a, std::uint32_t b) {
        const auto [it, is_new] =
            midpoint.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(fine.vertices.size()));
        if (is_new)
            fine.vertices.push_back(0.5 * (mesh.vertices[a] + mesh.vertices[b]));
        return it->second;
    };
    for (const auto& [a, b, c] : mesh.triangles) {
        const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
        fine.triangles.insert(fine.triangles.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    return fine;
}

} // namespace cinch
