// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "cinch/refit.hpp"
#include "experiments/records/run_campaign.hpp"

namespace cinch {

struct ScalingOptions {
    Precision precision = Precision::float32;
    int passes = 1;
    double seconds = 1; ///< of measuring per size
    std::uint64_t seed = 0;
    std::string input;    ///< measured instead of the brain: a scene's first body, a mesh or a character
    bool partial = false; ///< of a character: what is modelled, see InputOptions
    ShardOptions shards;  ///< by sizes
    OutputOptions output;
};

/// The paper's Table 1: time of one bound of the whole brain (six directions) for 3 numbers of vertices and 3 of
/// simulation nodes, by every method, with the textbook's Eq. 12 and the optimal AABB in the same run. Returns the exit
/// status.
int scaling(const ScalingOptions& options);
/// The same from rows that shards computed.
int print_scaling(const Merged& all, const OutputOptions& options);

} // namespace cinch
