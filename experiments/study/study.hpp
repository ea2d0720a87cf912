// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "experiments/records/run_campaign.hpp"
#include "experiments/study/plan.hpp"

namespace cinch {

struct StudyOptions {
    std::string plan; ///< file; "-": standard input
    ShardOptions shards;
    int threads = 0;
    OutputOptions output;
};

/// Runs a plan, or one shard of it, and prints its rows and their tables. Returns the exit status.
int study(const StudyOptions& options);
int study(const Plan& plan, const ShardOptions& shards, int threads, const OutputOptions& output);

/// What `study` prints of all rows, however they came about.
void print_study(const Merged& all, const OutputOptions& options, const Completeness& completeness = {});

} // namespace cinch
