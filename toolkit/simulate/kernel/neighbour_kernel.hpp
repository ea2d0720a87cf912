// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "toolkit/simulate/field.hpp"

namespace cinch {

/// Lists of neighbours j of every simulation node i with a vector d_ij each, as in MeshlessBody. Views; own nothing.
struct NeighbourLists {
    std::span<const std::uint32_t> row, node;
    std::span<const double> d; ///< records of 4, the last one free for the kernel's own use
};

/// G_i = Σ_j (X_j − X_i) d_ijᵀ. The same bits on every target.
void gather_gradients(const NeighbourLists& lists, const Field& x, MatrixField& gradient) noexcept;

/// Its transpose: adds S_i d_ij to f_j and takes it from f_i, so that what is added sums to zero. S_i is the force's share −v P.
void scatter_stresses(const NeighbourLists& lists, const MatrixField& stress, Field& force) noexcept;

/// With c_ij in the fourth place of the record of x_ij: for the residual r_ij = X_j − X_i − G_i x_ij adds −c_ij r_ij to f_j and
/// +c_ij r_ij to f_i. Returns ½ Σ c_ij ‖r_ij‖².
double scatter_residuals(const NeighbourLists& offsets, const Field& x, const MatrixField& gradient, Field& force) noexcept;

} // namespace cinch
