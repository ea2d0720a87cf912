// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "toolkit/deform/weights.hpp"
#include "toolkit/surface/triangle_mesh.hpp"

namespace cinch {

/// v_k = Σ_j w_kj (A_j v⁰_k + t_j) (Eq. 3) in double. This is *the* computed vertex: its operations and their order are fixed
/// (per node and coordinate ((a₀x + a₁y) + a₂z) + t, times w, summed in the order of the row; no fused operations), every
/// caller gets the same bits, and the bounds are proven to contain it. Non-finite maps give non-finite coordinates.
Vec3 evaluate_vertex(const Vec3& rest, Weights::Row row, std::span<const AffineMap> maps) noexcept;

/// All vertices, in parallel; the same bits for every thread count. `out` has one place per vertex. Throws std::runtime_error
/// for a changed floating-point environment (arithmetic.hpp).
void evaluate(std::span<const Vec3> rest, const Weights& weights, std::span<const AffineMap> maps, std::span<Vec3> out);

} // namespace cinch
