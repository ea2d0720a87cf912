// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "experiments/measure/verdict.hpp"
#include "experiments/report/record_output.hpp"

namespace cinch {

struct CrowdAuditOptions {
    std::size_t bodies = 0; ///< in the crowd; 0: none is wanted
    double seconds = 2;     ///< of measuring, per crowd
    std::uint64_t seed = 0;
    OutputOptions output;
};

/// Boxes of many characters of 22 and of 70 simulation nodes, one box each and 64: the formula of engines beside ours,
/// with the same vectors. Returns the exit status.
int audit_crowd(const CrowdAuditOptions& options);

} // namespace cinch
