// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiments/shipped.hpp"
#include "toolkit/simulate/simulation.hpp"

namespace cinch {

/// What a user may change of a scene without writing one.
struct SceneChanges {
    std::size_t nodes = 0;              ///< of bodies whose nodes are sampled; 0 and empty: as the scene has it
    double duration_s = -1, step_s = 0; ///< −1, 0: as the scene has it
    std::string integrator;
    std::string elastic_model; ///< of all elastic materials
};

/// A scene with where it comes from.
struct FoundScene {
    Scene scene;
    std::string file;       ///< for messages
    std::uint64_t identity; ///< of its text and the changes: a checkpoint continues only the same
};

/// Of a shipped scene or a .json file. Throws InputError.
FoundScene find_scene(const std::string& name_or_file, const SceneChanges& changes);

} // namespace cinch
