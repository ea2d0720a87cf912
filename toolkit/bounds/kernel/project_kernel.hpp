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

/// Copies records of `length` values, a multiple of 4, of 8 simulation nodes after the other to octets
/// (ProjectedMaps::octet); the last one is filled with 0.
template <class T> void to_octets(std::span<const T> records, std::size_t length, AlignedVector<T>& octets);

} // namespace cinch
