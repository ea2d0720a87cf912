// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "experiments/input.hpp"

namespace cinch {

/// A body as the view draws it: triangles in the order of the BVH, so that a BV is a range of them, and the vertices
/// that they use in the order in which they do.
struct DrawnBody {
    explicit DrawnBody(const Input& body) : input(body), bvh(build_bvh(body.surface, ClusterSize{16, 16}))
    {
        constexpr std::uint32_t none = ~0u;
        const TriangleMesh& mesh = body.surface.mesh;
        std::vector<std::uint32_t> place(mesh.vertices.size(), none);
        place_of_triangle.resize(mesh.triangles.size());
        for (std::uint32_t t = 0; t < bvh.triangle.size(); ++t) {
            place_of_triangle[bvh.triangle[t]] = t;
            for (const std::uint32_t v : mesh.triangles[bvh.triangle[t]]) {
                if (place[v] == none) {
                    place[v] = static_cast<std::uint32_t>(vertex.size());
                    vertex.push_back(v);
                }
                corner.push_back(place[v]);
            }
        }
    }
    std::uint32_t bvs(std::size_t levels) const { return bvh.level[std::min(levels, bvh.level.size() - 1)]; }

    const Input& input;
    Bvh bvh;
    std::vector<std::uint32_t> vertex;            ///< of the mesh
    std::vector<std::uint32_t> corner;            ///< 3 per triangle, in `vertex`
    std::vector<std::uint32_t> place_of_triangle; ///< of the mesh, in the BVH's order
};

} // namespace cinch
