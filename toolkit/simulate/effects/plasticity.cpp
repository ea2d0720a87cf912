// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "toolkit/simulate/body_builder.hpp"
#include "toolkit/simulate/effects/effects.hpp"
#include "toolkit/simulate/effects/material.hpp"
#include "toolkit/simulate/json_fields.hpp"

namespace cinch {
namespace {

constexpr const char* plasticity_name = "plasticity";

class Plasticity : public Effect {
public:
    explicit Plasticity(const PlasticFlow& flow) : Effect(plasticity_name), flow_(flow) {}

    bool needs_deformation() const override { return true; }
    bool is_plastic() const override { return true; }
    void flow(const Configuration& c, double dt_s, std::vector<Mat3>& plastic_inverse) const override
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

EffectPlan read_plasticity(JsonFields& f)
{
    PlasticFlow flow;
    flow.yield = f.number("yield", JsonFields::not_negative());
    flow.creep = f.number("creep", JsonFields::not_negative());
    flow.most = f.number("most", JsonFields::not_negative(), 1);
    return {[flow](BodyBuilder& body) { body.add(make_plasticity(flow)); }};
}

} // namespace

namespace effects {
extern const EffectKind plasticity{plasticity_name, read_plasticity, R"json([{
    "description": "stays deformed",
    "properties": {
        "yield": {"type": "number", "minimum": 0, "description": "strain from which it flows"},
        "creep": {"type": "number", "minimum": 0, "description": "1/s"},
        "most": {"type": "number", "minimum": 0, "description": "strain that can stay [1]"}
    },
    "required": ["yield", "creep"],
    "example": {"yield": 0.1, "creep": 1, "most": 2}
}])json"};
}

std::unique_ptr<Effect> make_plasticity(const PlasticFlow& flow) { return std::make_unique<Plasticity>(flow); }

} // namespace cinch
