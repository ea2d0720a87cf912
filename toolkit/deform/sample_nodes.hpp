// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cinch/deform.hpp"

namespace cinch {

/// The points of a cubic grid of about `points` cells over the bounding box that the surface winds around: of a closed
/// mesh its interior. None where the mesh is flat or open.
std::vector<Vec3> interior_points(const TriangleMesh& mesh, double points);

} // namespace cinch
