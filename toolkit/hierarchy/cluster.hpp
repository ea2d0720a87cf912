// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cinch/bvh.hpp"

namespace cinch {

/// Groups of triangles that lie together. Cluster c owns triangle[first[c]] to triangle[first[c + 1] − 1].
struct Clusters {
    std::vector<std::uint32_t> triangle; ///< a permutation of the mesh's triangles
    std::vector<std::uint32_t> first = {0};

    std::size_t count() const { return first.size() - 1; }
};

/// Greedy by adjacency: each cluster grows by the neighbouring triangle that brings the fewest new vertices, and among
/// those the nearest. Where none is left it takes the next one in `order` if that lies as near as its own triangles are
/// large. `order` is a permutation of the triangles in which those near each other stand together. Deterministic;
/// linear but for sorting.
Clusters cluster_triangles(const TriangleMesh& mesh, const std::vector<std::uint32_t>& order, ClusterSize most);

} // namespace cinch
