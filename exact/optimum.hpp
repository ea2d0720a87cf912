// SPDX-License-Identifier: GPL-3.0-or-later
// Internal to exact/.
#pragma once

#include <optional>
#include <vector>

#include <gmpxx.h>

#include "exact/number.hpp"
#include "toolkit/bounds/weight_space.hpp"

namespace cinch::exact {

/// max { Σ w_j b_j : w ∈ W' } with its proof: the corner attains the value, and D(λ) equals it, so nothing exceeds it.
struct Optimum {
    Exact value, lambda;
    std::vector<mpz_class> corner; ///< weights in units of 2^-corner_bits
    int corner_bits = 0;
};

/// Empty if W' is. Fills the weights greedily from l, largest b first, in integers; before it returns, the corner is
/// checked to lie in W', to attain the value, and to have no gap to D(λ) (CheckFailed otherwise, in every build).
std::optional<Optimum> optimum(WeightSpace space, const std::vector<Exact>& b);

} // namespace cinch::exact
