// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "toolkit/simulate/effect.hpp"

namespace cinch {

/// A point of a body's surface, Σ_c share_c v_c over the corners of a triangle, that belongs in front of a plane.
struct Contact {
    std::array<std::uint32_t, 3> corner{};
    std::array<double, 3> share{};  ///< ≥ 0, sum 1
    std::array<double, 3> normal{}; ///< of length 1
    double offset = 0;              ///< the plane is normal·x = offset, m, seen from the origin given with it
    double stiffness = 0;           ///< k, N/m
};

/// Planes that push points of one body back: ½ k d² at depth d behind. ContactSearch finds them anew before every
/// frame: they are what the effect remembers.
class BodyContact final : public Effect {
public:
    BodyContact();
    /// `origin`: from where the planes are seen, m.
    static Memory remembering(std::span<const Contact> contacts, const Vec3& origin);

    bool needs_deformation() const override { return true; }
    double energy(const Configuration& c) const override;
    void add_forces(const Configuration& c, Forces out) const override;
    bool couples_nodes() const override { return true; }
    void find_touching(const Configuration& c, bool worst, std::vector<Touch>& touching) const override;
    void add_product(const Configuration& c, std::span<const Touch> touching, const Field& dx, const MatrixField& dj,
                     Forces out) const override;
    void add_diagonal(const Configuration& c, std::span<const Touch> touching, std::vector<Mat3>& block) const override;
    double longest_step(const Configuration& c) const override;
};

} // namespace cinch
