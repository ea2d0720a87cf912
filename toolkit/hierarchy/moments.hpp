// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "toolkit/bounds/bound_moments.hpp"

namespace cinch {

/// Rest data of the moment bound for every BV.
struct MomentData {
    std::vector<MomentInfluence> influence; ///< parallel to Bvh::node
    std::vector<Lifted> point;              ///< of all BVs
    std::vector<std::size_t> first_point;   ///< of each BV; and one at the end
    std::vector<Lifted> least, greatest;    ///< of each BV

    RestMoments of(const Bv& bv, std::size_t index) const
    {
        return {bv.pivot, std::span(influence).subspan(bv.first_influence, bv.influence_count),
                std::span(point).subspan(first_point[index], first_point[index + 1] - first_point[index]), least[index],
                greatest[index]};
    }
};

/// Of a tree with models of weights (RestDetail::inner). BVs of at most 64 vertices have all of them as points.
/// Simulation nodes without a place of their own (DeformableSurface::place) stand at the mean of the vertices that they
/// influence, by weight. In parallel, deterministic.
MomentData rest_moments(const Bvh& bvh, const DeformableSurface& surface);

} // namespace cinch
