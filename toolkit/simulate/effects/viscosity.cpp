// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/body_builder.hpp"
#include "toolkit/simulate/effects/effects.hpp"
#include "toolkit/simulate/effects/material.hpp"
#include "toolkit/simulate/effects/stress_effect.hpp"
#include "toolkit/simulate/json_fields.hpp"

namespace cinch {
namespace {

constexpr const char* viscosity_name = "viscosity";

// S = η (ε − ε_before) / Δt. An explicit integrator remembers after its forces, so that its rate is that of the last
// step; an implicit one before it solves, so that its rate is that of the step to come.
struct StrainRate {
    const Memory& before; ///< 9 values of ε per node; none until something was remembered
    double scale;         ///< η / Δt, Pa

    Mat3 change(std::size_t i, const Mat3& h) const
    {
        if (before.values.empty())
            return Mat3::Zero();
        return green_strain(h) - Eigen::Map<const Mat3>(before.values.data() + 9 * i);
    }
    double density(std::size_t i, const Mat3& h) const { return 0.5 * scale * change(i, h).squaredNorm(); }
    void add_stress(std::size_t i, const Mat3& h, Mat3& p) const { p += scale * (Mat3::Identity() + h) * change(i, h); }
    void add_curvature(std::size_t i, const Mat3& f, Mat9& h) const
    {
        if (!before.values.empty())
            add_second_piola_derivative(f, scale * change(i, f - Mat3::Identity()), 0, 0.5 * scale, h);
    }
};

struct KelvinVoigt {
    static constexpr bool feels_plasticity = false;
    double viscosity;

    StrainRate after(const Memory& before) const
    {
        return {before, before.interval_s > 0 ? viscosity / before.interval_s : 0};
    }
    void add_damping(const Mat3& f, Mat9& h) const
    {
        add_second_piola_derivative(f, Mat3::Zero(), 0, 0.5 * viscosity, h);
    }
    void remember(const Configuration& c, double dt_s, Memory& memory) const
    {
        memory.values.resize(9 * c.body.size());
        memory.interval_s = dt_s;
        for (std::size_t i = 0; i < c.body.size(); ++i)
            Eigen::Map<Mat3>(memory.values.data() + 9 * i) = green_strain(matrix_at(c.strain, i));
    }
};

EffectPlan read_viscosity(JsonFields& f)
{
    const double viscosity = f.number("viscosity", JsonFields::not_negative());
    return {[viscosity](BodyBuilder& body) { body.add(make_viscosity(viscosity)); }};
}

} // namespace

namespace effects {
extern const EffectKind viscosity{viscosity_name, read_viscosity, R"json([{
    "description": "stress against the rate of strain (Kelvin-Voigt)",
    "properties": {"viscosity": {"type": "number", "minimum": 0, "description": "Pa s"}},
    "required": ["viscosity"],
    "example": {"viscosity": 2}
}])json"};
}

std::unique_ptr<Effect> make_viscosity(double viscosity)
{
    return std::make_unique<StressEffect<KelvinVoigt>>(viscosity_name, KelvinVoigt{viscosity});
}

} // namespace cinch
