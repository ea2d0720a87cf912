// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "toolkit/simulate/field.hpp"

namespace cinch {

/// Lists of neighbours j of every simulation node i with d_ij and w_ij each, as in MeshlessBody. Views; own nothing.
struct NeighbourLists {
    std::span<const std::uint32_t> row, node;
    std::span<const double> record; ///< of 4: d_ij, w_ij
};

/// G_i = Σ_j (X_j − X_i) d_ijᵀ. The same bits on every target.
void gather_gradients(const NeighbourLists& lists, const Field& x, MatrixField& gradient) noexcept;

/// Its transpose: adds S_i d_ij − s_i w_ij (X_j − X_i) to f_j and takes it from f_i, so that what is added sums to
/// zero. S_i is the stress's share −v P, s_i a spring to every neighbour; no springs if they are empty.
void scatter_stresses(const NeighbourLists& lists, const MatrixField& stress, std::span<const double> spring,
                      const Field& x, Field& force) noexcept;

/// ½ Σ_ij s_i w_ij ‖X_j − X_i − G_i x_ij‖²; `offset` holds x_ij in records of 4.
double residual_energy(const NeighbourLists& lists, std::span<const double> offset, std::span<const double> spring,
                       const Field& x, const MatrixField& gradient) noexcept;

/// out_i += A_i B_i.
void add_matrix_products(const MatrixField& a, const MatrixField& b, MatrixField& out) noexcept;

} // namespace cinch
