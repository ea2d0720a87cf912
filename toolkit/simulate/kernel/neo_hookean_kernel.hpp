// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "toolkit/simulate/field.hpp"

namespace cinch {

/// S_i −= v_i (μ (1 − 1/(‖F‖² + 1)) F + λ (det F − α) cof F) at F = J_i, for all nodes: the stress of neo_hookean.cpp, nodes in
/// SIMD lanes. The same bits on every target.
void add_neo_hookean_stress(double mu, double lambda, double alpha, std::span<const double> volume, const MatrixField& deformation,
                            MatrixField& stress) noexcept;

} // namespace cinch
