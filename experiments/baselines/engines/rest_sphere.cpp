// SPDX-License-Identifier: GPL-3.0-or-later
// A ball about the vertices of the pose in which a skinned mesh is first drawn, grown point by point, and cached:
// three.js since r151 (SkinnedMesh.computeBoundingSphere; nothing computes it again). Here that of the pose of the
// file.
#include "experiments/baselines/engines/engine_formula.hpp"

namespace cinch {

std::optional<ReadyFormula> rest_sphere(const EngineCharacter& of)
{
    const std::vector<Vec3> places = of.places(of.file_pose);
    Vec3 centre = places.front();
    double radius = 0;
    for (const Vec3& x : places) {
        const double away = (x - centre).norm();
        if (!(away > radius))
            continue;
        const double half = (away - radius) / 2;
        centre += (half / away) * (x - centre);
        radius += half;
    }
    const EngineBound ball = EngineBound::around(centre, radius);
    return ReadyFormula{true, false, [ball](std::span<const AffineMap>) { return ball; }};
}

} // namespace cinch
