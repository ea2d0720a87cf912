// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "toolkit/collide/orientation.hpp"

namespace cinch {

using TrianglePoints = std::array<Vec3, 3>;

/// Whether the convex hulls of the two triples of points have a point in common: touching counts, and a triangle may be
/// a segment or a point. Exact for any finite coordinates, so the order of the vertices and of the triangles does not
/// matter. True where a coordinate is not finite: an unknown never loses a pair.
bool intersect(const TrianglePoints& a, const TrianglePoints& b, OrientationCounts* counts = nullptr) noexcept;

} // namespace cinch
