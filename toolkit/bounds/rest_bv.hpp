// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "toolkit/bounds/weight_space.hpp"
#include "toolkit/surface/skin.hpp"

namespace cinch {

/// The real box centre ± half contains its vertices.
struct RestBox {
    Vec3 centre = Vec3::Zero(), half = Vec3::Zero();
};

/// The real parallelepiped centre + Σ β_i axis_i, |β_i| ≤ 1, contains its vertices. Its axes are nearly orthogonal: an OBB.
struct OrientedBox {
    Vec3 centre = Vec3::Zero();
    Vec3 axis[3] = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
};

/// Which rest box of a BV the methods without local boxes use.
enum class RestShape : std::uint8_t { aabb, obb };

/// w_j ≈ mean + gradient·y over a BV's vertices, y = x − pivot. Exactly, for every vertex: |w_j − mean − gradient·y| ≤ residual
/// and |(w_j − mean) y_i| ≤ moment_i. The means of a BV are multiples of 2^-53 that sum to exactly 1.
struct WeightModel {
    double mean = 0;
    Vec3 gradient = Vec3::Zero();
    double residual = 0;
    Vec3 moment = Vec3::Zero();
};

/// What one BV knows of its vertices in rest state. A view; owns nothing.
struct RestBv {
    RestBox box;
    std::span<const std::uint32_t> node;   ///< simulation nodes that influence it
    WeightSpace space;                     ///< parallel to `node`
    std::span<const RestBox> local;        ///< parallel to `node`: holds the vertices that the simulation node influences,
    std::span<const double> radius;        ///< and so does the ball of this radius about the box's centre
    Vec3 pivot = Vec3::Zero();             ///< origin of y in the weight model and of the points
    std::span<const WeightModel> model;    ///< parallel to `node`
    std::span<const std::uint32_t> point;  ///< extreme vertices: max q·x over all vertices is at most that over these + slack·‖q‖
    double slack = 0;
    std::uint32_t vertex_influences = 0;   ///< most simulation nodes of any one of its vertices
};

} // namespace cinch
