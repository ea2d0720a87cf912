// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "experiments/records/row_folder.hpp"
#include "experiments/report/record_output.hpp"

namespace cinch {

/// What `verify --times all` prints of clips that shards have proven (`cinch merge`). Returns the exit status.
int print_verify_times(const Merged& all, const OutputOptions& options);

} // namespace cinch
