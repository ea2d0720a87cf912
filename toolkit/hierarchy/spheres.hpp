// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "cinch/bvh.hpp"
#include "toolkit/bounds/bound_sphere.hpp"

namespace cinch {

/// Rest data of the sphere method for every BV; parallel to Bvh::node where per influence.
struct RestSpheres {
    std::vector<Vec3> place; ///< of every simulation node: the mean of the vertices that it influences, by weight
    std::vector<double> radius;
    std::vector<SphereInfluence> influence;

    RestSphere of(const Bv& bv, std::size_t index) const
    {
        return {bv.box.centre, radius[index], std::span(influence).subspan(bv.first_influence, bv.influence_count)};
    }
};

RestSpheres rest_spheres(const Bvh& bvh, const DeformableSurface& surface);

/// Per simulation node the mean position of the vertices that it influences, by weight; the origin if there are none.
std::vector<Vec3> node_places(const DeformableSurface& surface);

} // namespace cinch
