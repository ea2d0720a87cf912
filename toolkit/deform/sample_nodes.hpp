// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "toolkit/deform/weights.hpp"
#include "toolkit/surface/triangle_mesh.hpp"

namespace cinch {

/// Simulation nodes in rest position and the radius within which each influences the surface.
struct SimulationNodes {
    std::vector<Vec3> position;
    double fill_distance = 0; ///< the farthest that any point of the volume or surface is from its nearest node
};

/// The points of a cubic grid of about `points` cells over the bounding box that the surface winds around: of a closed mesh its
/// interior. None where the mesh is flat or open.
std::vector<Vec3> interior_points(const TriangleMesh& mesh, double points);

/// Farthest-point samples of the closed volume: the vertices and the points of a grid that have non-zero winding number
/// (none where the mesh is flat or open). Fewer than `count` where there are not that many distinct points.
/// `seed` chooses the first sample. Throws std::invalid_argument for a mesh without vertices or a count of 0.
SimulationNodes sample_nodes(const TriangleMesh& mesh, std::size_t count, std::uint64_t seed);

/// Kernel (1 − r²/h²)³ for r < h, normalised per vertex, h = support × fill distance. A vertex beyond every node's reach
/// follows its nearest node alone; `alone`, if given, counts these (not those that coincide with it, as all do where h = 0).
Weights kernel_weights(const TriangleMesh& mesh, const SimulationNodes& nodes, double support, std::size_t* alone = nullptr);

} // namespace cinch
