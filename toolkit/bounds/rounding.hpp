// SPDX-License-Identifier: Apache-2.0
#pragma once

// The error terms that make double results proven upper bounds in the default rounding mode (deform/arithmetic.hpp). Notation:
//   u = 2^-53, η = 2^-1074, γ_k = ku/(1 − ku), fl(·) round to nearest even.
// Facts used: fl(x∘y) = (x∘y)(1 + δ) + ε with |δ| ≤ u, and ε = 0 for + and −, |ε| ≤ η/2 for ×; a sum of leaves that each
// pass at most k roundings is within γ_k Σ|leaf| of the exact sum, in any order of summation [Higham, ch. 3].

#include <cmath>
#include <limits>

namespace cinch {

inline constexpr double unit_roundoff = 0x1p-53;
inline constexpr double smallest_subnormal = 0x1p-1074;
inline constexpr double infinite = std::numeric_limits<double>::infinity();

/// At least the next double above x, for every finite x: fl(x + fl(fl(φ|x|) + η)), φ = u(1 + 2u)
/// [Rump, Zimmermann, Boldo, Melquiond 2009]. At most two steps up. So fl(a + b) ≤ succ(fl(a + b)) bounds a + b exactly.
inline double succ(double x) noexcept
{
    constexpr double phi = unit_roundoff * (1 + 2 * unit_roundoff);
    return x + (phi * std::abs(x) + smallest_subnormal);
}

/// max over the nodes of a bound on |b̂_j − b_j|: the extremum of a box c ± e along an axis is computed as
///   g = Aᵀγ,  p = ((g₁c₁ + g₂c₂) + g₃c₃) + γ·t,  R = (|g₁|e₁ + |g₂|e₂) + |g₃|e₃,  b̂ = ±p + R.
/// A leaf A_rs c_s passes 2 (g) + 1 (×) + 2 (sum of three) + 1 (+ τ) + 1 (+ R) = 7 roundings, A_rs e_s 6, t_r 4, so
/// |b̂ − b| ≤ γ₇M + 6·(η/2)(1 + u)⁴ with M = Σ_s Σ_r |γ_r A_rs|(|c_s| + e_s) + Σ_r |γ_r t_r|. M̂ is computed from non-negative
/// leaves with ≤ 7 roundings (2 for the sum over r, 1 for |c| + e, 1 for ×, 3 for the sum), M ≤ M̂/(1 − γ₇) + 3η, and
/// γ₇/(1 − γ₇) < 8u. 10u·M̂ + 16η leaves room for its own two roundings. [models: checked in exact arithmetic]
inline double extremum_error(double largest_magnitude) noexcept
{
    return succ(10 * unit_roundoff * largest_magnitude + 16 * smallest_subnormal);
}

/// Bound on |computed vertex − exact vertex| along an axis, for a vertex of at most `influences` simulation nodes:
/// a leaf w·A_rs·x_s passes 1 (×) + 3 (sums) + 1 (×w) + n_k − 1 (sum over nodes) = n_k + 4 roundings and Σw = 1, so the
/// error is ≤ γ_{n_k+4} max_j M_j plus, per node and each of ≤ 3 coordinates, 4 products of η/2: 6 n_k η. (n_k + 8)u·M̂ + 8 n_k η
/// covers γ's higher order (n_k < 2²⁰), M ≤ M̂/(1 − γ₇) and its own roundings.
inline double evaluation_error(double influences, double largest_magnitude) noexcept
{
    return succ((influences + 8) * unit_roundoff * largest_magnitude + 8 * influences * smallest_subnormal);
}

/// Bound on the rounding of T̂ = Σ fl(w·fl(b̂ − λ)) over n nodes, given Â, the sum of the absolute values computed likewise:
/// a term passes 1 (−) + 1 (×) + n − 1 (sum) = n + 1 roundings and n products lose ≤ η/2 each. Exact Σ|·| ≤ Â/(1 − γ_{n+1}) + nη/2,
/// and γ_{n+1}/(1 − γ_{n+1}) < (n + 2)u for n < 6·10⁷; (n + 4)u·Â + nη leaves room for its own two roundings.
inline double sum_error(double nodes, double absolute_sum) noexcept
{
    return succ((nodes + 4) * unit_roundoff * absolute_sum + nodes * smallest_subnormal);
}

} // namespace cinch
