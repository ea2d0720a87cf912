// SPDX-License-Identifier: GPL-3.0-or-later
// Balls about the joints, as far as the vertices of each are from it at rest, whatever scales the joints: Ogre 13
// (Entity::setUpdateBoundingBoxFromSkeleton; it takes the greatest radius for all of them).
#include "experiments/baselines/engines/engine_formula.hpp"

namespace cinch {

std::optional<ReadyFormula> joint_spheres(const EngineCharacter& of)
{
    if (of.pivot.empty())
        return {};
    std::vector<double> radius(of.pivot.size(), -1);
    for (std::size_t v = 0; v < of.surface.mesh.vertices.size(); ++v) {
        const Weights::Row row = of.surface.weights.of(v);
        for (std::size_t i = 0; i < row.node.size(); ++i)
            if (row.weight[i] > 0)
                radius[row.node[i]] =
                    std::max(radius[row.node[i]], (of.surface.mesh.vertices[v] - of.pivot[row.node[i]]).norm());
    }
    return ReadyFormula{false, false, [radius, pivot = of.pivot](std::span<const AffineMap> maps) {
                            EngineBound all = no_box();
                            for (std::size_t j = 0; j < radius.size(); ++j)
                                if (radius[j] >= 0)
                                    all = merged(all, EngineBound::around(apply(maps[j], pivot[j]), radius[j]));
                            return all;
                        }};
}

} // namespace cinch
