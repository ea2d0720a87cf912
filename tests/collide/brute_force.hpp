// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// What a collider must find, with nothing of its own: positions by evaluate_vertex, all pairs of triangles whose boxes
// in double overlap, and the exact predicate. Its order too, by a traversal of all pairs of BVs that rejects none.

#include <string>
#include <vector>

#include "cinch/collider.hpp"
#include "cinch/surface.hpp"
#include "toolkit/collide/triangle_pair.hpp"

namespace cinch::test {

using Positions = std::vector<Vec3>; ///< of all vertices of a body
using Pairs = std::vector<TrianglePair>;

/// All vertices of a body in a frame, one by one.
Positions positions_of(const DeformableSurface& surface, const BodyFrame& frame);

TrianglePoints corners_of(const DeformableSurface& surface, const Positions& positions, std::uint32_t triangle);

/// The pairs of all bodies, sorted. Bodies with `left_out` set are in none.
Pairs brute_force(const std::vector<const DeformableSurface*>& surfaces, const std::vector<Positions>& positions,
                  const std::vector<bool>& left_out = {});

Pairs sorted(Pairs pairs);

/// Of sorted pairs, how many are only in the one or the other, and the first of them.
std::string difference(const Pairs& truth, const Pairs& found);

/// Bodies with their trees and the frames they go through.
struct Bodies {
    std::vector<DeformableSurface> surface;
    std::vector<std::vector<BodyFrame>> frame;             ///< [frame][body]
    std::vector<std::vector<std::vector<AffineMap>>> maps; ///< what `frame` points to, where it is not positions
    std::vector<std::vector<Positions>> given;

    std::vector<const DeformableSurface*> surfaces() const;
    void add_frame(std::vector<std::vector<AffineMap>> of_bodies);
    void add_positions(std::vector<Positions> of_bodies);
    /// Sorted, per frame.
    std::vector<Pairs> truth(const std::vector<bool>& left_out = {}) const;
    std::vector<Bvh> trees(ClusterSize leaf, RestDetail detail = RestDetail::inner) const;

    Bodies() = default;
    Bodies(Bodies&&) = default; // a copy would point to the original's frames
    Bodies& operator=(Bodies&&) = default;
};

/// Truth in the order in which a collider must give it: all pairs of bodies; all pairs of their BVs level by level,
/// both children, of the larger one or of both, in the place of every pair; then the leaves, triangle by triangle. For
/// small bodies.
Pairs in_order_of_trees(const Collider& collider, const Pairs& truth);

} // namespace cinch::test
