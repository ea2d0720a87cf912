// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "toolkit/simulate/meshless_body.hpp"

namespace cinch {

/// One substep of symplectic Euler under gravity, a stable neo-Hookean material and hourglass control, as one would
/// write it with Eigen from the formulas alone, effect by effect: what the toolkit's step is checked against, and timed
/// against.
class PlainBody {
public:
    PlainBody(const MeshlessBody& body, const Vec3& gravity, double young, double poisson, double hourglass);
    void step(double dt_s);

    std::vector<Vec3> x, v;

private:
    const MeshlessBody& body_;
    Vec3 gravity_;
    double mu_, lambda_, alpha_;
    std::vector<double> stiffness_; ///< of hourglass control, per neighbour
    std::vector<Vec3> d_, offset_, force_;
    std::vector<Mat3> f_;
};

} // namespace cinch
