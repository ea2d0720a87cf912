// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "toolkit/deform/surface.hpp"
#include "toolkit/simulate/kernel/neighbour_kernel.hpp"
#include "toolkit/simulate/meshless_body.hpp"

namespace cinch {

/// Where the nodes of a body are, and what follows from it. A view: what effects see.
struct Configuration {
    const MeshlessBody& body;
    const DeformableSurface* surface;  ///< at rest; null where there is none
    const Field& x;                    ///< positions, m
    const MatrixField& gradient;       ///< G_i; empty unless an effect needs it
    const MatrixField& deformation;    ///< J_i: G_i, completed where its neighbours do not span space; the same object otherwise
    const std::vector<Mat3>& plastic_inverse; ///< F_p⁻¹ per node; empty without plasticity
    double time_s = 0;
};

/// Whether models without completion are to be seen (stability experiments break them on purpose).
enum class Completion { on, off };

NeighbourLists lists_of(const MeshlessBody& body);

/// J of the nodes of rank < 3 from G: what G leaves undetermined follows it rigidly (rank 2: the normal; rank 1: the least
/// rotation; rank 0: I), so that rotations stay free of strain. `deformation` holds G on entry.
void complete(const MeshlessBody& body, MatrixField& deformation, Completion completion = Completion::on);

/// The local second derivatives in G instead of J, for the nodes of rank < 3. A null direction n, carried to m = J n ⟂ G t_α, turns with
/// G: dm = −Σ_α g^α (m · dG t_α), g^α dual to G t_α. As isotropic stresses have P n ∥ m, the forces need no such term, but
/// H ← Lᵀ H L − p Mᵀ M does, with L: dG ↦ dJ, M: dG ↦ dm and p = m·P n. `stress` holds −v P, or nothing, for p = 0.
void complete_curvature(const MeshlessBody& body, const MatrixField& deformation, const MatrixField& stress, std::vector<Mat9>& local);

/// T_j of every node: A = J_j, t = X_j − J_j x_j. Moves a surface by Eq. 3.
std::vector<AffineMap> transforms(const MeshlessBody& body, const Field& x, const MatrixField& deformation);

} // namespace cinch
