// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "experiments/report/record_output.hpp"

namespace cinch {

struct MergeOptions {
    std::string folder;
    OutputOptions output;
};

/// Prints what the command of a folder of shards prints of all its rows. Returns that command's exit status.
int merge_shards(const MergeOptions& options);

} // namespace cinch
