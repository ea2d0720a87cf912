// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cinch/refit.hpp"
#include "experiments/input.hpp"
#include "experiments/records/run_campaign.hpp"
#include "experiments/report/record_output.hpp"

namespace cinch {

struct TightnessOptions {
    InputOptions input;           ///< but INPUT, --nodes, --motion and --seed, which are in `lists`
    InputLists lists;             ///< several inputs, numbers of simulation nodes or seeds make it a study
    std::vector<Methods> methods; ///< empty: sphere, eq12, limited, local, support, linear, best
    std::vector<std::size_t>
        nodes; ///< numbers of simulation nodes for the root's ratio; empty: 8 to 512 if the input lets us choose
    Precision precision = Precision::float32;
    int passes = 1;
    std::size_t leaf = 1;
    int threads = 0;
    ShardOptions shards;
    OutputOptions output;
};

/// The paper's Fig. 5: radius of the bound over true radius, mean and greatest over frames, by BVH level and method,
/// with exact attribution of what is lost; and the root's ratio against the number of simulation nodes. Returns the
/// exit status.
int tightness(const TightnessOptions& options);

/// What `tightness` prints of a whole measurement, however its rows came about. Returns its exit status.
int print_tightness(const Merged& all, const OutputOptions& options);

} // namespace cinch
