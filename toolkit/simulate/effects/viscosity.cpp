// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/effects/effects.hpp"
#include "toolkit/simulate/effects/material.hpp"
#include "toolkit/simulate/effects/stress_effect.hpp"
#include "toolkit/simulate/stream.hpp"

namespace cinch {
namespace {

// S = η (ε − ε_before) / Δt. An explicit integrator remembers after its forces, so that its rate is that of the last
// step; an implicit one before it solves, so that its rate is that of the step to come.
struct KelvinVoigt {
    static constexpr bool feels_plasticity = false;
    double viscosity;
    std::vector<double> before = {}; ///< 9 per node; empty until something was remembered
    double interval_s = 0;

    double rate() const { return interval_s > 0 ? viscosity / interval_s : 0; }
    Mat3 change(std::size_t i, const Mat3& h) const
    {
        return before.empty() ? Mat3::Zero() : Mat3(green_strain(h) - Eigen::Map<const Mat3>(before.data() + 9 * i));
    }

    double density(std::size_t i, const Mat3& h) const { return 0.5 * rate() * change(i, h).squaredNorm(); }
    void add_stress(std::size_t i, const Mat3& h, Mat3& p) const
    {
        p += rate() * (Mat3::Identity() + h) * change(i, h);
    }
    void add_curvature(std::size_t i, const Mat3& f, Mat9& h) const
    {
        if (!before.empty())
            add_second_piola_derivative(f, rate() * change(i, f - Mat3::Identity()), 0, 0.5 * rate(), h);
    }
    void add_damping(const Mat3& f, Mat9& h) const
    {
        add_second_piola_derivative(f, Mat3::Zero(), 0, 0.5 * viscosity, h);
    }
    void remember(const Configuration& c, double dt_s)
    {
        before.resize(9 * c.body.size());
        interval_s = dt_s;
        for (std::size_t i = 0; i < c.body.size(); ++i)
            Eigen::Map<Mat3>(before.data() + 9 * i) = green_strain(matrix_at(c.strain, i));
    }
    void save(std::ostream& out) const
    {
        write_list(out, before);
        write_raw<double>(out, {&interval_s, 1});
    }
    void restore(std::istream& in)
    {
        read_list(in, before);
        read_raw<double>(in, {&interval_s, 1});
    }
};

class MassDamping : public Effect {
public:
    explicit MassDamping(double rate) : Effect("damping"), rate_(rate) {}

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
        for (std::size_t i = 0; i < before_.size() / 4; ++i)
            out.block[i].diagonal().array() += weight(c, i);
    }
    void remember(const Configuration& c, double dt_s) override
    {
        before_ = c.u;
        reference_ = c.reference;
        interval_s_ = dt_s;
    }
    void save(std::ostream& out) const override
    {
        write_list(out, before_);
        reference_.save(out);
        write_raw<double>(out, {&interval_s_, 1});
    }
    void restore(std::istream& in) override
    {
        read_list(in, before_);
        reference_.restore(in);
        read_raw<double>(in, {&interval_s_, 1});
    }

private:
    double weight(const Configuration& c, std::size_t i) const
    {
        return interval_s_ > 0 ? rate_ * c.body.mass[i] / interval_s_ : 0;
    }

    // What every node has moved by since, whatever the two displacements refer to.
    template <class Visit> void each_change(const Configuration& c, const Visit& visit) const
    {
        const Vec3 way = reference_.way_to(c.reference);
        const Mat3 turn = c.reference.rotation - reference_.rotation;
        for (std::size_t i = 0; i < before_.size() / 4; ++i)
            visit(i, weight(c, i),
                  Vec3((at(c.u, i) - at(before_, i)) + (turn * (c.body.rest[i] - c.reference.centre) + way)));
    }

    double rate_, interval_s_ = 0;
    Field before_;        ///< displacements
    Reference reference_; ///< from this
};

} // namespace

std::unique_ptr<Effect> make_viscosity(double viscosity)
{
    return std::make_unique<StressEffect<KelvinVoigt>>("viscosity", KelvinVoigt{viscosity});
}
std::unique_ptr<Effect> make_mass_damping(double rate) { return std::make_unique<MassDamping>(rate); }

} // namespace cinch
