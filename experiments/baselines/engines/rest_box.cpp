// SPDX-License-Identifier: GPL-3.0-or-later
// The box of the mesh as the file poses it, computed when it is loaded and never again: Bevy before 0.19 (its Aabb
// comes from the mesh), Babylon.js without refreshBoundingInfo.
#include "experiments/baselines/engines/engine_formula.hpp"

namespace cinch {

std::optional<ReadyFormula> rest_box(const EngineCharacter& of)
{
    const EngineBound box = box_of(of.places(of.file_pose));
    return ReadyFormula{true, false, [box](std::span<const AffineMap>) { return box; }};
}

} // namespace cinch
