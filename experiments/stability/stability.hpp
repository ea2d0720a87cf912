// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "cinch/surface.hpp"
#include "experiments/report/record_output.hpp"

namespace cinch {

/// Safeguards that can be taken away, to see which cases need them.
enum class Missing { nothing, hourglass, completion, projection };

/// A deformed surface that a case leads to; its bounds are proven too.
struct StabilityState {
    DeformableSurface surface;
    std::vector<std::vector<AffineMap>> frames;
};

struct StabilityOutcome {
    bool pass = false;
    std::string observed;
    std::vector<StabilityState> states;
};

/// A hard case: what goes wrong elsewhere, and what has to happen here.
struct StabilityCase {
    std::string name, expected;
    std::function<StabilityOutcome(Missing)> run;
};

/// Meshless model and integrators; bounds; triangles and cells.
std::vector<StabilityCase> model_cases();
std::vector<StabilityCase> solver_cases();
std::vector<StabilityCase> bound_cases();
std::vector<StabilityCase> contact_cases();
/// All of them, in this order.
std::vector<StabilityCase> stability_cases();

/// The bounds of a case's states by every method in float and double, 6 and 14 directions: how many, and how many are
/// proven.
struct StabilityProof {
    std::size_t bounds = 0, proven = 0;
};
StabilityProof prove(const std::vector<StabilityState>& states);

struct StabilityOptions {
    std::vector<std::string> cases; ///< parts of names; empty: all
    Missing missing = Missing::nothing;
    bool list = false;
    OutputOptions output;
};

/// Runs the hard cases. Returns the exit status: 0 all pass, 1 one fails, 130 interrupted.
int stability(const StabilityOptions& options);

} // namespace cinch
