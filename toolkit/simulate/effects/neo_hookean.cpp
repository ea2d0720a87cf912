// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "toolkit/simulate/effects/effects.hpp"
#include "toolkit/simulate/effects/material.hpp"
#include "toolkit/simulate/effects/stress_effect.hpp"
#include "toolkit/simulate/kernel/neo_hookean_kernel.hpp"

namespace cinch {
namespace {

// x − log(1 + x), with an error relative to x²: of log(1 + x) = 2 artanh s, s = x / (2 + x), the first term leaves
// x² / (2 + x). For |x| < 1/4, s² < 1/49, the terms that are left out are less than u of the first.
double less_log(double x)
{
    if (std::abs(x) >= 0.25)
        return x - std::log1p(x);
    const double s = x / (2 + x), q = s * s;
    double sum = 0;
    for (int k = 21; k >= 3; k -= 2)
        sum = sum * q + 1.0 / k;
    return x * x / (2 + x) - 2 * s * q * sum;
}

// Ψ = μ/2 (I − 3) + λ/2 (det F − α)² − μ/2 log(I + 1), I = ‖F‖², less its value at rest, with μ = 4/3 μ_Lamé,
// λ = λ_Lamé + 5/6 μ_Lamé, which give Hooke's law for small strains, and α = 1 + 3 μ / (4 λ), which makes I
// stress-free. λ > 0 for every ν in (−1, 0.5): it is E (5 + 2ν) / (12 (1 + ν) (1 − 2ν)).
struct NeoHookean {
    static constexpr bool feels_plasticity = true;
    double mu, lambda, alpha;

    NeoHookean(double young, double poisson)
    {
        const Lame l = lame(young, poisson);
        mu = 4.0 / 3 * l.mu;
        lambda = l.lambda + 5.0 / 6 * l.mu;
        alpha = 1 + 0.75 * mu / lambda;
    }
    // With F = I + H, δ = I − 3 and j = det F − 1: 3/8 μ (δ − 2j) + μ/2 (δ/4 − log(1 + δ/4)) + λ/2 j², and in δ − 2j
    // the terms of first order have cancelled, so that small strains lose no digits: the error is relative to ‖H‖².
    double density(std::size_t, const Mat3& h) const
    {
        const double trace = h.trace(), minors = cofactor(h).trace(), third = h.determinant();
        const double delta = 2 * trace + h.squaredNorm(), j = trace + minors + third;
        return 0.375 * mu * (h.squaredNorm() - 2 * minors - 2 * third) + 0.5 * mu * less_log(0.25 * delta) +
               0.5 * lambda * j * j;
    }
    // As in the kernel.
    void add_stress(std::size_t, const Mat3& h, Mat3& p) const
    {
        const double delta = 2 * h.trace() + h.squaredNorm();
        const Mat3 c = cofactor_change(h), f = Mat3::Identity() + h;
        p += 0.75 * mu * (h - c) + mu * delta / (4 * (4 + delta)) * f +
             lambda * volume_change(h) * (Mat3::Identity() + c);
    }
    void add_all_stresses(const Configuration& c, MatrixField& stress) const
    {
        add_neo_hookean_stress(mu, lambda, c.body.volume, c.reference.rotation, c.strain, stress);
    }
    void add_curvature(std::size_t, const Mat3& f, Mat9& h) const
    {
        const double i = f.squaredNorm() + 1;
        const auto c = stacked(cofactor(f)), v = stacked(f);
        h.diagonal().array() += mu * (1 - 1 / i);
        h += (2 * mu / (i * i)) * v * v.transpose() + lambda * c * c.transpose();
        add_cofactor_derivative(f, lambda * (f.determinant() - alpha), h);
    }
};

} // namespace

std::unique_ptr<Effect> make_neo_hookean(double young, double poisson)
{
    return std::make_unique<StressEffect<NeoHookean>>(elastic_name, NeoHookean(young, poisson));
}

} // namespace cinch
