// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/collide/rest_trees.hpp"

namespace cinch {
namespace {

bool equal(const DeformableSurface& a, const DeformableSurface& b)
{
    return &a == &b ||
           (a.mesh.vertices == b.mesh.vertices && a.mesh.triangles == b.mesh.triangles && a.layout == b.layout &&
            a.weights.node_count == b.weights.node_count && a.weights.row == b.weights.row &&
            a.weights.node == b.weights.node && a.weights.weight == b.weights.weight);
}

} // namespace

const Bvh& RestTrees::of(const DeformableSurface& surface, ClusterSize leaf, RestDetail detail)
{
    for (const Built& b : built_)
        if (b.leaf_triangles == leaf.triangles && b.detail == detail && equal(*b.surface, surface))
            return b.bvh;
    built_.push_back({&surface, leaf.triangles, detail,
                      leaf.triangles == 1 ? build_bvh(surface, 1, detail) : build_bvh(surface, leaf, detail)});
    return built_.back().bvh;
}

} // namespace cinch
