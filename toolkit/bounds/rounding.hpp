// SPDX-License-Identifier: Apache-2.0
#pragma once

// The error terms that make double results proven upper bounds in the default rounding mode (surface/arithmetic.hpp).
// Notation:
//   u = 2^-53, η = 2^-1074, γ_k = ku/(1 − ku), fl(·) round to nearest even.
// Facts used: fl(x∘y) = (x∘y)(1 + δ) + ε with |δ| ≤ u, and ε = 0 for + and −, |ε| ≤ η/2 for ×; a sum of leaves that
// each pass at most k roundings is within γ_k Σ|leaf| of the exact sum, in any order of summation [Higham, ch. 3].

// Where the room is. Every term adds up worst cases that do not meet: all roundings of one sign and of their full size,
// on leaves of one sign, at the node of greatest magnitude. Of what they allow, a search for the worst transforms,
// boxes and weights used 0.28 for evaluation_error (few roundings, little added), 0.05 to 0.11 for the kernels (their
// constant is nearly twice its derivation, which in turn counts 27 roundings of up to N for values that are mostly
// below N), and 0.004 for the sphere (n + 32 roundings on a sum of leaves that is n times what any one of them passes,
// thrice). All of it is unproven room: nothing relies on it, and none may be taken away without a derivation.

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

