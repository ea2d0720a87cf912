// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/implicit_step.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace cinch {

ImplicitStep::ImplicitStep(BodySimulation& body, const Integration& integration) : b_(body), integration_(integration)
{
    for (Field* f : {&inertial_, &gradient_, &direction_, &residual_, &conjugate_, &product_, &scaled_})
        f->assign(4 * body.body_.size(), 0);
}

void ImplicitStep::advance(double dt_s, double longest_s, StepReport& report)
{
    const double start = b_.time_s_;
    const auto pieces = static_cast<std::size_t>(std::max(1.0, std::ceil(dt_s / longest_s * (1 - 1e-12))));
    for (std::size_t s = 0; s < pieces; ++s) {
        const double to = s + 1 == pieces ? start + dt_s : start + dt_s * static_cast<double>(s + 1) / static_cast<double>(pieces);
        if (!step_without_gain(to, 0, report))
            return;
    }
}

// Implicit Euler damps, but where the energy is not convex a long step can come out with more than it began with: it is then made
// in halves. Energies are compared at one time, so that forces that change with it do their work; pins that move do theirs.
bool ImplicitStep::step_without_gain(double to, int depth, StepReport& report)
{
    constexpr int most_halvings = 8;
    if (integration_.cancelled && integration_.cancelled()) {
        report.failure = "cancelled";
        return false;
    }
    const double from = b_.time_s_;
    std::ostringstream state;
    const bool guard = depth < most_halvings && !b_.pins_move(from, to);
    const double before = guard ? b_.kinetic() + b_.potential_at(b_.x_, to) : 0;
    if (guard)
        b_.save(state);
    if (!step(to - from, report))
        return false;
    if (guard) {
        const double potential = b_.potential_at(b_.x_, to), kinetic = b_.kinetic();
        if (kinetic + potential > before + 1e-9 * (kinetic + std::abs(potential))) {
            std::istringstream back(state.str());
            b_.restore(back);
            ++report.halved;
            return step_without_gain(0.5 * (from + to), depth + 1, report) && step_without_gain(to, depth + 1, report);
        }
    }
    ++report.substeps;
    return true;
}

ImplicitStep::Objective ImplicitStep::objective(const Field& x, double time, double dt)
{
    const Configuration c = b_.configure(x, time);
    Objective e{0, 0};
    for (std::size_t i = 0; i < b_.body_.size(); ++i)
        if (!b_.pinned_[i])
            e.value += 0.5 * b_.body_.mass[i] * (at(x, i) - at(inertial_, i)).squaredNorm();
    e.magnitude = e.value;
    for (auto& slot : b_.effects_) {
        double u = 0;
        b_.timed(slot, [&](const Effect& effect) { u = dt * dt * effect.energy(c); });
        e.value += u;
        e.magnitude += std::abs(u);
    }
    return e;
}

void ImplicitStep::gradient(const Configuration& c, double dt, Field& out)
{
    std::fill(out.begin(), out.end(), 0);
    b_.add_forces(c, out);
    for (std::size_t i = 0; i < b_.body_.size(); ++i)
        at(out, i) = b_.body_.mass[i] * (at(c.x, i) - at(inertial_, i)) - dt * dt * at(out, i);
    b_.zero_pinned(out);
}

// What rounding does to E: u times the magnitudes that are summed, and u times the stiffness of every node, as an error of u in J
// changes its energy by that where it turns. The factor 16 covers the operations of either.
double ImplicitStep::rounding_of(const Objective& e, double dt) const
{
    double stiffness = 0;
    for (const Mat9& h : b_.local_)
        stiffness += h.norm();
    return 16 * 0x1p-53 * (e.magnitude + dt * dt * stiffness);
}

void ImplicitStep::project()
{
    for (Mat9& h : b_.local_) {
        const Eigen::SelfAdjointEigenSolver<Mat9> eigen(0.5 * (h + h.transpose()));
        if (eigen.eigenvalues()[0] >= 0)
            continue;
        h = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).asDiagonal() * eigen.eigenvectors().transpose();
    }
}

void ImplicitStep::precondition(const Configuration& c, double dt)
{
    const MeshlessBody& body = b_.body_;
    std::vector<Mat3> diagonal(b_.block_);
    for (const auto& slot : b_.effects_)
        if (slot.effect->couples_nodes())
            slot.effect->add_diagonal(c, diagonal);
    if (b_.needs_deformation_) {
        // Node i's energy sees X_j through d_ij, and X_i through −Σ_j d_ij.
        auto add = [](const Mat9& h, const Vec3& d, Mat3& out) {
            for (int a = 0; a < 3; ++a)
                for (int k = 0; k < 3; ++k)
                    out += d[a] * d[k] * h.block<3, 3>(3 * a, 3 * k);
        };
        for (std::size_t i = 0; i < body.size(); ++i) {
            Vec3 sum = Vec3::Zero();
            for (std::uint32_t e = body.row[i]; e < body.row[i + 1]; ++e) {
                const Vec3 d = body.d(e);
                sum += d;
                add(b_.local_[i], d, diagonal[body.neighbour[e]]);
            }
            add(b_.local_[i], sum, diagonal[i]);
        }
    }
    inverse_block_.resize(body.size());
    for (std::size_t i = 0; i < body.size(); ++i) {
        const Mat3 m = body.mass[i] * Mat3::Identity() + dt * dt * diagonal[i];
        const Mat3 inverse = m.inverse();
        const bool positive = m(0, 0) > 0 && m.topLeftCorner<2, 2>().determinant() > 0 && m.determinant() > 0 && inverse.allFinite();
        inverse_block_[i] = positive ? inverse : Mat3(Mat3::Identity() / std::max(body.mass[i], std::abs(m.trace()) / 3));
    }
}

