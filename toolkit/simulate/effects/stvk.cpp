// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/effects/effects.hpp"
#include "toolkit/simulate/effects/material.hpp"
#include "toolkit/simulate/effects/stress_effect.hpp"

namespace cinch {
namespace {

// Ψ = λ/2 tr(ε)² + μ ‖ε‖², ε Green's strain.
struct StVenantKirchhoff {
    static constexpr bool feels_plasticity = true;
    double lambda, mu;

    StVenantKirchhoff(double young, double poisson, double factor)
    {
        const Lame l = lame(young, poisson);
        lambda = factor * l.lambda;
        mu = factor * l.mu;
    }
    Mat3 second_piola(const Mat3& h) const
    {
        const Mat3 e = green_strain(h);
        return 2 * mu * e + lambda * e.trace() * Mat3::Identity();
    }
    double density(std::size_t, const Mat3& h) const
    {
        const Mat3 e = green_strain(h);
        return mu * e.squaredNorm() + 0.5 * lambda * e.trace() * e.trace();
    }
    void add_stress(std::size_t, const Mat3& h, Mat3& p) const { p += (Mat3::Identity() + h) * second_piola(h); }
    void add_curvature(std::size_t, const Mat3& f, Mat9& h) const
    {
        add_second_piola_derivative(f, second_piola(f - Mat3::Identity()), lambda, mu, h);
    }
};

} // namespace

std::unique_ptr<Effect> make_stvk(double young, double poisson, bool paper_literal)
{
    return std::make_unique<StressEffect<StVenantKirchhoff>>(elastic_name,
                                                             StVenantKirchhoff(young, poisson, paper_literal ? 4 : 1));
}

} // namespace cinch
