// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

#include "experiments/fuzz/fuzz_case.hpp"
#include "experiments/report/record_output.hpp"

namespace cinch {

struct FuzzOptions {
    double seconds = 0;      ///< 0: no limit
    std::uint64_t cases = 0; ///< 0: no limit; of this shard, those of a resumed state included
    std::uint64_t seed = 0;
    std::string family;      ///< empty: all in turn
    std::uint64_t shard = 0, shards = 1;
    std::string resume;      ///< state file; empty: none
    std::string corpus;      ///< where shrunk failures go
    int threads = 0;
    OutputOptions output;
    Defect defect = Defect::none;
};

/// Runs differential cases until a limit or an interrupt. Exit status: 0 no violation, 1 some, 130 interrupted without any.
/// Case i of a seed is the same whatever the threads, shards and interruptions.
int fuzz(const FuzzOptions& options);

} // namespace cinch
