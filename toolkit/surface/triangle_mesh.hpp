// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace cinch {

using Vec3 = Eigen::Vector3d;
using Triangle = std::array<std::uint32_t, 3>;

/// Vertices and triangles exactly as a file declares them: nothing is welded, dropped or reordered,
/// so duplicate and degenerate triangles and unreferenced vertices are legal.
struct TriangleMesh {
    std::vector<Vec3> vertices;      ///< finite coordinates, in the file's unit
    std::vector<Triangle> triangles; ///< indices into `vertices`
};

/// Centre of the axis-aligned box of the vertices and its longest half-extent; an empty mesh gives {0, 0}.
struct Extent {
    Vec3 centre = Vec3::Zero();
    double longest_half = 0;
};
Extent extent(const TriangleMesh& mesh);

/// Moves the box's centre to the origin and scales the longest half-extent to `half`. A mesh without extent
/// is only moved. The rounded result is the new surface; nothing refers to the old one.
void centre_and_scale(TriangleMesh& mesh, double half);

/// Of the space that a closed mesh encloses, negative if its triangles face inward; meaningless for an open mesh.
double signed_volume(const TriangleMesh& mesh);

/// One 1-to-4 subdivision at the edge midpoints. A closed genus-0 surface of V vertices gets 4V − 6.
TriangleMesh subdivide(const TriangleMesh& mesh);

} // namespace cinch
