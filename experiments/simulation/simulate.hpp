// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "experiments/report/record_output.hpp"
#include "experiments/simulation/find_scene.hpp"

namespace cinch {

struct SimulateOptions {
    std::string scene;
    SceneChanges changes;
    std::string frames; ///< file of node transforms: binary, or JSON Lines if it ends in .jsonl; empty: none
    std::string meshes; ///< folder of one mesh per body and frame; empty: none
    std::string mesh_format = "ply";
    std::string checkpoint, resume; ///< files; empty: none
    std::size_t every = 10;         ///< frames from checkpoint to checkpoint
    int threads = 0;
    bool explain = false, energies = false;
    bool schema = false; ///< print the layout of scenes instead
    OutputOptions output;
};

/// Runs a scene. Returns the exit status: 0 done, 1 a step could not be solved, 130 interrupted; what is done is kept.
int simulate(const SimulateOptions& options);

} // namespace cinch