// (M + Δt² K) direction = −gradient.
bool ImplicitStep::solve(const Configuration& c, double dt, double reduction, StepReport& report)
{
    const MeshlessBody& body = b_.body_;
    auto apply_preconditioner = [&] {
        for (std::size_t i = 0; i < body.size(); ++i)
            at(scaled_, i) = inverse_block_[i] * at(residual_, i);
        b_.zero_pinned(scaled_);
    };
    std::fill(direction_.begin(), direction_.end(), 0);
    whole(residual_) = -whole(gradient_);
    apply_preconditioner();
    conjugate_ = scaled_;
    double rho = whole(residual_).dot(whole(scaled_));
    const double enough = reduction * reduction * rho;
    const std::size_t most = 12 * body.size() + 50;
    for (std::size_t k = 0; k < most && rho > enough; ++k) {
        std::fill(product_.begin(), product_.end(), 0);
        b_.add_product(c, conjugate_, product_);
        ++report.products;
        for (std::size_t i = 0; i < body.size(); ++i)
            at(product_, i) = body.mass[i] * at(conjugate_, i) - dt * dt * at(product_, i);
        b_.zero_pinned(product_);
        const double curvature = whole(conjugate_).dot(whole(product_));
        if (!(curvature > 0))
            return false;
        const double alpha = rho / curvature;
        whole(direction_) += alpha * whole(conjugate_);
        whole(residual_) -= alpha * whole(product_);
        apply_preconditioner();
        const double next = whole(residual_).dot(whole(scaled_));
        whole(conjugate_) = whole(scaled_) + next / rho * whole(conjugate_);
        rho = next;
    }
    return true;
}

bool ImplicitStep::step(double dt, StepReport& report)
{
    const MeshlessBody& body = b_.body_;
    const double time = b_.time_s_ + dt;
    {
        const Configuration now = b_.configure(b_.x_, b_.time_s_);
        for (auto& slot : b_.effects_)
            slot.effect->remember(now, dt);
    }
    const Field from = b_.x_;
    whole(inertial_) = whole(b_.x_) + dt * whole(b_.v_);
    Field rest = b_.x_;
    b_.move_pins(rest, time);
    b_.move_pins(inertial_, time);
    // Begin where the energy is less: where things are, or where they would coast to.
    Objective e = objective(inertial_, time, dt);
    const Objective still = objective(rest, time, dt);
    Field x = inertial_;
    if (!(e.value < still.value)) {
        x = rest;
        e = still;
    }
    auto fail = [&](const std::string& why) {
        report.failure = why;
        return false;
    };
    if (!std::isfinite(e.value))
        return fail("the energy is not finite");

    Field trial(x.size());
    double first_residual = 0;
    bool projected = false, trusted = false;
    double trusted_residual = 0;
    report.at_rounding = false;
    for (int iteration = 0;; ++iteration) {
        const Configuration c = b_.configure(x, time);
        gradient(c, dt, gradient_);
        report.residual = 0;
        for (std::size_t i = 0; i < body.size(); ++i)
            if (const double off = at(gradient_, i).norm() / (body.mass[i] * dt * dt); !(off <= report.residual)) // NaN stays
                report.residual = off;
        if (report.residual <= integration_.tolerance)
            break;
        if (trusted && !(report.residual < 0.5 * trusted_residual)) { // no longer any better: this is as near as doubles get
            report.at_rounding = true;
            if (report.residual > trusted_residual) {
                x.swap(trial);
                report.residual = trusted_residual;
            }
            break;
        }
        if (!std::isfinite(report.residual))
            return fail("forces are not finite");
        if (iteration >= integration_.most_iterations)
            return fail("no minimum within " + std::to_string(iteration) + " Newton iterations; accelerations are off by " + std::to_string(report.residual) + " m/s2");
        if (iteration == 0)
            first_residual = report.residual;
        ++report.iterations;

        b_.assemble(c, BodySimulation::Parts::all);
        if (projected) {
            project();
            ++report.projected;
        }
        precondition(c, dt);
        const double reduction = std::clamp(std::sqrt(report.residual / first_residual), 1e-6, 0.1);
        if (!solve(c, dt, reduction, report)) {
            if (projected || !integration_.project)
                return fail("the energy curves down in a direction that could not be mended");
            projected = true;
            project();
            ++report.projected;
            precondition(c, dt);
            if (!solve(c, dt, reduction, report))
                return fail("the energy curves down in a direction that could not be mended");
        }
        const double slope = whole(gradient_).dot(whole(direction_));
        // Where the decrease of E would drown in rounding, take the step on trust, and go on while the residual falls.
        trusted = -slope <= rounding_of(e, dt);
        if (trusted) {
            trusted_residual = report.residual;
            trial = x;
            whole(x) += whole(direction_);
            e = objective(x, time, dt);
            continue;
        }
        double length = 1;
        for (;; length *= 0.5) {
            whole(trial) = whole(x) + length * whole(direction_);
            const Objective there = objective(trial, time, dt);
            if (there.value <= e.value + 1e-4 * length * slope) {
                e = there;
                break;
            }
            if (length < 1e-12) {
                if (projected || !integration_.project)
                    return fail("no decrease of the energy along a direction of descent");
                break;
            }
        }
        if (length < 1e-12)
            projected = true; // and try again from here
        else {
            x.swap(trial);
            projected = projected && length < 1;
        }
    }
    whole(b_.v_) = (whole(x) - whole(from)) / dt;
    b_.x_ = x;
    b_.zero_pinned(b_.v_);
    b_.time_s_ = time;
    b_.finish(time - dt, dt);
    return true;
}

} // namespace cinch
