// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "toolkit/simulate/integration.hpp"
#include "toolkit/simulate/newton_system.hpp"

namespace cinch {

/// Implicit Euler as an optimisation: the next positions minimise
/// E(X) = ½ ‖X − X̃‖²_M + Δt² U(X), X̃ = X_n + Δt v_n, by Newton's method with a line search, each step by conjugate
/// gradients without a matrix (NewtonSystem). Hessians are made positive semidefinite only where CG meets negative
/// curvature.
///
/// When it is solved. The residual r = max_i ‖∇E_i‖ / (m_i Δt²) is the error of an acceleration. It is measured against
/// the accelerations of the step itself, a = max_i of ‖X_i − X̃_i‖ / Δt², of ‖f_i‖ / m_i of every single effect, and of
/// ‖f_i‖ / m_i of all stresses together; so nothing depends on the units of a scene, nor on how fast a body moves as a
/// whole. The step is done where r ≤ tolerance · a.
///
/// What rounding leaves. Displacements u_i from a reference that moves along with the body are stored, so that the
/// error of J_k is not u ‖J_k‖ (u = 2⁻⁵³) but, with the rounding of the u_j themselves and of the sums over n_k
/// neighbours, at most e_k = (n_k/2 + 8) u Σ_j ‖d_kj‖ (‖u_j‖ + ‖u_k‖), and that of a stress, in whose 32 operations no
/// parts cancel, ‖∂P/∂J‖ (e_k + 32 u ‖H_k‖) (and 32 u more after plastic flow, whose F_p⁻¹ is no small change).
/// rounding_of_acceleration() carries these to the nodes: no iteration gets further than that. If r no longer falls
/// there, the reference is fitted to the iterate, which makes the u_i as small as they can be, and once more. What then
/// is left is accepted only where nothing but such errors happens:
/// - r is less than 2⁻³² of the forces inside the body, the pulls of single neighbours: a body strained and at rest,
/// whose forces balance;
/// - the greatest acceleration, r included, moves no node by a rounding of the body's size in the step: what has come
/// to rest;
/// - all accelerations and pulls are below that bound, and no effect from outside has a force above 2⁻³² r: what is at
/// rest. Everything else is a failure: residual and what it was to be are reported, and the state stays that before it.
class ImplicitStep {
public:
    /// Of that state, which after a failure is anything.
    ImplicitStep(BodyForces& forces, BodyState& state, const Integration& integration);
    void advance(double dt_s, double longest_s, StepReport& report);

private:
    struct Objective {
        double value, magnitude; ///< E, and the sum of the magnitudes of its parts, for rounding
    };
    /// Accelerations, m/s², at an iterate: the greatest error of one; the greatest; the greatest of a single effect's
    /// force on nodes, of effects that act from outside.
    struct Accelerations {
        double residual = 0, greatest = 0, applied = 0;
    };
    bool step_without_gain(double to_s, int depth, StepReport& report);
    bool step(double dt, const Field& rigid, StepReport& report);
    Field follow(double dt);
    Field begin(double dt, const Field& rigid, Objective& e);
    Objective objective(const Field& u, double time, double dt);
    Accelerations gradient(const Configuration& c, double dt, Field& out);
    std::string find_direction(const Configuration& c, double dt, double reduction, StepReport& report);

    const BodyModel& model_;
    BodyForces& forces_;
    BodyState& state_;
    const Integration& integration_;
    NewtonSystem system_;
    Field inertial_, gradient_, direction_;
    bool projected_ = false; ///< in this step, since the last iteration that went all its way
    double size_ = 0;        ///< m, of the body
};

} // namespace cinch
