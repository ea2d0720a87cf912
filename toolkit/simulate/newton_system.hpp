// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "toolkit/simulate/body_forces.hpp"

namespace cinch {

/// (M + Δt² K) p = −g, K the second derivatives that BodyForces assembled last: solved by conjugate gradients without a
/// matrix, preconditioned by 3×3 blocks and, for free bodies, by rigid motions, which stiff materials hide from the
/// blocks.
class NewtonSystem {
public:
    explicit NewtonSystem(BodyForces& forces);

    /// Makes the preconditioner, for nodes at `c`. After every assembly and projection.
    void precondition(const Configuration& c, double dt_s);
    /// Until the residual, measured by the preconditioner, is less by the factor `reduction`. False, with a direction
    /// that is of no use, where the matrix curves down. `products`: is raised by those with K.
    bool solve(const Configuration& c, double dt_s, const Field& gradient, double reduction, Field& direction,
               int& products);

    /// N/m of every node, of forces that depend on where it is in the world; of the last precondition().
    const std::vector<double>& held() const { return held_; }
    double mass() const { return mass_; } ///< kg, of the body

private:
    void find_rigid_motions(const Configuration& c);
    void apply_preconditioner();

    const BodyModel& model_;
    BodyForces& forces_;
    Field residual_, conjugate_, product_, scaled_;
    std::vector<Mat3> inverse_block_;
    std::vector<double> held_;
    Field arm_; ///< from the centre of mass; empty where pins hold the body
    Mat3 inverse_inertia_ = Mat3::Zero();
    double mass_ = 0;
};

} // namespace cinch
