// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/explicit_step.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace cinch {

// Of M⁻¹K (or M⁻¹C) on the nodes that move, by magnitude; 10 per cent up, as a power iteration comes from below. It
// begins where the last one ended, with a tenth of noise, so that modes that are new have a share.
double ExplicitStep::greatest_eigenvalue(const Configuration& c, int iterations, bool stiffness)
{
    const std::size_t n = b_.body_.size();
    Field& mode = b_.slow_mode_;
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
        mode[i] = (std::isfinite(mode[i]) ? mode[i] / size : 0) +
                  (fresh ? 1 : 0.1 / std::sqrt(static_cast<double>(3 * n))) * noise;
    }
    double value = 0;
    Field product(4 * n);
    for (int k = 0; k < iterations; ++k) {
        b_.zero_pinned(mode);
        double mass = 0;
        for (std::size_t i = 0; i < n; ++i)
            mass += b_.body_.mass[i] * at(mode, i).squaredNorm();
        if (!(mass > 0))
            return 0;
        whole(mode) /= std::sqrt(mass);
        std::fill(product.begin(), product.end(), 0);
        if (stiffness)
            b_.add_product(c, mode, product);
        else
            b_.add_local_product(mode, product);
        b_.zero_pinned(product);
        double next = 0;
        for (std::size_t i = 0; i < n; ++i) {
            const Vec3 image = -at(product, i) / b_.body_.mass[i];
            next += b_.body_.mass[i] * image.squaredNorm();
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

double ExplicitStep::longest_stable(const Configuration& c)
{
    b_.assemble(c, BodySimulation::Parts::stiffness);
    const double squared = greatest_eigenvalue(c, 4, true);
    double damping = 0;
    if (std::any_of(b_.effects_.begin(), b_.effects_.end(),
                    [](const auto& slot) { return slot.effect->dissipates() || slot.effect->couples_nodes(); })) {
        b_.assemble(c, BodySimulation::Parts::damping);
        const Field mode = b_.slow_mode_;
        damping = greatest_eigenvalue(c, 16, false);
        b_.slow_mode_ = mode;
    }
    const double divisor = damping + std::sqrt(damping * damping + 4 * squared);
    return divisor > 0 ? 4 / divisor : std::numeric_limits<double>::infinity();
}

void ExplicitStep::advance(double dt_s, double longest_s, StepReport& report)
{
    constexpr int between_estimates = 100; // some ten periods of the fastest mode
    double done = 0;
    double stable = longest_stable(b_.configure(b_.u_, b_.time_s_)), cap = longest_s;
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
        std::ostringstream before;
        b_.save(before);
        bool short_enough = true;
        for (int s = 0; s < run && short_enough; ++s)
            short_enough = substep(dt);
        const bool finite = whole(b_.u_).allFinite() && whole(b_.v_).allFinite();
        stable = finite ? longest_stable(b_.configure(b_.u_, b_.time_s_)) : 0;
        if ((!(dt <= 0.95 * stable) || !short_enough) &&
            dt > 1e-7 * dt_s) { // where they lead, these steps are too long: take them back
            const double too_long = dt;
            const Field mode = b_.slow_mode_;
            std::istringstream back(before.str());
            b_.restore(back);
            b_.slow_mode_ = finite ? mode : b_.slow_mode_;
            cap = std::min(cap, 0.4 * too_long);
            stable = longest_stable(b_.configure(b_.u_, b_.time_s_));
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
    const std::size_t n = b_.body_.size();
    const Configuration c = b_.configure(b_.u_, b_.time_s_);
    force_.assign(4 * n, 0);
    b_.add_forces(c, force_);
    for (auto& slot : b_.effects_)
        slot.effect->remember(c, dt);
    for (std::size_t i = 0; i < n; ++i) {
        if (b_.pinned_[i])
            continue;
        at(b_.v_, i) += dt / b_.body_.mass[i] * at(force_, i);
        at(b_.u_, i) += dt * at(b_.v_, i);
    }
    const double before = b_.time_s_;
    b_.time_s_ += dt;
    b_.finish(before, dt);
    return std::all_of(b_.effects_.begin(), b_.effects_.end(),
                       [&](const auto& slot) { return dt <= slot.effect->longest_step(c); });
}

} // namespace cinch
