// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "cinch/bvh.hpp"
#include "toolkit/deform/aligned.hpp"
#include "toolkit/hierarchy/kernel/leaf_kernel.hpp"

namespace cinch {

/// The leaves of a Bvh, in order of their BVs, as evaluate_leaves reads them. Stands alone: Bvh and surface may go.
struct LeafSet {
    std::size_t lanes = 16; ///< 4, 8 or 16: room for the triangles and vertices of every leaf
    std::vector<PackedLeaf> leaves;
    AlignedVector<float> value;

    std::size_t bytes() const { return leaves.size() * sizeof(leaves[0]) + value.size() * sizeof(float); }
};

/// `rest_origin`: of the projected maps (RestExtent::origin); lanes: 4, 8 or 16. Throws std::invalid_argument for
/// leaves that have not enough of them.
LeafSet pack_leaves(const Bvh& bvh, const DeformableSurface& surface, const Vec3& rest_origin, std::size_t lanes);

} // namespace cinch
