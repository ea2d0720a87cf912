// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "toolkit/bounds/bound_moments.hpp"

namespace cinch {

/// Rest data of the moment bound for every BV.
struct MomentData {
    double unit = 1;                        ///< of length, for all
    std::vector<Vec3> centre;               ///< of each BV
    std::vector<MomentInfluence> influence; ///< parallel to Bvh::node
    std::vector<Lifted> point;              ///< of all BVs
    std::vector<std::size_t> first_point;   ///< of each BV; and one at the end
    std::vector<Lifted> least, greatest;    ///< of each BV

    bool has(std::size_t index) const { return !first_point.empty() && first_point[index + 1] > first_point[index]; }
    RestMoments of(const Bv& bv, std::size_t index) const
    {
        return {centre[index],
                unit,
                std::span(influence).subspan(bv.first_influence, bv.influence_count),
                std::span(point).subspan(first_point[index], first_point[index + 1] - first_point[index]),
                least[index],
                greatest[index]};
    }
};

/// Of the BVs that are wanted, of a tree with models of weights (RestDetail::inner). Those of few
/// vertices have all of them as points (lifted_points_of).
/// Simulation nodes without a place of their own (DeformableSurface::place) stand at the mean of the vertices that they
/// influence, by weight. Places, in units of the surface, are rounded to 24 bits about a centre near their mean, which
/// has 24 bits about the rest origin: both are exact in float. In parallel, deterministic.
MomentData rest_moments(
    const Bvh& bvh, const DeformableSurface& surface,
    const std::function<bool(const Bv&)>& wanted = [](const Bv&) { return true; });

} // namespace cinch
