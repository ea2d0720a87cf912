// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "experiments/report/record_output.hpp"

namespace cinch {

struct CornersOptions {
    std::vector<std::string> files;
    OutputOptions output;
    bool list = false;
    std::uint64_t limit = 0; ///< most corners listed per file; 0: all
};

/// Answers each case file. Exit status: 0, 1 if a toolkit bound lies below the exact maximum, 2 if a file is bad (the
/// others are answered), 130 interrupted.
int corners(const CornersOptions& options);

} // namespace cinch
