// SPDX-License-Identifier: GPL-3.0-or-later
// The box of the pose of the file, grown by the greatest displacement of any one morph target: three.js r160
// (computeBounds of GLTFLoader, which calls it an average-case estimate: targets that act together add up).
#include "experiments/baselines/engines/engine_formula.hpp"

namespace cinch {

std::optional<ReadyFormula> morph_average(const EngineCharacter& of)
{
    if (of.targets.empty())
        return {};
    Vec3 most = Vec3::Zero();
    for (const MorphTarget& target : of.targets)
        for (const Vec3& d : target.displacement)
            most = most.cwiseMax(d.cwiseAbs());
    EngineBound box = box_of(of.places(of.file_pose));
    box.low -= most;
    box.high += most;
    return ReadyFormula{true, false, [box](std::span<const AffineMap>) { return box; }};
}

} // namespace cinch
