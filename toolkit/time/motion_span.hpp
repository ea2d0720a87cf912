// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "cinch/bvh.hpp"
#include "toolkit/time/motion_interval.hpp"

namespace cinch {

/// Intervals in a row, each beginning where the one before it ends.
using Intervals = std::span<const std::shared_ptr<const MotionInterval>>;

/// How simulation nodes move during several intervals in a row, from t_0 over t_1, … to t_n, by their maps at t_0 and
/// t_n alone. With τ = (t − t_0)/(t_n − t_0), for every vertex v, every direction γ and all t of [t_0, t_n]
///   γ·v(t) ≤ (1 − τ) γ·v(t_0) + τ γ·v(t_n) + 4τ(1 − τ) Σ_j w_j rise_j + Σ_j w_j bump_j.
struct MotionSpan {
    /// Of simulation node j along direction d of axes_of(k), at j·k + d, in the unit of the surface, ≥ 0:
    std::vector<double> rise; ///< at every t_i and rest vertex, γ·(T_j(t_i) − chord(t_i)) ≤ 4τ_i(1 − τ_i) rise_j
    std::vector<double> bump;  ///< ≥ −(D²/8) γ·x″(t) in every interval, D its length
    std::vector<double> error; ///< ≥ that of every interval's limits
};

/// What follows from the intervals, two or more, for the rest vertices in the boxes of the BVH's root, `kdop`
/// directions. Infinite where it is not finite. For intervals without morph targets.
MotionSpan motion_span(Intervals intervals, const Bvh& bvh, int kdop);

} // namespace cinch
