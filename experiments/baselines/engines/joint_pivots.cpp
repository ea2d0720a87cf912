// SPDX-License-Identifier: GPL-3.0-or-later
// The box of the joints' positions, grown on all sides by how far the mesh, as it is bound, reaches beyond the joints
// at rest: OpenUSD's UsdSkel (ComputeExtentsPadding, UsdSkelComputeJointsExtent), the bind transform of the mesh being
// that of the file.
#include "experiments/baselines/engines/engine_formula.hpp"

namespace cinch {
namespace {

EngineBound box_of_joints(const std::vector<Vec3>& pivot, std::span<const AffineMap> maps)
{
    EngineBound box = no_box();
    for (std::size_t j = 0; j < pivot.size(); ++j) {
        const Vec3 x = apply(maps[j], pivot[j]);
        box = merged(box, {x, x, {}});
    }
    return box;
}

} // namespace

std::optional<ReadyFormula> joint_pivots(const EngineCharacter& of)
{
    if (of.pivot.empty())
        return {};
    const EngineBound mesh = box_of(of.surface.mesh.vertices), joints = box_of_joints(of.pivot, of.file_pose);
    const double pad = std::max({0.0, (joints.low - mesh.low).maxCoeff(), (mesh.high - joints.high).maxCoeff()});
    return ReadyFormula{false, false, [pad, pivot = of.pivot](std::span<const AffineMap> maps) {
                            EngineBound box = box_of_joints(pivot, maps);
                            box.low -= Vec3::Constant(pad);
                            box.high += Vec3::Constant(pad);
                            return box;
                        }};
}

} // namespace cinch
