// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "experiments/records/run_campaign.hpp"

namespace cinch {

struct CollideOptions {
    std::vector<std::string> scenes;   ///< empty: the rings of Table 2 and the fishes of Fig. 7
    std::vector<std::string> backends; ///< empty: all that were built
    std::size_t frames = 60;           ///< the last ones of the scene
    std::size_t rounds = 3;
    int threads = 1;
    bool cold = false;
    std::uint64_t seed = 0;
    ShardOptions shards;
    OutputOptions output;
};

/// The paper's Tables 2 to 4 and Fig. 7 on this machine: this project's collision detection against its baselines and
/// peers. Returns the exit status: 1 if a backend of this project found other pairs than the others.
int collide(const CollideOptions& options);

/// What `collide` prints of all scenes, however they came about. Returns its exit status.
int print_collide(const Merged& all, const OutputOptions& options);

} // namespace cinch
