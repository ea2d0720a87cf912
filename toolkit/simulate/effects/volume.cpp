// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/body_builder.hpp"
#include "toolkit/simulate/effects/effects.hpp"
#include "toolkit/simulate/effects/material.hpp"
#include "toolkit/simulate/effects/stress_effect.hpp"
#include "toolkit/simulate/json_fields.hpp"

namespace cinch {
namespace {

constexpr const char* volume_name = "volume";

struct VolumePreservation {
    static constexpr bool feels_plasticity = false; // plastic flow keeps the volume
    double stiffness;

    double density(std::size_t, const Mat3& h) const
    {
        const double d = volume_change(h);
        return 0.5 * stiffness * d * d;
    }
    void add_stress(std::size_t, const Mat3& h, Mat3& p) const
    {
        p += stiffness * volume_change(h) * (Mat3::Identity() + cofactor_change(h));
    }
    void add_curvature(std::size_t, const Mat3& f, Mat9& h) const
    {
        const auto c = stacked(cofactor(f));
        h += stiffness * c * c.transpose();
        add_cofactor_derivative(f, stiffness * (f.determinant() - 1), h);
    }
};

EffectPlan read_volume(JsonFields& f)
{
    const double stiffness = f.number("stiffness", JsonFields::not_negative());
    return {[stiffness](BodyBuilder& body) { body.add(make_volume(stiffness)); }};
}

} // namespace

namespace effects {
extern const EffectKind volume{volume_name, read_volume, R"json([{
    "description": "resists change of volume",
    "properties": {"stiffness": {"type": "number", "minimum": 0}},
    "required": ["stiffness"],
    "example": {"stiffness": 10}
}])json"};
}

std::unique_ptr<Effect> make_volume(double stiffness)
{
    return std::make_unique<StressEffect<VolumePreservation>>(volume_name, VolumePreservation{stiffness});
}

} // namespace cinch
