// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "toolkit/simulate/body_forces.hpp"
#include "toolkit/simulate/integration.hpp"

namespace cinch {

/// Symplectic Euler: v += Δt f(x)/m, then x += Δt v, in substeps that a power iteration finds stable where they begin
/// and where they end; those that are not are taken back and made shorter.
class ExplicitStep {
public:
    /// Of that state, which after a failure is anything.
    ExplicitStep(BodyForces& forces, BodyState& state, const Integration& integration)
        : model_(forces.model()), forces_(forces), state_(state), integration_(integration)
    {
    }
    void advance(double dt_s, double longest_s, StepReport& report);

    /// The longest stable substep from here, s: ω² Δt² + 2 c Δt ≤ 4 with ω² and c the greatest eigenvalues of M⁻¹K and
    /// M⁻¹C (damping acts on the velocity of the step before). +∞ if nothing restores or resists.
    double longest_stable();

private:
    bool substep(double dt); ///< false: it was too long for what it met
    double greatest_eigenvalue(const Configuration& c, int iterations, bool stiffness);

    const BodyModel& model_;
    BodyForces& forces_;
    BodyState& state_;
    const Integration& integration_;
    Field force_;
};

} // namespace cinch
