// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/implicit_step.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>
#include <utility>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace cinch {
namespace {

constexpr double unit = 0x1p-53;     // of rounding
constexpr double balanced = 0x1p-32; // see the header: of the forces inside a body

std::string in_si(double acceleration)
{
    char text[32];
    std::snprintf(text, sizeof text, "%.3g m/s2", acceleration);
    return text;
}

} // namespace

ImplicitStep::ImplicitStep(BodySimulation& body, const Integration& integration) : b_(body), integration_(integration)
{
    for (Field* f : {&inertial_, &gradient_, &direction_, &residual_, &conjugate_, &product_, &scaled_})
        f->assign(4 * body.body_.size(), 0);
    for (const double m : body.body_.mass)
        mass_ += m;
    for (const Vec3& p : body.body_.rest)
        size_ = std::max(size_, (p - body.body_.rest[0]).norm());
}

void ImplicitStep::advance(double dt_s, double longest_s, StepReport& report)
{
    const double start = b_.time_s_;
    const auto pieces = static_cast<std::size_t>(std::max(1.0, std::ceil(dt_s / longest_s * (1 - 1e-12))));
    for (std::size_t s = 0; s < pieces; ++s) {
        const double to =
            s + 1 == pieces ? start + dt_s : start + dt_s * static_cast<double>(s + 1) / static_cast<double>(pieces);
        if (!step_without_gain(to, 0, report))
            return;
    }
}

