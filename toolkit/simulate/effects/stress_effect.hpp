// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "toolkit/simulate/effect.hpp"

namespace cinch {

/// An effect whose energy is a density of the deformation of every node: Σ v_i Ψ(J_i), or Σ v_i Ψ(J_i F_p⁻¹) where
/// `Law` feels plasticity. Law has density(i, H), add_stress(i, H, P) and add_curvature(i, F, ∂P/∂F), in Pa, at F = I +
/// H; the first two with errors relative to H, and P as the reference is turned. A law that lags behind has remember(c,
/// Δt, memory), and after(memory): the law with these members that holds until it remembers again.
template <class Law> class StressEffect : public Effect {
public:
    StressEffect(const char* name, Law law) : Effect(name), law_(std::move(law)) {}

    bool needs_deformation() const override { return true; }
    double energy(const Configuration& c) const override
    {
        const auto& law = now(c);
        double sum = 0;
        for (std::size_t i = 0; i < c.body.size(); ++i)
            if (c.body.rank[i] > 0)
                sum += c.body.volume[i] * law.density(i, strain(c, i));
        return sum;
    }
    void add_forces(const Configuration& c, Forces out) const override
    {
        if constexpr (requires { law_.add_all_stresses(c, out.stress); })
            if (!plastic(c) && c.body.deficient.empty())
                return law_.add_all_stresses(c, out.stress);
        const auto& law = now(c);
        for (std::size_t i = 0; i < c.body.size(); ++i) {
            if (c.body.rank[i] == 0)
                continue;
            Mat3 p = Mat3::Zero();
            law.add_stress(i, strain(c, i), p);
            if (plastic(c))
                p *= c.plastic_inverse[i].transpose();
            matrix_at(out.stress, i) -= c.body.volume[i] * (c.reference.rotation * p);
        }
    }
    void add_curvature(const Configuration& c, Curvature out) const override
    {
        const auto& law = now(c);
        for (std::size_t i = 0; i < c.body.size(); ++i) {
            if (c.body.rank[i] == 0)
                continue;
            Mat9 h = Mat9::Zero();
            law.add_curvature(i, elastic(c, i), h);
            if (plastic(c)) {
                Mat9 l = Mat9::Zero(); // stacked(dJ F_p⁻¹) = l stacked(dJ)
                for (int r = 0; r < 3; ++r)
                    for (int s = 0; s < 3; ++s)
                        l.block<3, 3>(3 * r, 3 * s).diagonal().setConstant(c.plastic_inverse[i](s, r));
                h = l.transpose() * h * l;
            }
            out.local[i] += c.body.volume[i] * h;
        }
    }
    bool dissipates() const override
    {
        return requires { law_.viscosity; };
    }
    void add_damping(const Configuration& c, Curvature out) const override
    {
        if constexpr (requires(Mat9 & h) { law_.add_damping(Mat3(), h); })
            for (std::size_t i = 0; i < c.body.size(); ++i) {
                Mat9 h = Mat9::Zero();
                law_.add_damping(matrix_at(c.deformation, i), h);
                out.local[i] += c.body.volume[i] * h;
            }
    }
    void remember(const Configuration& c, double dt_s, Memory& memory) const override
    {
        if constexpr (requires { law_.remember(c, dt_s, memory); })
            law_.remember(c, dt_s, memory);
    }

private:
    decltype(auto) now(const Configuration& c) const
    {
        if constexpr (requires { law_.after(c.remembered()); })
            return law_.after(c.remembered());
        else
            return (law_); // a reference
    }
    static bool plastic(const Configuration& c) { return Law::feels_plasticity && !c.plastic_inverse.empty(); }
    static Mat3 elastic(const Configuration& c, std::size_t i)
    {
        const Mat3 j = matrix_at(c.deformation, i);
        return plastic(c) ? Mat3(j * c.plastic_inverse[i]) : j;
    }

    static Mat3 strain(const Configuration& c, std::size_t i) // Rᵀ F − I
    {
        const Mat3 h = matrix_at(c.strain, i);
        return plastic(c) ? Mat3(h * c.plastic_inverse[i] + (c.plastic_inverse[i] - Mat3::Identity())) : h;
    }

    Law law_;
};

} // namespace cinch
