// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "toolkit/bounds/weight_space.hpp"

namespace cinch::exact {

/// Exact values for one row of extrema b over W', as fractions "p/q" in lowest terms, q > 0.
struct Answer {
    std::string maximum;             ///< max { Σ w_j b_j : w ∈ W' }
    std::optional<std::string> eq12; ///< the paper's Eq. 12 over all n, D at the second-largest b; none for n = 1
    std::string lambda;              ///< D(λ) = maximum: nothing exceeds it
    std::vector<std::string> corner; ///< w ∈ W' that attains it
    bool bound_holds = false;        ///< the toolkit's double bound, passed in, is at least the maximum
};

/// Empty if W' is. b finite. Checked against its own certificate before it is returned.
std::optional<Answer> answer(WeightSpace space, std::span<const double> b, double bound);

} // namespace cinch::exact
