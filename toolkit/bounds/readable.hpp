// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "cinch/bvh.hpp"

namespace cinch {

/// The kinds that `best` chooses among, as their formulas, in doubles as they come: what the kernels do fast, in other
/// orders, over data that is rounded outward, and with their errors on top. Each gives 2·axes.size() supports, place 2a
/// along axis a and 2a + 1 against it. `x` are the rest vertices. Maps are finite; there is at least one simulation
/// node. `start`: λ lies at mean b + start·(greatest b − mean b), the mean weighted by r = h − l (the greatest b where
/// every r is 0).

/// D(λ) of the extrema b_j of γ·(A_j x + t_j) over each simulation node's own rest box, cut by its ball; never more
/// than the greatest b.
void readable_local(const RestBv& bv, std::span<const AffineMap> maps, double start, std::span<const Axis> axes,
                    std::span<double> supports);

/// The support of the mean map over the rest vertices, and D(λ) of the extrema of what each map differs from it over
/// the node's box.
void readable_support(const RestBv& bv, std::span<const Vec3> x, std::span<const AffineMap> maps, double start,
                      std::span<const Axis> axes, std::span<double> supports);

/// The affine model of the weights: w_j = m_j + g_j·y + ρ_j, y = x − z, |ρ_j| ≤ residual_j, |(w_j − m_j) y| ≤ moment_j.
///   γ·v = q̄·x + θ̄ + Σ_j (w_j − m_j)(dq_j·x + dθ_j)
///       = q̄·z + θ̄ + (q̄ + Σ_j P_j g_j)·y + Σ_j ρ_j P_j + Σ_j (w_j − m_j) dq_j·y,   P_j = dq_j·z + dθ_j,  dq_j = q_j −
///       q̄,
/// so the support of q̄ + Σ P_j g_j over y, Σ residual_j |P_j|, and Σ |dq_j|·moment_j.
void readable_linear(const RestBv& bv, std::span<const Vec3> x, std::span<const AffineMap> maps,
                     std::span<const Axis> axes, std::span<double> supports);

} // namespace cinch
