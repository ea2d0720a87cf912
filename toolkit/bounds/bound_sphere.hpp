// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "cinch/bounds.hpp"
#include "toolkit/bounds/weight_space.hpp"
#include "toolkit/surface/skin.hpp"

namespace cinch {

/// One simulation node's part in a BV's accumulated-deformation sphere. With x its rest place and w, v over the BV's
/// vertices:
struct SphereInfluence {
    std::uint32_t node = 0;
    double mean = 0;            ///< w̄; Σ w̄ = 1 exactly
    Vec3 moment = Vec3::Zero(); ///< ȳ ≈ mean of w (v − x)
    double weight_spread = 0;   ///< ≥ |w − w̄|
    double moment_spread = 0;   ///< ≥ ‖w (v − x) − ȳ‖
};

/// Rest sphere of a BV. A view; owns nothing.
struct RestSphere {
    Vec3 centre;
    double radius;
    std::span<const SphereInfluence> influence;
};

/// The BD-tree bound [James, Pai 2004] applied to v = x + Σ w_j (u_j + G_j (x − x_j)), u_j = T_j x_j − x_j, G_j = A_j −
/// I: a reconstruction of the sphere tree of Adams et al. 2005 that the paper compares with, whose own formula is not
/// to be had. Centre c + Σ (w̄ u + G ȳ), radius R + Σ (ΔW‖u‖ + ΔY‖G‖): the terms of the nodes accumulate, and it is not
/// invariant under rigid motion. `place` holds every simulation node's x_j. Supports as bound_box; proven likewise.
void bound_sphere(const RestSphere& bv, std::span<const Vec3> place, std::span<const AffineMap> maps,
                  double vertex_influences, Rounding rounding, std::span<const Axis> axes,
                  std::span<double> supports) noexcept;

} // namespace cinch
