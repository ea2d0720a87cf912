// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "experiments/fuzz/fuzz_case.hpp"
#include "experiments/records/run_campaign.hpp"

namespace cinch {

struct FuzzOptions {
    std::optional<double> seconds;      ///< a limit, if given
    std::optional<std::uint64_t> cases; ///< a limit, if given; of this shard, those of a resumed state included
    std::uint64_t seed = 0;
    std::string family; ///< empty: all in turn
    ShardOptions
        shards;         ///< without a folder: every N-th case, from the I-th on; with one, a campaign of `cases` in all
    std::string resume; ///< state file; empty: none
    std::string corpus; ///< where shrunk failures go; empty: nowhere, or into the folder
    int threads = 0;
    OutputOptions output;
    Defect defect = Defect::none;
};

/// Runs differential cases until a limit or an interrupt; none if a limit is 0. A state is saved at the start, ten
/// times a second, and at the end. Throws InputError for a state of other settings, of more than `cases`, or that
/// another process is using. Exit status: 0 no violation, 1 some, 130 interrupted without any. Case i of a seed is the
/// same whatever the threads, shards and interruptions.
int fuzz(const FuzzOptions& options);

} // namespace cinch
