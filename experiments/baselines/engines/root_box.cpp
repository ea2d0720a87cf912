// SPDX-License-Identifier: GPL-3.0-or-later
// The box of the pose of the file in the space of the root bone, carried by that bone: Unity 6 (localBounds of a
// SkinnedMeshRenderer, with updateWhenOffscreen off).
#include <Eigen/LU>

#include "experiments/baselines/engines/engine_formula.hpp"

namespace cinch {
namespace {

Eigen::Matrix4d matrix_of(const AffineMap& map)
{
    Eigen::Matrix4d out = Eigen::Matrix4d::Identity();
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 4; ++c)
            out(r, c) = map.m[r][c];
    return out;
}

} // namespace

std::optional<ReadyFormula> root_box(const EngineCharacter& of)
{
    if (of.pivot.empty())
        return {};
    const Eigen::Matrix4d at_rest = matrix_of(of.file_pose[of.root]);
    if (!(std::abs(at_rest.determinant()) > 0))
        return {};
    const EngineBound box = box_of(of.places(of.file_pose));
    return ReadyFormula{false, false,
                        [root = of.root, back = Eigen::Matrix4d(at_rest.inverse()), centre = box.centre(),
                         half = Vec3(0.5 * (box.high - box.low))](std::span<const AffineMap> maps) {
                            const Eigen::Matrix4d m = matrix_of(maps[root]) * back;
                            const Vec3 middle = m.topLeftCorner<3, 3>() * centre + m.topRightCorner<3, 1>(),
                                       reach = m.topLeftCorner<3, 3>().cwiseAbs() * half;
                            return EngineBound{middle - reach, middle + reach, {}};
                        }};
}

} // namespace cinch
