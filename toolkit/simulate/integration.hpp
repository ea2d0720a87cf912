// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "toolkit/simulate/configuration.hpp"

namespace cinch {

/// How a body is moved through time.
struct Integration {
    enum class Method { explicit_euler, implicit_euler };
    Method method = Method::implicit_euler;
    double step_s = 1.0 / 60; ///< of the implicit integrator; of the explicit one the longest substep
    double safety = 0.6;      ///< explicit: share of the longest stable substep
    double tolerance =
        1e-5; ///< implicit: greatest error of an acceleration that is left, over the greatest one (ImplicitStep)
    int most_iterations = 200; ///< implicit: of Newton's method
    bool project =
        true; ///< implicit: make the Hessian positive semidefinite where it proves not to be (off only in experiments)
    Completion completion = Completion::on;
    bool (*cancelled)() = nullptr; ///< asked between steps; a cancelled call fails, and keeps the state before it
};

/// What a step did.
struct StepReport {
    double dt_s = 0;
    int substeps = 0, iterations = 0, products = 0; ///< Newton iterations; products with the Hessian
    int halved = 0;                                 ///< steps that were taken back and made in halves
    int projected = 0;                              ///< iterations that needed a positive semidefinite Hessian
    double residual =
        0; ///< m/s², of the last step: the greatest error of an acceleration; 0 for the explicit integrator
    double acceleration = 0; ///< m/s², of the last step: what the tolerance was relative to
    bool at_rounding =
        false; ///< the residual is what rounding leaves of forces inside the body that balance (ImplicitStep)
    double kinetic = 0, potential = 0; ///< J, at the end
    double seconds = 0;                ///< of wall time
    std::string failure;               ///< why it could not be made; the state is that before it
};

} // namespace cinch
