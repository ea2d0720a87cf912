// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "toolkit/surface/triangle_mesh.hpp"

namespace cinch {

/// The triangles around every vertex of a mesh.
class TrianglesAround {
public:
    explicit TrianglesAround(const TriangleMesh& mesh);
    std::span<const std::uint32_t> operator[](std::uint32_t vertex) const
    {
        return std::span(triangle_).subspan(first_[vertex], first_[vertex + 1] - first_[vertex]);
    }

private:
    std::vector<std::uint32_t> first_, triangle_;
};

/// A closed surface in a frame.
struct PosedSurface {
    const TriangleMesh& mesh; ///< at rest; its triangles count
    const TrianglesAround& around;
    std::span<const Vec3> position; ///< of the vertices
    double outside = 1;             ///< −1 where the triangles' normals point inward
};

/// A vertex that lies inside another surface, and the point of that one which is closest, as far as steps from
/// neighbour to neighbour find it.
struct InsideVertex {
    std::uint32_t vertex = 0, triangle = 0; ///< of the other surface
    std::array<double, 3> share{};          ///< of the triangle's corners in the closest point, ≥ 0, sum 1
};

/// The vertices of `a` inside `b`, given every pair of intersecting triangles (of a, of b). Without the triangles that
/// meet b, a's surface falls into pieces, each wholly inside or outside; the corners at a piece's border decide by
/// vote: a corner is behind or before the closest of the triangles that those around it meet. O(vertices of a), in a
/// fixed order.
std::vector<InsideVertex> find_inside(const PosedSurface& a, const PosedSurface& b,
                                      std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs);

} // namespace cinch
