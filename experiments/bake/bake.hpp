// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cinch/refit.hpp"
#include "experiments/input.hpp"
#include "experiments/records/run_campaign.hpp"
#include "experiments/report/record_output.hpp"
#include "toolkit/time/engine.hpp"

namespace cinch {

/// Damage done to bounds over time on purpose, to see that the exact side finds it.
enum class TimeSabotage { none, no_remainder, half_bump, first_half, still_morphs };

struct BakeOptions {
    InputOptions input; ///< clip empty: all of them
    RefitOptions bounds;
    Engine engine;
    std::size_t leaf = 4;    ///< most triangles of a leaf
    int level = 0;           ///< deepest of the BVs written; -1: all
    double interval_s = 0;   ///< 0: by itself
    bool whole = false;      ///< one interval per clip
    double tolerance = 0.01; ///< of a BV's half diagonal
    bool prove = false;
    bool report = false;               ///< figures beside the truth
    int samples = 30;                  ///< of the truth, between two keys
    std::string npz, usd, certificate; ///< files to write; empty: none
    ShardOptions shards;
    OutputOptions output;
    TimeSabotage sabotage = TimeSabotage::none;
};

/// Bounds of every BV for all times of clips, written down. Returns the exit status: 0 done, 1 a bound is not proven.
int bake(const BakeOptions& options);

/// The same of clips that shards have baked (`cinch merge`).
int print_bake(const Merged& all, const OutputOptions& options);

} // namespace cinch