// Implicit Euler damps, but where the energy is not convex a long step can come out with more than it began with: it is
// then made in halves. Energies are compared at one time, so that forces that change with it do their work; pins that
// move do theirs.
bool ImplicitStep::step_without_gain(double to, int depth, StepReport& report)
{
    constexpr int most_halvings = 8;
    if (integration_.cancelled && integration_.cancelled()) {
        report.failure = "cancelled";
        return false;
    }
    const double from = b_.time_s_;
    const Field rigid = follow(to - from);
    const Reference start = b_.reference_;
    std::ostringstream state;
    const bool guard = depth < most_halvings && !b_.pins_move(from, to);
    const double before = guard ? b_.kinetic() + b_.potential_at(b_.u_, to, Vec3::Zero()) : 0;
    if (guard)
        b_.save(state);
    if (!step(to - from, rigid, report))
        return false;
    if (guard) {
        const double potential = b_.potential_at(b_.u_, to, b_.reference_.way_to(start)), kinetic = b_.kinetic();
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

// Fits the reference to where the body would coast to. Returns the displacements there that keep the strain of now;
// none for a body that pins hold.
Field ImplicitStep::follow(double dt)
{
    if (!b_.pins_.empty())
        return {};
    Field rigid = b_.u_, coasting = b_.u_;
    whole(coasting) += dt * whole(b_.v_);
    const Mat3 before = b_.reference_.rotation;
    Vec3 mean = Vec3::Zero();
    for (std::size_t i = 0; i < b_.body_.size(); ++i)
        mean += b_.body_.mass[i] / mass_ * at(b_.u_, i);
    b_.refer_to(b_.fitted(coasting), {&b_.u_});
    const Mat3 turn = b_.reference_.rotation * before.transpose();
    for (std::size_t i = 0; i < b_.body_.size(); ++i)
        at(rigid, i) = turn * (at(rigid, i) - mean);
    return rigid;
}

ImplicitStep::Objective ImplicitStep::objective(const Field& u, double time, double dt)
{
    const Configuration c = b_.configure(u, time);
    Objective e{0, 0};
    for (std::size_t i = 0; i < b_.body_.size(); ++i)
        if (!b_.pinned_[i])
            e.value += 0.5 * b_.body_.mass[i] * (at(u, i) - at(inertial_, i)).squaredNorm();
    e.magnitude = e.value;
    for (auto& slot : b_.effects_) {
        double part = 0;
        b_.timed(slot, [&](const Effect& effect) { part = dt * dt * effect.energy(c); });
        e.value += part;
        e.magnitude += std::abs(part);
    }
    return e;
}

ImplicitStep::Accelerations ImplicitStep::gradient(const Configuration& c, double dt, Field& out)
{
    Accelerations a;
    std::fill(out.begin(), out.end(), 0);
    b_.add_forces(c, out, {}, &a.greatest, &a.applied);
    for (std::size_t i = 0; i < b_.body_.size(); ++i) {
        const Vec3 inertia = at(c.u, i) - at(inertial_, i);
        at(out, i) = b_.body_.mass[i] * inertia - dt * dt * at(out, i);
        if (!b_.pinned_[i])
            a.greatest = std::max(a.greatest, inertia.norm() / (dt * dt));
    }
    b_.zero_pinned(out);
    for (std::size_t i = 0; i < b_.body_.size(); ++i)
        if (const double off = at(out, i).norm() / (b_.body_.mass[i] * dt * dt); !(off <= a.residual)) // NaN stays
            a.residual = off;
    return a;
}

// What rounding does to E: u times the magnitudes that are summed, 16 operations each; and of every node the stress, at
// most its stiffness times ‖H‖, times the error of H, at most 4 (n_k/2 + 16) u ‖H‖ as Σ_j ‖d_kj‖ ‖u_j − u_k‖ is at most
// 4 ‖H‖ about, and u after plastic flow.
double ImplicitStep::rounding_of(const Configuration& c, const Objective& e, double dt) const
{
    double stresses = 0;
    for (std::size_t k = 0; k < b_.local_.size(); ++k) {
        const double strain = matrix_at(c.strain, k).norm(),
                     operations = 0.5 * (b_.body_.row[k + 1] - b_.body_.row[k]) + 16;
        stresses += b_.local_[k].norm() * strain * (4 * operations * strain + (c.plastic_inverse.empty() ? 0 : 32));
    }
    return unit * (16 * e.magnitude + dt * dt * stresses);
}

// m/s², see the header: the greatest error that rounding may leave in an acceleration. Beside the stresses there are
// the springs to neighbours, forces that depend on the place in the world, and the inertia, each with an error of u of
// the lengths that it sees.
double ImplicitStep::rounding_bound(const Configuration& c, double dt) const
{
    const MeshlessBody& body = b_.body_;
    const std::size_t n = body.size();
    std::vector<double> size(n), force(n);
    for (std::size_t i = 0; i < n; ++i) {
        size[i] = at(c.u, i).norm();
        force[i] =
            4 * unit * (held_[i] * at(c.x, i).norm() + body.mass[i] * (size[i] + at(inertial_, i).norm()) / (dt * dt));
    }
    for (std::size_t k = 0; k < b_.local_.size(); ++k) {
        const double operations = 0.5 * (body.row[k + 1] - body.row[k]) + 8,
                     spring = b_.spring_.empty() ? 0 : b_.spring_[k];
        double error = 0;
        for (std::uint32_t e = body.row[k]; e < body.row[k + 1]; ++e)
            error += body.d(e).norm() * (size[body.neighbour[e]] + size[k]);
        const double stress =
            unit * b_.local_[k].norm() *
            (operations * error + 32 * (matrix_at(c.strain, k).norm() + (c.plastic_inverse.empty() ? 0 : 1)));
        for (std::uint32_t e = body.row[k]; e < body.row[k + 1]; ++e) {
            const std::uint32_t j = body.neighbour[e];
            const double pull =
                stress * body.d(e).norm() + operations * unit * spring * body.kernel(e) * (size[j] + size[k]);
            force[j] += pull;
            force[k] += pull;
        }
    }
    double most = 0;
    for (std::size_t i = 0; i < n; ++i)
        if (!b_.pinned_[i])
            most = std::max(most, force[i] / body.mass[i]);
    return most;
}

// m/s²: the greatest sum of the magnitudes of what single neighbours pull a node by, over its mass. Of the last
// gradient's stresses and springs, as scatter_stresses() carries them.
double ImplicitStep::greatest_pull(const Field& u) const
{
    const MeshlessBody& body = b_.body_;
    std::vector<double> pull(body.size(), 0);
    for (std::size_t k = 0; 12 * k < b_.stress_.size(); ++k)
        for (std::uint32_t e = body.row[k]; e < body.row[k + 1]; ++e) {
            Vec3 force = matrix_at(b_.stress_, k) * body.d(e);
            if (!b_.spring_.empty())
                force += b_.spring_[k] * body.kernel(e) * (at(u, k) - at(u, body.neighbour[e]));
            const double size = force.norm();
            pull[body.neighbour[e]] += size;
            pull[k] += size;
        }
    double most = 0;
    for (std::size_t i = 0; i < body.size(); ++i)
        if (!b_.pinned_[i])
            most = std::max(most, pull[i] / body.mass[i]);
    return most;
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
        if (slot.effect->couples_nodes() && !slot.effect->has_springs())
            slot.effect->add_diagonal(c, diagonal);
    held_.resize(body.size());
    for (std::size_t i = 0; i < body.size(); ++i)
        held_[i] = diagonal[i].norm();
    for (const auto& slot : b_.effects_)
        if (slot.effect->couples_nodes() && slot.effect->has_springs())
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
        const Mat3 whole_block = body.mass[i] * Mat3::Identity() + dt * dt * diagonal[i];
        const double scale = std::max(body.mass[i], std::abs(whole_block.trace()) / 3);
        const Mat3 m = whole_block / scale, inverse = m.inverse();
        const bool positive =
            m(0, 0) > 0 && m.topLeftCorner<2, 2>().determinant() > 0 && m.determinant() > 0 && inverse.allFinite();
        inverse_block_[i] = (positive ? inverse : Mat3(Mat3::Identity())) / scale;
    }
    arm_.clear();
    if (!b_.pins_.empty())
        return;
    arm_ = c.x;
    Vec3 centre = Vec3::Zero();
    for (std::size_t i = 0; i < body.size(); ++i)
        centre += body.mass[i] / mass_ * at(c.x, i);
    Mat3 inertia = Mat3::Zero();
    for (std::size_t i = 0; i < body.size(); ++i) {
        const Vec3 r = at(c.x, i) - centre;
        at(arm_, i) = r;
        inertia += body.mass[i] * (r.squaredNorm() * Mat3::Identity() - r * r.transpose());
    }
    const double scale = inertia.trace();
    inverse_inertia_.setZero();
    if (!(scale > 0))
        return;
    const Eigen::SelfAdjointEigenSolver<Mat3> eigen(inertia / scale);
    for (int k = 0; k < 3; ++k)
        if (eigen.eigenvalues()[k] > 1e-10) // a line has no inertia about itself
            inverse_inertia_ += eigen.eigenvectors().col(k) * eigen.eigenvectors().col(k).transpose() /
                                (scale * eigen.eigenvalues()[k]);
}

// The blocks' inverses, and for a free body the rigid motion that the residual's force and torque give it.
void ImplicitStep::apply_preconditioner()
{
    const MeshlessBody& body = b_.body_;
    for (std::size_t i = 0; i < body.size(); ++i)
        at(scaled_, i) = inverse_block_[i] * at(residual_, i);
    b_.zero_pinned(scaled_);
    if (arm_.empty())
        return;
    Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
    for (std::size_t i = 0; i < body.size(); ++i) {
        force += at(residual_, i);
        torque += Vec3(at(arm_, i)).cross(Vec3(at(residual_, i)));
    }
    const Vec3 shift = force / mass_, turn = inverse_inertia_ * torque;
    for (std::size_t i = 0; i < body.size(); ++i)
        at(scaled_, i) += shift + turn.cross(Vec3(at(arm_, i)));
}

// (M + Δt² K) direction = −gradient.
bool ImplicitStep::solve(const Configuration& c, double dt, double reduction, StepReport& report)
{
    const MeshlessBody& body = b_.body_;
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

bool ImplicitStep::step(double dt, const Field& rigid, StepReport& report)
{
    const double time = b_.time_s_ + dt;
    {
        const Configuration now = b_.configure(b_.u_, b_.time_s_);
        for (auto& slot : b_.effects_)
            slot.effect->remember(now, dt);
    }
    Field from = b_.u_;
    whole(inertial_) = whole(b_.u_) + dt * whole(b_.v_);
    // Begin where the energy is least: where things are, where they would coast to, or where they would go without
    // changing shape.
    Field still = b_.u_;
    b_.move_pins(still, time);
    b_.move_pins(inertial_, time);
    Field u = inertial_, trial;
    Objective e = objective(u, time, dt);
    for (const Field* start : {&std::as_const(still), &rigid})
        if (!start->empty())
            if (const Objective there = objective(*start, time, dt); !(e.value < there.value)) {
                u = *start;
                e = there;
            }
    auto fail = [&](const std::string& why) {
        report.failure = why;
        return false;
    };
    if (!std::isfinite(e.value))
        return fail("the energy is not finite");

    double first_residual = 0, trusted_residual = 0;
    bool projected = false, trusted = false;
    int fits = 2;
    report.at_rounding = false;
    for (int iteration = 0;; ++iteration) {
        const Configuration c = b_.configure(u, time);
        const Accelerations a = gradient(c, dt, gradient_);
        report.residual = a.residual;
        report.acceleration = a.greatest;
        if (a.residual <= integration_.tolerance * a.greatest)
            break;
        if (!std::isfinite(a.residual))
            return fail("forces are not finite");
        const std::string short_of = "accelerations are off by " + in_si(a.residual) + ", where " +
                                     in_si(integration_.tolerance * a.greatest) + " are allowed";
        if (trusted && !(a.residual < 0.5 * trusted_residual)) { // no longer any better
            const double bound = rounding_bound(c, dt);
            if (a.residual <= bound) {
                if (b_.pins_.empty() && fits > 0) { // displacements as small as can be
                    --fits;
                    trusted = false;
                    b_.refer_to(b_.fitted(u), {&u, &inertial_, &from});
                    e = objective(u, time, dt);
                    continue;
                }
                const double pull = greatest_pull(u);
                const bool at_rest = a.greatest * dt * dt <= unit * size_ ||
                                     (std::max(a.greatest, pull) <= bound && a.applied <= balanced * a.residual);
                if (!(a.residual <= balanced * pull) && !at_rest)
                    return fail("rounding: " + short_of);
                report.at_rounding = true;
                break;
            }
        }
        if (iteration >= integration_.most_iterations)
            return fail("no minimum within " + std::to_string(iteration) + " Newton iterations; " + short_of);
        if (iteration == 0)
            first_residual = a.residual;
        ++report.iterations;

        b_.assemble(c, BodySimulation::Parts::all);
        if (projected) {
            project();
            ++report.projected;
        }
        precondition(c, dt);
        const double reduction = std::clamp(std::sqrt(a.residual / first_residual), 1e-6, 0.1);
        if (!solve(c, dt, reduction, report)) {
            if (projected || !integration_.project)
                return fail("the energy curves down in a direction that could not be mended; " + short_of);
            projected = true;
            project();
            ++report.projected;
            precondition(c, dt);
            if (!solve(c, dt, reduction, report))
                return fail("the energy curves down in a direction that could not be mended; " + short_of);
        }
        const double slope = whole(gradient_).dot(whole(direction_));
        // Where the decrease of E would drown in rounding, take the step on trust, and go on while the residual falls.
        trusted = -slope <= rounding_of(c, e, dt);
        if (trusted) {
            trusted_residual = a.residual;
            whole(u) += whole(direction_);
            e = objective(u, time, dt);
            continue;
        }
        double length = 1;
        trial = u;
        for (;; length *= 0.5) {
            whole(trial) = whole(u) + length * whole(direction_);
            const Objective there = objective(trial, time, dt);
            if (there.value <= e.value + 1e-4 * length * slope) {
                e = there;
                break;
            }
            if (length < 1e-12) {
                if (projected || !integration_.project)
                    return fail("no decrease of the energy along a direction of descent; " + short_of);
                break;
            }
        }
        if (length < 1e-12)
            projected = true; // and try again from here
        else {
            u.swap(trial);
            projected = projected && length < 1;
        }
    }
    whole(b_.v_) = (whole(u) - whole(from)) / dt;
    b_.u_ = u;
    b_.zero_pinned(b_.v_);
    b_.time_s_ = time;
    b_.finish(time - dt, dt);
    return true;
}

} // namespace cinch
