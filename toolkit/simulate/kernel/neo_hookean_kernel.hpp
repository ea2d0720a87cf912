// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "toolkit/simulate/field.hpp"

namespace cinch {

/// S_i −= v_i R P(H_i) for all nodes, P = μ (1 − 1/(‖F‖² + 1)) F + λ (det F − α) cof F at F = I + H, the stress of
/// neo_hookean.cpp, nodes in SIMD lanes. With C = cof F − I, j = det F − 1 and δ = ‖F‖² − 3, of which none is computed
/// as that difference, P = ¾ μ (H − C) + μ δ / (4 (4 + δ)) F + λ j cof F: the error is relative to H. The same bits on
/// every target.
void add_neo_hookean_stress(double mu, double lambda, std::span<const double> volume, const Mat3& rotation,
                            const MatrixField& strain, MatrixField& stress) noexcept;

} // namespace cinch
