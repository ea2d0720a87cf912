// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>

#include "toolkit/bounds/weight_space.hpp"

namespace cinch::exact {

/// A double that claims to bound max { Σ w_j b_j : w ∈ W' }.
struct ClaimedBound {
    const char* name;
    double bound;
    bool has_lambda = false;
    double lambda = 0; ///< if so, it claims to be at least D(λ) too
};

/// Empty if every claim holds exactly, the exact ladder optimum ≤ Eq. 12 ≤ max b is in order and feasibility is
/// consistent; otherwise the first fault. Over an empty W' claims only have to be numbers. b and λ finite, 0 ≤ l ≤ h.
std::string space_fault(WeightSpace space, std::span<const double> b, std::span<const ClaimedBound> claims);

/// Empty if the optimum equals the best of all corners, listed one by one; otherwise the difference. For small n.
std::string corner_fault(WeightSpace space, std::span<const double> b);

} // namespace cinch::exact
