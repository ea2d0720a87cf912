// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/body_builder.hpp"
#include "toolkit/simulate/effects/effects.hpp"
#include "toolkit/simulate/json_fields.hpp"

namespace cinch {
namespace {

constexpr const char* gravity_name = "gravity";

class Gravity : public Effect {
public:
    explicit Gravity(const Vec3& acceleration) : Effect(gravity_name), acceleration_(acceleration) {}

    // Of displacements, and of the reference as a whole: what a step compares are displacements, and their energy is
    // not to drown in that of where they are.
    double energy(const Configuration& c) const override
    {
        Vec3 moved = Vec3::Zero(), rest = Vec3::Zero();
        double mass = 0;
        for (std::size_t i = 0; i < c.body.size(); ++i) {
            moved += c.body.mass[i] * at(c.u, i);
            rest += c.body.mass[i] * (c.body.rest[i] - c.reference.centre);
            mass += c.body.mass[i];
        }
        return -acceleration_.dot(moved) - acceleration_.dot(c.reference.rotation * rest - mass * c.datum);
    }
    void add_forces(const Configuration& c, Forces out) const override
    {
        for (std::size_t i = 0; i < c.body.size(); ++i)
            at(out.force, i) += c.body.mass[i] * acceleration_;
    }

private:
    Vec3 acceleration_;
};

EffectPlan read_gravity(JsonFields& f)
{
    const Vec3 acceleration = f.vector("acceleration", Vec3(0, 0, -9.81));
    return {[acceleration](BodyBuilder& body) { body.add(make_gravity(acceleration)); }};
}

} // namespace

namespace effects {
extern const EffectKind gravity{gravity_name, read_gravity, R"json([{
    "description": "a force m g",
    "properties": {"acceleration": {"$ref": "#/$defs/vector", "description": "m/s2 [0, 0, -9.81]"}},
    "example": {"acceleration": [0, 0, -1]}
}])json"};
}

std::unique_ptr<Effect> make_gravity(const Vec3& acceleration) { return std::make_unique<Gravity>(acceleration); }

} // namespace cinch
