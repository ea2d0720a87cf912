// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cinch/surface.hpp"

namespace cinch {

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
