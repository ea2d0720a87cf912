// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "experiments/audit/outside_method.hpp"
#include "experiments/input.hpp"
#include "experiments/records/run_campaign.hpp"
#include "experiments/report/record_output.hpp"

namespace cinch {

struct AuditOptions {
    std::vector<std::string> inputs;
    InputOptions input;                 ///< for each of them
    std::vector<OutsideMethod> outside; ///< beside the formulas
    int samples = 4;                    ///< between two keys
    double seconds = 0.2;               ///< of measuring times, per clip
    std::size_t show = 0;               ///< the number of a counterexample to show; 0: the table
    ShardOptions shards;
    OutputOptions output;
};

/// What engines' formulas for the bound of a character do on files: proven, refuted by an exact counterexample, or
/// neither; how loose; how long they take. Returns the exit status.
int audit(const AuditOptions& options);

/// The same of rows that shards have computed (`cinch merge`).
int print_audit(const Merged& all, const OutputOptions& options);

} // namespace cinch
