// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "cinch/bounds.hpp"
#include "toolkit/bounds/projected_maps.hpp"

namespace cinch {

/// What projecting leaves besides the records.
struct ProjectionReport {
    std::size_t unbounded = 0; ///< see ProjectedMaps
    double vertex_error = 0;
};

/// Writes the records of ProjectedMaps, relative to `origin`. The same bits on every target: four simulation nodes at a
/// time, in double.
template <class T> ProjectionReport project_nodes(std::span<const AffineMap> maps, const RestExtent& rest,
                                                  std::span<const Axis> axes, bool proven, const Vec3& origin,
                                                  T* records);

} // namespace cinch
