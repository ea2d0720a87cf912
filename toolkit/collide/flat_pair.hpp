// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "toolkit/collide/triangle_pair.hpp"

namespace cinch {

/// The same as intersect for finite triangles that are coplanar or of which at least one is a segment or a point, none
/// of them strictly on one side of the plane of the other.
bool intersect_flat(const TrianglePoints& a, const TrianglePoints& b, OrientationCounts* counts) noexcept;

} // namespace cinch
