// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/explicit_step.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cinch {

// Of M⁻¹K (or M⁻¹C) on the nodes that move, by magnitude; 10 per cent up, as a power iteration comes from below.
double ExplicitStep::greatest_eigenvalue(const Configuration& c, int iterations, bool stiffness)
{
    const std::size_t n = b_.body_.size();
    Field& mode = b_.slow_mode_;
    if (mode.size() != 4 * n) {
        mode.assign(4 * n, 0);
        for (std::size_t i = 0; i < 4 * n; ++i)
            if (i % 4 != 3)
                mode[i] = std::sin(0.7 + 12.9898 * static_cast<double>(i % 1009)); // every mode has a share
        iterations *= 20;
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
        value = 0;
        double next = 0;
        for (std::size_t i = 0; i < n; ++i) {
            const Vec3 image = -at(product, i) / b_.body_.mass[i];
            next += b_.body_.mass[i] * image.squaredNorm();
            at(product, i) = image;
        }
        value = std::sqrt(next); // ‖M⁻¹K mode‖ in the norm in which the mode is 1
        if (!(value > 0) || !std::isfinite(value))
            return std::isfinite(value) ? 0 : std::numeric_limits<double>::infinity();
        mode = product;
    }
    return 1.1 * value;
}

double ExplicitStep::longest_stable(const Configuration& c)
{
    b_.assemble(c, BodySimulation::Parts::stiffness);
    const double squared = greatest_eigenvalue(c, 3, true);
    double damping = 0;
    if (std::any_of(b_.effects_.begin(), b_.effects_.end(), [](const auto& slot) { return slot.effect->dissipates(); })) {
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
    const std::size_t n = b_.body_.size();
    double done = 0;
    Field force(4 * n);
    while (done < dt_s) {
        // What remains is cut into equal substeps, so that the last one is no splinter.
        const double stable = integration_.safety * longest_stable(b_.configure(b_.x_, b_.time_s_));
        const double pieces = std::ceil((dt_s - done) / std::min(stable, longest_s) * (1 - 1e-12));
        if (!(pieces >= 1) || pieces > 1e7) {
            report.failure = "no stable substep: the material is too stiff, or the state has broken down";
            return;
        }
        const double dt = (dt_s - done) / pieces;
        const int run = static_cast<int>(std::min<double>(pieces, between_estimates));
        for (int s = 0; s < run; ++s) {
            const Configuration c = b_.configure(b_.x_, b_.time_s_);
            std::fill(force.begin(), force.end(), 0);
            b_.add_forces(c, force);
            for (auto& slot : b_.effects_)
                slot.effect->remember(c, dt);
            for (std::size_t i = 0; i < n; ++i) {
                if (b_.pinned_[i])
                    continue;
                at(b_.v_, i) += dt / b_.body_.mass[i] * at(force, i);
                at(b_.x_, i) += dt * at(b_.v_, i);
            }
            const double before = b_.time_s_;
            b_.time_s_ += dt;
            b_.finish(before, dt);
            ++report.substeps;
        }
        done = run == static_cast<int>(pieces) ? dt_s : done + dt * run;
        if (!whole(b_.x_).allFinite() || !whole(b_.v_).allFinite()) {
            report.failure = "positions are no longer finite";
            return;
        }
    }
}

} // namespace cinch
