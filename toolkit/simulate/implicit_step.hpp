// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "toolkit/simulate/body_simulation.hpp"

namespace cinch {

/// Implicit Euler as an optimisation: the next positions minimise
/// E(X) = ½ ‖X − X̃‖²_M + Δt² U(X), X̃ = X_n + Δt v_n, by Newton's method with a line search, each step by conjugate gradients
/// without a matrix, preconditioned by 3×3 blocks. Hessians are made positive semidefinite only where CG meets negative curvature.
class ImplicitStep {
public:
    ImplicitStep(BodySimulation& body, const Integration& integration);
    void advance(double dt_s, double longest_s, StepReport& report);

private:
    struct Objective {
        double value, magnitude; ///< E, and the sum of the magnitudes of its parts, for rounding
    };
    bool step_without_gain(double to_s, int depth, StepReport& report);
    bool step(double dt, StepReport& report);
    Objective objective(const Field& x, double time, double dt);
    void gradient(const Configuration& c, double dt, Field& out);
    void precondition(const Configuration& c, double dt);
    double rounding_of(const Objective& e, double dt) const;
    void project();
    bool solve(const Configuration& c, double dt, double reduction, StepReport& report); ///< false: negative curvature

    BodySimulation& b_;
    const Integration& integration_;
    Field inertial_, gradient_, direction_, residual_, conjugate_, product_, scaled_;
    std::vector<Mat3> inverse_block_;
};

} // namespace cinch
