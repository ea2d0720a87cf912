// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

namespace cinch {

/// 2^-53. Dyadic weights are integer multiples of it: doubles in [0, 1] whose partial sums up to 1 are all exact,
/// and so are h − l and 1 − Σ l.
inline constexpr double weight_unit = 0x1p-53;

/// Scales finite weights ≥ 0 with a positive sum so that they sum to exactly 1, each a multiple of 2^-bits: the real
/// quotient rounded down, the missing units going to the largest remainders. Within (n + 2)·2^-bits of the real
/// quotient; weights that are already dyadic with sum 1 come back unchanged. Weights far below 2^-bits of the sum
/// become 0. bits ≤ 53.
void round_dyadic(std::span<double> weights, int bits = 53);

} // namespace cinch
