// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "toolkit/simulate/body_forces.hpp"

namespace cinch {

/// What rounding leaves undecided of an implicit step at `c`; see ImplicitStep. The second derivatives must be
/// assembled.

/// J s², of E: `magnitude` is the sum of the magnitudes of its parts.
double rounding_of_energy(const BodyForces& forces, const Configuration& c, double magnitude, double dt_s);

/// m/s²: the greatest error that rounding may leave in an acceleration. Beside the stresses there are the springs to
/// neighbours, forces that depend on the place in the world (`held`, N/m, of every node), and the inertia, each with an
/// error of u of the lengths that it sees. `inertial`: displacements to which nodes would coast.
double rounding_of_acceleration(const BodyForces& forces, const Configuration& c, std::span<const double> held,
                                const Field& inertial, double dt_s);

/// m/s²: the greatest sum of the magnitudes of what single neighbours pull a node by, over its mass. Of the last
/// stresses and springs, as scatter_stresses() carries them.
double greatest_pull(const BodyForces& forces, const Field& u);

} // namespace cinch
