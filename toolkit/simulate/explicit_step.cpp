// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/explicit_step.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cinch {

// Of M⁻¹K (or M⁻¹C) on the nodes that move, by magnitude; 10 per cent up, as a power iteration comes from below. It
// begins where the last one ended, with a tenth of noise, so that modes that are new have a share.
double ExplicitStep::greatest_eigenvalue(const Configuration& c, int iterations, bool stiffness)
{
    const std::size_t n = model_.body.size();
    Field& mode = state_.slow_mode;
    const bool fresh = mode.size() != 4 * n;
    if (fresh) {
        mode.assign(4 * n, 0);
        iterations *= 10;
    }
    double size = fresh ? 1 : whole(mode).norm();
    if (!(size > 0) || !std::isfinite(size))
        size = 1;
    for (std::size_t i = 0; i < 4 * n; ++i) {
        const double noise = i % 4 == 3 ? 0 : std::sin(0.7 + 12.9898 * static_cast<double>(i % 1009));
        const double share = fresh ? 1 : 0.1 / std::sqrt(static_cast<double>(3 * n));
        mode[i] = (std::isfinite(mode[i]) ? mode[i] / size : 0) + share * noise;
    }
    double value = 0;
    Field product(4 * n);
    for (int k = 0; k < iterations; ++k) {
        model_.zero_pinned(mode);
        double mass = 0;
        for (std::size_t i = 0; i < n; ++i)
            mass += model_.body.mass[i] * at(mode, i).squaredNorm();
        if (!(mass > 0))
            return 0;
        whole(mode) /= std::sqrt(mass);
        std::fill(product.begin(), product.end(), 0);
        if (stiffness)
            forces_.add_product(c, mode, product);
        else
            forces_.add_local_product(mode, product);
        model_.zero_pinned(product);
        double next = 0;
        for (std::size_t i = 0; i < n; ++i) {
            const Vec3 image = -at(product, i) / model_.body.mass[i];
            next += model_.body.mass[i] * image.squaredNorm();
            at(product, i) = image;
        }
        value =
            std::max(value, std::sqrt(next)); // ‖M⁻¹K mode‖ in the norm in which the mode is 1; at most the eigenvalue
        if (!(next > 0) || !std::isfinite(next))
            return std::isfinite(next) ? 1.1 * value : std::numeric_limits<double>::infinity();
        mode = product;
    }
    return 1.1 * value;
}

double ExplicitStep::longest_stable()
{
    const Configuration c = forces_.configure(state_, state_.u, state_.time_s);
    forces_.assemble(c, BodyForces::Parts::stiffness);
    const double squared = greatest_eigenvalue(c, 4, true);
    double damping = 0;
    if (std::any_of(model_.effects.begin(), model_.effects.end(),
                    [](const auto& effect) { return effect->dissipates() || effect->couples_nodes(); })) {
        forces_.assemble(c, BodyForces::Parts::damping);
        const Field mode = state_.slow_mode;
        damping = greatest_eigenvalue(c, 16, false);
        state_.slow_mode = mode;
    }
    const double divisor = damping + std::sqrt(damping * damping + 4 * squared);
    return divisor > 0 ? 4 / divisor : std::numeric_limits<double>::infinity();
}

void ExplicitStep::advance(double dt_s, double longest_s, StepReport& report)
{
    constexpr int between_estimates = 100; // some ten periods of the fastest mode
    double done = 0;
    double stable = longest_stable(), cap = longest_s;
    while (done < dt_s) {
        if (integration_.cancelled && integration_.cancelled()) {
            report.failure = "cancelled";
            return;
        }
        // What remains is cut into equal substeps, so that the last one is no splinter.
        const double pieces = std::ceil((dt_s - done) / std::min(integration_.safety * stable, cap) * (1 - 1e-12));
        if (!(pieces >= 1) || pieces > 1e7) {
            report.failure = "no stable substep: the material is too stiff, or the state has broken down";
            return;
        }
        const double dt = (dt_s - done) / pieces;
        const int run = static_cast<int>(std::min<double>(pieces, between_estimates));
        const BodyState before = state_;
        bool short_enough = true;
        for (int s = 0; s < run && short_enough; ++s)
            short_enough = substep(dt);
        const bool finite = whole(state_.u).allFinite() && whole(state_.v).allFinite();
        stable = finite ? longest_stable() : 0;
        // Where they lead, these steps are too long: take them back.
        if ((!(dt <= 0.95 * stable) || !short_enough) && dt > 1e-7 * dt_s) {
            const double too_long = dt;
            Field mode =
                finite ? std::move(state_.slow_mode) : before.slow_mode; // what it found of the fastest mode stays true
            state_ = before;
            state_.slow_mode = std::move(mode);
            cap = std::min(cap, 0.4 * too_long);
            stable = longest_stable();
            ++report.halved;
            continue;
        }
        if (!finite) {
            report.failure = "positions are no longer finite";
            return;
        }
        cap = std::min(longest_s, 1.5 * cap);
        report.substeps += run;
        done = run == static_cast<int>(pieces) ? dt_s : done + dt * run;
    }
}

bool ExplicitStep::substep(double dt)
{
    const std::size_t n = model_.body.size();
    const Configuration c = forces_.configure(state_, state_.u, state_.time_s);
    force_.assign(4 * n, 0);
    forces_.add(c, force_);
    forces_.begin_step(c, dt, state_);
    for (std::size_t i = 0; i < n; ++i) {
        if (model_.pinned[i])
            continue;
        at(state_.v, i) += dt / model_.body.mass[i] * at(force_, i);
        at(state_.u, i) += dt * at(state_.v, i);
    }
    const double before = state_.time_s;
    state_.time_s += dt;
    forces_.end_step(before, dt, state_);
    return forces_.allow(c, dt);
}

} // namespace cinch