namespace cinch {

inline constexpr double unit_roundoff = 0x1p-53;
inline constexpr double smallest_subnormal = 0x1p-1074;
inline constexpr double infinite = std::numeric_limits<double>::infinity();

template <class T> inline constexpr T unit_roundoff_of = sizeof(T) == 4 ? T(0x1p-24) : T(0x1p-53);
template <class T> inline constexpr T smallest_subnormal_of = sizeof(T) == 4 ? T(0x1p-149) : T(0x1p-1074);

/// n·η for n up to 2^23 in float, 2^52 in double: the bits of a subnormal number count η. A product would take a
/// processor longer than a whole BV of few simulation nodes.
template <class T> inline T smallest_times(std::size_t n) noexcept
{
    return std::bit_cast<T>(static_cast<std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>>(n));
}

/// At least the next T above x, for every finite x: fl(x + fl(fl(φ|x|) + η)), φ = u(1 + 2u)
/// [Rump, Zimmermann, Boldo, Melquiond 2009]. At most two steps up. So fl(a + b) ≤ succ(fl(a + b)) bounds a + b
/// exactly.
template <class T> inline T succ(T x) noexcept
{
    constexpr T phi = unit_roundoff_of<T> * (1 + 2 * unit_roundoff_of<T>);
    return x + (phi * std::abs(x) + smallest_subnormal_of<T>);
}

/// The least T that is at least x, and the greatest that is at most x, for doubles x; ±∞ past the greatest number.
template <class T> inline T round_up(double x) noexcept
{
    const T t = static_cast<T>(x);
    return static_cast<double>(t) >= x ? t : std::nextafter(t, std::numeric_limits<T>::infinity());
}
template <class T> inline T round_down(double x) noexcept
{
    const T t = static_cast<T>(x);
    return static_cast<double>(t) <= x ? t : std::nextafter(t, -std::numeric_limits<T>::infinity());
}

/// max over the nodes of a bound on |b̂_j − b_j|: the extremum of a box c ± e along an axis is computed as
///   g = Aᵀγ,  p = ((g₁c₁ + g₂c₂) + g₃c₃) + γ·t,  R = (|g₁|e₁ + |g₂|e₂) + |g₃|e₃,  b̂ = ±p + R.
/// A leaf A_rs c_s passes 2 (g) + 1 (×) + 2 (sum of three) + 1 (+ τ) + 1 (+ R) = 7 roundings, A_rs e_s 6, t_r 4, so
/// |b̂ − b| ≤ γ₇M + 6·(η/2)(1 + u)⁴ with M = Σ_s Σ_r |γ_r A_rs|(|c_s| + e_s) + Σ_r |γ_r t_r|. M̂ is computed from
/// non-negative leaves with ≤ 7 roundings (2 for the sum over r, 1 for |c| + e, 1 for ×, 3 for the sum), M ≤ M̂/(1 − γ₇)
/// + 3η, and γ₇/(1 − γ₇) < 8u. 10u·M̂ + 16η leaves room for its own two roundings.
inline double extremum_error(double largest_magnitude) noexcept
{
    return succ(10 * unit_roundoff * largest_magnitude + 16 * smallest_subnormal);
}

/// Bound on |computed vertex − exact vertex| along an axis, for a vertex of at most `influences` simulation nodes:
/// a leaf w·A_rs·x_s passes 1 (×) + 3 (sums) + 1 (×w) + n_k − 1 (sum over nodes) = n_k + 4 roundings and Σw = 1, so the
/// error is ≤ γ_{n_k+4} max_j M_j plus, per node and each of ≤ 3 coordinates, 4 products of η/2: 6 n_k η. (n_k + 8)u·M̂
/// + 8 n_k η covers γ's higher order (n_k < 2²⁰), M ≤ M̂/(1 − γ₇) and its own roundings.
inline double evaluation_error(double influences, double largest_magnitude) noexcept
{
    return succ((influences + 8) * unit_roundoff * largest_magnitude +
                smallest_times<double>(8 * static_cast<std::size_t>(influences)));
}

/// Bound on the rounding of T̂ = Σ fl(w·fl(b̂ − λ)) over n nodes, given Â, the sum of the absolute values computed
/// likewise: a term passes 1 (−) + 1 (×) + n − 1 (sum) = n + 1 roundings and n products lose ≤ η/2 each. Exact Σ|·| ≤
/// Â/(1 − γ_{n+1}) + nη/2, and γ_{n+1}/(1 − γ_{n+1}) < (n + 2)u for n < 6·10⁷; (n + 4)u·Â + nη leaves room for its own
/// two roundings.
inline double sum_error(double nodes, double absolute_sum) noexcept
{
    return succ((nodes + 4) * unit_roundoff * absolute_sum + smallest_times<double>(static_cast<std::size_t>(nodes)));
}

// The kernels (kernel/bound_kernel.hpp) work in T = float or double with unit roundoff u_T, on projected maps q, θ and
// rest data rounded outward, relative to a reference map q̄, θ̄ = Σ m_j (q_j, θ_j) (zero for the kinds without one). Let
//   N_j ≥ Σ_s a_s X_s + a_3,   a_s = Σ_r |γ_r A_rs|,   a_3 = Σ_r |γ_r d_r|,   X_s ≥ |x_s − o_s| over every box,
// and N its maximum over the BV's nodes; |q̄_s|, |θ̄| are at most 1.01 times their maxima, since Σm = 1 and sums of T's
// are within 1/100.
//   stored q, θ: 2 and 3 double roundings of sums of ≤ 3, and one to T: 3u N;
//   b̂ = (dq·c + dθ) ± |dq|·e with dq = q − q̄: 1 (difference) + 3 (fma) + 1 roundings on ≤ N + 1.01 N: γ₅·2.01 N < 10.3u
//   N; or by rows, 1 (difference) + 1 (product) + 1 (±) + 2 (sum of four), the same; over an oriented box |q·a_1| +
//   |q·a_2| + |q·a_3| instead: 3 + 2 roundings, and a in T is off by u|a|: γ₇N + 3uN, X taking in Σ|a|; reference: q̄·z
//   + θ̄, |z| ≤ X, 3 roundings on ≤ 1.01 N; and the points' q̄·y, |y| ≤ 2X, 3 on ≤ 2.02 N, or the box's q̄·(c − z) +
//   |q̄|·e, |c − z| + e ≤ 2X, 1 (difference) + 3 (fma) + 1 roundings on the same: 13.2u N. The slack has its own
//   rounding in it, and sums of these are rounded up.
// Together less than 27u N; 48u N leaves room for the rounding of N itself, a few u of it, and nearly as much again.
// Products underflow by ≤ η/2, at most 64 per node and coordinate, those of q with X up to X·η: 128η(1 + ΣX).

inline constexpr double kernel_error_constant = 48;
/// Where N_j is at most this, no sum of fewer than 2²⁰ terms of the kernels overflows.
template <class T>
inline constexpr double magnitude_limit = static_cast<double>(std::numeric_limits<T>::max()) * 0x1p-24;

/// What the kernels may lose on one simulation node, evaluation of vertices aside, is at most
///   node_rounding·N_j + node_underflow·(1 + ΣX) + 4·lost,   lost the error of d beyond u|d|
/// (kernel/project_kernel.cpp).
template <class T>
inline constexpr double node_rounding = kernel_error_constant* static_cast<double>(unit_roundoff_of<T>);
template <class T> inline constexpr double node_underflow = 128 * static_cast<double>(smallest_subnormal_of<T>);

/// The kernels add in 8 virtual lanes, node j in lane j mod 8, and then in a tree: a term of n passes at most this many
/// roundings.
inline double sum_depth(std::size_t nodes) noexcept { return std::ceil(static_cast<double>(nodes) / 8) + 3; }
/// Those that take nodes one by one add alternately into two sums.
inline double row_depth(std::size_t nodes) noexcept { return std::ceil(static_cast<double>(nodes) / 2) + 1; }

/// The kernels' Σ l·a + Σ r·max(a, 0), a = fl(b̂ − λ), is off by at most factor·(width + fl Σ r·max(a, 0)) + underflow,
/// width the computed max |a|: the greatest b̂ − λ and λ + the greatest b̂ against the axis bound it, as b̂₊ ≥ p ≥ −b̂₋ and
/// rounding is monotonic. A term passes 1 (−) + m (sum, `depth`) + 1 (+) roundings, Σ l ≤ 1, exact Σ r·max(a, 0) ≤
/// computed/(1 − γ_{m+1}) + nη: γ_{m+2}/(1 − γ_{m+1}) < (1.02m + 3)u for m·u ≤ 1/200; 5u are left for its own
/// roundings.
template <class T> inline T dual_sum_factor(double depth) noexcept
{
    return static_cast<T>((1.02 * depth + 8) * static_cast<double>(unit_roundoff_of<T>));
}
template <class T> inline T dual_sum_underflow(std::size_t nodes) noexcept { return smallest_times<T>(2 * nodes); }
/// Most simulation nodes of a BV for the kernels in float, so that m·u ≤ 1/200 here, and less than 1/100 above.
inline constexpr std::size_t most_nodes_in_float = 65536;
/// And in double: the n_k < 2²⁰ and the fewer than 2²⁰ terms above.
inline constexpr std::size_t most_nodes_in_double = (std::size_t{1} << 20) - 1;

/// By how much a BV of the linear kind multiplies its nodes' errors. With m = row_depth, κ = Σ_jΣ_i|g_ji| max|y_i| +
/// Σ_j residual_j + Σ_j max_i moment_ji/X_i, and |dq·x + dθ| ≤ 2.01 N:
///   q̄ against Σ m q: (m + 1)u N; P = dq·z + dθ: 4 roundings, 9u N κ; the sums over the nodes of P·g, residual·|P| and
///   moment·|dq|, and of the last three: (m + 3)u·2.01 N κ each; support of q̄ + ΣP g, its own sum counted: 6 roundings
///   on ≤ (3.03 + 4.02κ) N.
/// Together ≤ ((m + 42) + κ(6.03m + 53))u N, in units of 48u N.
/// Products: 6 per node and coordinate lose ≤ η/2 each, over the 128η that a node's error has: n/16 more.
/// Infinite from κ = 2²⁰ on: below that products with q̄ + ΣP g are at most (2.02 + 2.01κ)N < 2²² magnitude_limit and do
/// not overflow. (The map itself may, where a box is thin; then ‖q‖·slack is no number, and the bound infinite.)
inline double linear_error_factor(std::size_t nodes, double kappa) noexcept
{
    if (!(kappa < 0x1p20))
        return infinite;
    return 1 + static_cast<double>(nodes) / 16 +
           (row_depth(nodes) + kappa * (6.5 * row_depth(nodes) + 53)) / kernel_error_constant;
}

/// What the rest data of a BV of the kind moments reaches, lengths along coordinate i in units of X_i.
struct MomentReach {
    double gradient[3], place[3];  ///< Σ_j |f_js|, and greatest |z_js|; they have no unit
    double row[4][3];              ///< of each of the rows that make g_0, g_1, g_2 and φ of the columns of G
    double first[3], second[3];    ///< greatest |d_s|/σ + |ξ_s − d_s/σ| of points and slack, and |N_is| over i
    double d, centre, lever, half; ///< greatest |d_i|, |c_i|, σ|z_i|/2 + |y_i|, and half of a node's box
};

/// By how much a BV of the kind moments multiplies its nodes' errors. The identity holds for the numbers q̄, G, g and φ
/// as they are computed; what is lost is in what comes of them. In units of 2.01N, 1.03 for the roundings of the
/// numbers themselves: Σ_i |G_is| X_i ≤ Γ_s = Σ_j|f_js|, |g_s| ≤ Σ_a Γ_a row_sa, |φ| likewise, |G z| ≤ W = Σ_s Γ_s
/// place_s, and φ + g·z at most W₃. Then
///   b̂_j: 3 (fma) + 2 (σz/2 − y) + 1 (×) + 1 (fma) + 1 (±) + 2 (sum of four) = 10 roundings on 1 + W lever + W₃ + (1 +
///   W) half;
///   points and slack: 1 (l) + 4 (fma) + 2 (sum of four) = 7 on 1.01N d + 2.01N Σ_s(|g_s| first_s + Γ_s second_s);
///   q̄·c + θ̄: 3 on 1.01N max(1, centre);  stored q, θ: 3u N. Sums of these are rounded up.
/// Products: 12 of G z, which then meet σz/2 − y or e, 16 of each point and of the slack, 11 and 4 others lose ≤ η/2
/// each: (12(1 + lever + half) + 47) η (1 + ΣX)/2, in units of 128η(1 + ΣX).
/// Infinite from 2¹⁶ on: below that, what kernels check besides aside, no product overflows.
inline double moment_error_factor(const MomentReach& of) noexcept
{
    double w = 0, w3 = 0, points = 0;
    for (std::size_t s = 0; s < 4; ++s) {
        double own = 0; // g_s, φ
        for (std::size_t a = 0; a < 3; ++a)
            own += 1.03 * of.gradient[a] * of.row[s][a];
        w3 += own * (s < 3 ? of.place[s] : 1);
        if (s < 3) {
            w += 1.03 * of.gradient[s] * of.place[s];
            points += own * of.first[s] + 1.03 * of.gradient[s] * of.second[s];
        }
    }
    const double nodes = 2.01 * (1 + w * of.lever + w3 + (1 + w) * of.half),
                 factor = 1 +
                          (3 + 4.1 * std::fmax(1, of.centre) + 8.1 * (1.01 * of.d + 2.01 * points) + 10.1 * nodes) /
                              kernel_error_constant +
                          (12 * (1 + of.lever + of.half) + 48) / 256;
    return factor < 0x1p16 ? factor : infinite;
}

} // namespace cinch
