// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <deque>

#include "cinch/bvh.hpp"

namespace cinch {

/// Trees that several backends start from, each built once, of equal surfaces too.
class RestTrees {
public:
    /// Leaves of one triangle, or of clusters. The surface has to stay; the tree stays until forget().
    const Bvh& of(const DeformableSurface& surface, ClusterSize leaf, RestDetail detail);
    void forget() { built_.clear(); }

private:
    struct Built {
        const DeformableSurface* surface;
        std::size_t leaf_triangles;
        RestDetail detail;
        Bvh bvh;
    };
    std::deque<Built> built_;
};

} // namespace cinch
