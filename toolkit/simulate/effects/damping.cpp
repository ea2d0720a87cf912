// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/body_builder.hpp"
#include "toolkit/simulate/effects/effects.hpp"
#include "toolkit/simulate/json_fields.hpp"

namespace cinch {
namespace {

constexpr const char* damping_name = "damping";

class MassDamping : public Effect {
public:
    explicit MassDamping(double rate) : Effect(damping_name), rate_(rate) {}

    bool dissipates() const override { return true; }
    void add_damping(const Configuration& c, Curvature out) const override
    {
        for (std::size_t i = 0; i < c.body.size(); ++i)
            out.block[i].diagonal().array() += rate_ * c.body.mass[i];
    }
    double energy(const Configuration& c) const override
    {
        double sum = 0;
        each_change(
            c, [&](std::size_t, double weight, const Vec3& change) { sum += 0.5 * weight * change.squaredNorm(); });
        return sum;
    }
    void add_forces(const Configuration& c, Forces out) const override
    {
        each_change(c, [&](std::size_t i, double weight, const Vec3& change) { at(out.force, i) -= weight * change; });
    }
    void add_curvature(const Configuration& c, Curvature out) const override
    {
        for (std::size_t i = 0; i < c.remembered().values.size() / 4; ++i)
            out.block[i].diagonal().array() += weight(c, i);
    }
    /// Displacements, and what they refer to.
    void remember(const Configuration& c, double dt_s, Memory& memory) const override
    {
        memory.values = c.u;
        memory.reference = c.reference;
        memory.interval_s = dt_s;
    }

private:
    double weight(const Configuration& c, std::size_t i) const
    {
        const double interval_s = c.remembered().interval_s;
        return interval_s > 0 ? rate_ * c.body.mass[i] / interval_s : 0;
    }

    // What every node has moved by since, whatever the two displacements refer to.
    template <class Visit> void each_change(const Configuration& c, const Visit& visit) const
    {
        const Memory& before = c.remembered();
        const Vec3 way = before.reference.way_to(c.reference);
        const Mat3 turn = c.reference.rotation - before.reference.rotation;
        for (std::size_t i = 0; i < before.values.size() / 4; ++i)
            visit(i, weight(c, i),
                  Vec3((at(c.u, i) - at(before.values, i)) + (turn * (c.body.rest[i] - c.reference.centre) + way)));
    }

    double rate_;
};

EffectPlan read_damping(JsonFields& f)
{
    const double rate = f.number("rate", JsonFields::not_negative());
    return {[rate](BodyBuilder& body) { body.add(make_mass_damping(rate)); }};
}

} // namespace

namespace effects {
extern const EffectKind damping{damping_name, read_damping, R"json([{
    "description": "slows down all motion",
    "properties": {"rate": {"type": "number", "minimum": 0, "description": "1/s"}},
    "required": ["rate"],
    "example": {"rate": 1}
}])json"};
}

std::unique_ptr<Effect> make_mass_damping(double rate) { return std::make_unique<MassDamping>(rate); }

} // namespace cinch
