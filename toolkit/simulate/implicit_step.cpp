// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/implicit_step.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "toolkit/simulate/step_rounding.hpp"

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

ImplicitStep::ImplicitStep(BodyForces& forces, BodyState& state, const Integration& integration)
    : model_(forces.model()), forces_(forces), state_(state), integration_(integration), system_(forces)
{
    for (Field* f : {&inertial_, &gradient_, &direction_})
        f->assign(4 * model_.body.size(), 0);
    for (const Vec3& p : model_.body.rest)
        size_ = std::max(size_, (p - model_.body.rest[0]).norm());
}

void ImplicitStep::advance(double dt_s, double longest_s, StepReport& report)
{
    const double start = state_.time_s;
    const auto pieces = static_cast<std::size_t>(std::max(1.0, std::ceil(dt_s / longest_s * (1 - 1e-12))));
    for (std::size_t s = 0; s < pieces; ++s) {
        const double done = static_cast<double>(s + 1), all = static_cast<double>(pieces);
        const double to = s + 1 == pieces ? start + dt_s : start + dt_s * done / all;
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
    auto energy = [&](const Vec3& datum) { return forces_.potential(forces_.configure(state_, state_.u, to, datum)); };
    const double from = state_.time_s;
    const Field rigid = follow(to - from);
    if (depth == most_halvings || model_.pins_move(from, to)) {
        if (!step(to - from, rigid, report))
            return false;
    } else {
        const BodyState start = state_;
        const double before = state_.kinetic(model_.body) + energy(Vec3::Zero());
        if (!step(to - from, rigid, report))
            return false;
        const double potential = energy(state_.reference.way_to(start.reference)),
                     kinetic = state_.kinetic(model_.body);
        if (kinetic + potential > before + 1e-9 * (kinetic + std::abs(potential))) {
            state_ = start;
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
    if (!model_.pins.empty())
        return {};
    const MeshlessBody& body = model_.body;
    Field rigid = state_.u, coasting = state_.u;
    whole(coasting) += dt * whole(state_.v);
    const Mat3 before = state_.reference.rotation;
    Vec3 mean = Vec3::Zero();
    for (std::size_t i = 0; i < body.size(); ++i)
        mean += body.mass[i] / system_.mass() * at(state_.u, i);
    state_.refer_to(body, fitted(model_, state_.reference, coasting), {&state_.u});
    const Mat3 turn = state_.reference.rotation * before.transpose();
    for (std::size_t i = 0; i < body.size(); ++i)
        at(rigid, i) = turn * (at(rigid, i) - mean);
    return rigid;
}

ImplicitStep::Objective ImplicitStep::objective(const Field& u, double time, double dt)
{
    const Configuration c = forces_.configure(state_, u, time);
    Objective e{0, 0};
    for (std::size_t i = 0; i < model_.body.size(); ++i)
        if (!model_.pinned[i])
            e.value += 0.5 * model_.body.mass[i] * (at(u, i) - at(inertial_, i)).squaredNorm();
    e.magnitude = e.value;
    for (std::size_t effect = 0; effect < model_.effects.size(); ++effect) {
        const double part = dt * dt * forces_.energy(c, effect);
        e.value += part;
        e.magnitude += std::abs(part);
    }
    return e;
}

ImplicitStep::Accelerations ImplicitStep::gradient(const Configuration& c, double dt, Field& out)
{
    const MeshlessBody& body = model_.body;
    std::fill(out.begin(), out.end(), 0);
    const BodyForces::Greatest greatest = forces_.add_and_measure(c, out);
    Accelerations a{0, greatest.any, greatest.applied};
    for (std::size_t i = 0; i < body.size(); ++i) {
        const Vec3 inertia = at(c.u, i) - at(inertial_, i);
        at(out, i) = body.mass[i] * inertia - dt * dt * at(out, i);
        if (!model_.pinned[i])
            a.greatest = std::max(a.greatest, inertia.norm() / (dt * dt));
    }
    model_.zero_pinned(out);
    for (std::size_t i = 0; i < body.size(); ++i)
        if (const double off = at(out, i).norm() / (body.mass[i] * dt * dt); !(off <= a.residual)) // NaN stays
            a.residual = off;
    return a;
}

// Where the energy is least: where things are, where they would coast to, or where they would go without changing
// shape.
Field ImplicitStep::begin(double dt, const Field& rigid, Objective& e)
{
    const double time = state_.time_s + dt;
    forces_.begin_step(forces_.configure(state_, state_.u, state_.time_s), dt, state_);
    whole(inertial_) = whole(state_.u) + dt * whole(state_.v);
    Field still = state_.u;
    model_.move_pins(state_.reference, time, still);
    model_.move_pins(state_.reference, time, inertial_);
    const Field* best = &inertial_;
    e = objective(inertial_, time, dt);
    for (const Field* start : {&std::as_const(still), &rigid})
        if (!start->empty())
            if (const Objective there = objective(*start, time, dt); !(e.value < there.value)) {
                best = start;
                e = there;
            }
    return *best;
}

// Newton's, from c. Says why there is none.
std::string ImplicitStep::find_direction(const Configuration& c, double dt, double reduction, StepReport& report)
{
    forces_.assemble(c, BodyForces::Parts::all);
    auto solve = [&] {
        if (projected_) {
            forces_.project();
            ++report.projected;
        }
        system_.precondition(c, dt);
        return system_.solve(c, dt, gradient_, reduction, direction_, report.products);
    };
    if (solve())
        return "";
    if (!projected_ && integration_.project) {
        projected_ = true;
        if (solve())
            return "";
    }
    return "the energy curves down in a direction that could not be mended";
}

bool ImplicitStep::step(double dt, const Field& rigid, StepReport& report)
{
    const double time = state_.time_s + dt;
    Field from = state_.u;
    Objective e{};
    Field u = begin(dt, rigid, e), trial;
    auto fail = [&](const std::string& why) {
        report.failure = why;
        return false;
    };
    if (!std::isfinite(e.value))
        return fail("the energy is not finite");

    double first_residual = 0, trusted_residual = 0;
    bool trusted = false;
    int fits = 2;
    projected_ = false;
    report.at_rounding = false;
    for (int iteration = 0;; ++iteration) {
        const Configuration c = forces_.configure(state_, u, time);
        const Accelerations a = gradient(c, dt, gradient_);
        const double allowed = integration_.tolerance * a.greatest;
        report.residual = a.residual;
        report.acceleration = a.greatest;
        if (a.residual <= allowed)
            break;
        if (!std::isfinite(a.residual))
            return fail("forces are not finite");
        const std::string short_of =
            "accelerations are off by " + in_si(a.residual) + ", where " + in_si(allowed) + " are allowed";
        if (trusted && !(a.residual < 0.5 * trusted_residual)) { // no longer any better
            const double bound = rounding_of_acceleration(forces_, c, system_.held(), inertial_, dt);
            if (a.residual <= bound) {
                if (model_.pins.empty() && fits > 0) { // displacements as small as can be
                    --fits;
                    trusted = false;
                    state_.refer_to(model_.body, fitted(model_, state_.reference, u), {&u, &inertial_, &from});
                    e = objective(u, time, dt);
                    continue;
                }
                const double pull = greatest_pull(forces_, u);
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

        const double reduction = std::clamp(std::sqrt(a.residual / first_residual), 1e-6, 0.1);
        if (const std::string why = find_direction(c, dt, reduction, report); !why.empty())
            return fail(why + "; " + short_of);
        const double slope = whole(gradient_).dot(whole(direction_));
        // Where the decrease of E would drown in rounding, take the step on trust, and go on while the residual falls.
        trusted = -slope <= rounding_of_energy(forces_, c, e.magnitude, dt);
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
                if (projected_ || !integration_.project)
                    return fail("no decrease of the energy along a direction of descent; " + short_of);
                break;
            }
        }
        if (length < 1e-12) {
            projected_ = true; // and try again from here
        } else {
            u.swap(trial);
            projected_ = projected_ && length < 1;
        }
    }
    whole(state_.v) = (whole(u) - whole(from)) / dt;
    state_.u = u;
    model_.zero_pinned(state_.v);
    state_.time_s = time;
    forces_.end_step(time - dt, dt, state_);
    return true;
}

} // namespace cinch
