// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "cinch/bvh.hpp"

namespace cinch {

/// D(λ) = λ + Σ_j [ l_j (b_j − λ) + (h_j − l_j) max(b_j − λ, 0) ] ≥ max { Σ w_j b_j : w ∈ W' } for *every* λ (weak
/// duality). Proven: at least the exact D(λ) of the doubles given; +∞ if anything overflows. Never NaN.
double dual_bound(WeightSpace space, std::span<const double> b, double lambda, Rounding rounding) noexcept;

/// The λ whose D(λ) is the paper's Eq. 12: the second-largest b, or b itself where there is only one.
double second_largest(std::span<const double> b) noexcept;

/// The λ that minimises D up to rounding, making it the exact optimum over W': the smallest b_m with
/// Σ_{b_j > b_m} (h_j − l_j) ≤ 1 − Σ l. Weighted quickselect, O(n) on average. `scratch` is overwritten.
/// The first form takes pairs (b_j, h_j − l_j), which it reorders, at least one, and 1 − Σ l.
template <class T> T best_lambda(std::span<std::pair<T, T>> extremum_and_range, T slack) noexcept;
double best_lambda(WeightSpace space, std::span<const double> b, std::vector<std::pair<double, double>>& scratch);

} // namespace cinch
