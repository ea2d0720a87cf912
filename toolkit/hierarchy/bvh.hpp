// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "toolkit/bounds/bound_box.hpp"
#include "toolkit/deform/surface.hpp"

namespace cinch {

/// One bounding volume in rest state: rest box, and where its triangles, children and weight intervals lie in the Bvh.
struct Bv {
    Vec3 centre = Vec3::Zero(), half = Vec3::Zero(); ///< rest box; the real box centre ± half contains every rest vertex
    std::uint32_t first_triangle = 0, triangle_count = 0; ///< in Bvh::triangle
    std::uint32_t first_child = 0;      ///< the other child is first_child + 1; 0 for a leaf (the root is nobody's child)
    std::uint32_t first_interval = 0, interval_count = 0; ///< in Bvh::node, l, h
    std::uint32_t vertex_influences = 0; ///< most simulation nodes of any one of its vertices

    bool is_leaf() const { return first_child == 0; }
};

/// A binary tree of BVs over a surface, in flat arrays. BVs stand level by level, the root first, children after parents.
struct Bvh {
    std::vector<Bv> bvs;                   ///< empty for a mesh without triangles
    std::vector<std::uint32_t> level;      ///< level i is BVs [level[i], level[i+1]); the last entry is bvs.size()
    std::vector<std::uint32_t> triangle;   ///< a permutation of the mesh's triangles
    std::vector<std::uint32_t> node;       ///< per BV ascending: every simulation node that influences any of its vertices
    std::vector<double> l, h;              ///< per entry of `node` the least and greatest weight over the BV's vertices

    RestBv rest(std::size_t bv) const
    {
        const Bv& b = bvs[bv];
        const auto first = b.first_interval, count = b.interval_count;
        return {b.centre, b.half, std::span(node).subspan(first, count),
                {std::span(l).subspan(first, count), std::span(h).subspan(first, count)}, b.vertex_influences};
    }
};

/// Median split along the longest axis of the covariance of the triangles' centroids, down to at most `leaf_triangles` ≥ 1 per
/// leaf; ties are split by index, so the depth is logarithmic whatever the geometry. Deterministic.
Bvh build_bvh(const DeformableSurface& surface, std::size_t leaf_triangles);

} // namespace cinch
