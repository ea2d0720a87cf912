// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "experiments/report/record_output.hpp"

namespace cinch {

struct CostSimulationOptions {
    std::string scene;
    double duration_s = 0.25; ///< simulated, at most
    double seconds = 2;       ///< of measuring single steps
    OutputOptions output;
};

/// What accuracy costs in time: step size × integrator × energy against the error to a converged reference; and what
/// one substep costs, against a plain Eigen version, nodes and neighbours. Returns the exit status.
int cost_simulation(const CostSimulationOptions& options);

} // namespace cinch
