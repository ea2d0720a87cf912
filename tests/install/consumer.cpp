// SPDX-License-Identifier: GPL-3.0-or-later
#include <toolkit/deform/sample_nodes.hpp>
#include <toolkit/hierarchy/refit.hpp>
#include <toolkit/surface/shapes.hpp>

int main()
{
    cinch::DeformableSurface surface{cinch::fish(500), {}};
    surface.weights = kernel_weights(surface.mesh, sample_nodes(surface.mesh, 20, 0), 2);
    const cinch::Bvh bvh = build_bvh(surface, 4);
    std::vector<double> supports(bvh.bvs.size() * 6);
    refit(bvh, surface, std::vector<cinch::AffineMap>(20, cinch::identity_map), {}, supports);
    return supports[0] > 0.5 && supports[0] < 1.5 ? 0 : 1;
}
