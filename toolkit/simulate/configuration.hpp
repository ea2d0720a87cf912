// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cinch/surface.hpp"
#include "toolkit/simulate/kernel/neighbour_kernel.hpp"
#include "toolkit/simulate/memory.hpp"
#include "toolkit/simulate/meshless_body.hpp"

namespace cinch {

/// Where the nodes of a body are, and what follows from it. A view: what effects see. Vectors have the world's axes,
/// points are seen from the reference's origin.
struct Configuration {
    const MeshlessBody& body;
    const DeformableSurface* surface; ///< at rest; null where there is none
    const Reference& reference;
    const Field& x; ///< positions, m, from the reference's origin: R (x_i − c) + u_i
    const Field& u; ///< displacements from the reference, m
    const MatrixField&
        gradient; ///< D_i = Σ_j (u_j − u_i) d_ijᵀ; empty, as those that follow, unless an effect needs it
    const MatrixField&
        strain; ///< H_i = Rᵀ J_i − I, but not as that difference: Rᵀ D_i, completed where neighbours do not span space
    const MatrixField& deformation;           ///< J_i = R (I + H_i)
    const std::vector<Mat3>& plastic_inverse; ///< F_p⁻¹ per node; empty without plasticity
    double time_s = 0;
    Vec3 datum = Vec3::Zero();           ///< from the reference's origin: where the energy of a uniform force is 0
    std::span<const Memory> memory = {}; ///< of all effects
    std::size_t effect = 0;              ///< which of them sees this

    /// What the effect that sees this remembers; nothing where there is no memory.
    const Memory& remembered() const
    {
        static const Memory nothing;
        return effect < memory.size() ? memory[effect] : nothing;
    }
};

/// Whether models without completion are to be seen (stability experiments break them on purpose).
enum class Completion { on, off };

/// The least rotation from f, of length 1, to the direction of f + a, less I. With the axis v = f × g, g that
/// direction, and cosine c: [v] + [v]² / (1 + c). 0 where there is no direction.
Mat3 rotation_change(const Vec3& f, const Vec3& a);

NeighbourLists lists_of(const MeshlessBody& body);

/// D, H and J of displacements u from a shape at rest that is turned by `rotation`. Isolated nodes have J = I.
void measure(const MeshlessBody& body, const Mat3& rotation, const Field& u, Completion completion,
             MatrixField& gradient, MatrixField& strain, MatrixField& deformation);

/// H of the nodes of rank < 3 from its part in the directions that their neighbours span: what these leave undetermined
/// follows rigidly (rank 2: the normal; rank 1: the least rotation), so that rotations stay free of strain. As
/// everywhere, no difference of what is nearly equal is taken: the error is relative to H.
void complete(const MeshlessBody& body, MatrixField& strain, Completion completion = Completion::on);

/// The local second derivatives in G instead of J, for the nodes of rank < 3. A null direction n, carried to m = J n ⟂
/// G t_α, turns with G: dm = −Σ_α g^α (m · dG t_α), g^α dual to G t_α. As isotropic stresses have P n ∥ m, the forces
/// need no such term, but H ← Lᵀ H L − p Mᵀ M does, with L: dG ↦ dJ, M: dG ↦ dm and p = m·P n. `stress` holds −v P, or
/// nothing, for p = 0.
void complete_curvature(const MeshlessBody& body, const MatrixField& deformation, const MatrixField& stress,
                        std::vector<Mat9>& local);

/// T_j of every node: A = J_j, t = X_j − J_j x_j, seen from the point `from` of the world. Moves a surface by Eq. 3.
std::vector<AffineMap> transforms(const MeshlessBody& body, const Reference& reference, const Field& u,
                                  const MatrixField& deformation, const Vec3& from);

} // namespace cinch
