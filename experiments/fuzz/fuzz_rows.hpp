// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "experiments/fuzz/fuzz.hpp"

namespace cinch {

/// How many cases one row is of: no more than 100,000 rows, none of fewer than 4,096 cases.
std::uint64_t fuzz_cases_per_cell(std::uint64_t cases);

/// A number of cases in cells, into a folder. Returns the exit status.
int fuzz_in_cells(const FuzzOptions& options);

/// What `fuzz` prints of all cells, however they came about: as if one had run them one after the other. Returns its
/// exit status. What fails is shrunk and saved in the folder's `failures`, where the plan names no corpus.
int print_fuzz(const Merged& all, const OutputOptions& options, const std::string& folder);

} // namespace cinch
