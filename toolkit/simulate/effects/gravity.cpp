// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/effects/effects.hpp"

namespace cinch {
namespace {

class Gravity : public Effect {
public:
    explicit Gravity(const Vec3& acceleration) : Effect("gravity"), acceleration_(acceleration) {}

    double energy(const Configuration& c) const override
    {
        double sum = 0;
        for (std::size_t i = 0; i < c.body.size(); ++i)
            sum -= c.body.mass[i] * acceleration_.dot(at(c.x, i) - c.datum);
        return sum;
    }
    void add_forces(const Configuration& c, Forces out) const override
    {
        for (std::size_t i = 0; i < c.body.size(); ++i)
            at(out.force, i) += c.body.mass[i] * acceleration_;
    }

private:
    Vec3 acceleration_;
};

} // namespace

std::unique_ptr<Effect> make_gravity(const Vec3& acceleration) { return std::make_unique<Gravity>(acceleration); }

} // namespace cinch
