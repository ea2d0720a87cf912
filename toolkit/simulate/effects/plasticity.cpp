// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "toolkit/simulate/effects/effects.hpp"
#include "toolkit/simulate/effects/material.hpp"

namespace cinch {
namespace {

class Plasticity : public Effect {
public:
    explicit Plasticity(const PlasticFlow& flow) : Effect("plasticity"), flow_(flow) {}

    bool needs_deformation() const override { return true; }
    void flow(const Configuration& c, double dt_s, std::vector<Mat3>& plastic_inverse) override
    {
        for (std::size_t i = 0; i < c.body.size(); ++i) {
            if (c.body.rank[i] < 3)
                continue; // the completion would turn with the flow
            const Mat3 f = matrix_at(c.deformation, i) * plastic_inverse[i];
            const Eigen::SelfAdjointEigenSolver<Mat3> squared(f.transpose() * f); // F_e = U Σ Vᵀ: Σ² and V
            // Collapsed directions count as strained by a factor of 1e-3, so that the logarithm exists.
            const Vec3 strain = 0.5 * squared.eigenvalues().cwiseMax(1e-6).array().log();
            const Vec3 deviator = strain.array() - strain.mean();
            const double size = deviator.norm();
            if (!(size > flow_.yield))
                continue;
            const double share = std::min(1.0, flow_.creep * dt_s) * (size - flow_.yield) / size;
            // F_p ← V exp(share · deviator) Vᵀ F_p: the trace is 0, so det F_p stays 1.
            const Mat3& v = squared.eigenvectors();
            const Mat3 inverse =
                plastic_inverse[i] * v * Vec3((-share * deviator).array().exp()).asDiagonal() * v.transpose();
            if (green_strain(inverse.inverse() - Mat3::Identity()).norm() <= flow_.most)
                plastic_inverse[i] = inverse / std::cbrt(inverse.determinant());
        }
    }

private:
    PlasticFlow flow_;
};

} // namespace

std::unique_ptr<Effect> make_plasticity(const PlasticFlow& flow) { return std::make_unique<Plasticity>(flow); }

} // namespace cinch
