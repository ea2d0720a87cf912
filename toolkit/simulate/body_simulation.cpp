// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/body_simulation.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <istream>
#include <stdexcept>

#include "cinch/environment.hpp"
#include "toolkit/simulate/explicit_step.hpp"
#include "toolkit/simulate/implicit_step.hpp"

namespace cinch {
namespace {

constexpr double most_substeps = 1e6; // of one call

double potential_of(BodyForces& forces, const BodyState& state)
{
    return forces.potential(forces.configure(state, state.u, state.time_s, state.reference.relative(Vec3::Zero())));
}

// Why `state` could not be advanced; then it is anything.
std::string advance_state(BodyForces& forces, BodyState& state, double dt_s, const Integration& integration,
                          StepReport& report)
{
    const BodyModel& model = forces.model();
    const double time = state.time_s;
    double turn = 0;
    for (const Pin& pin : model.pins)
        turn = std::max(turn, pin.turn(time, time + dt_s));
    const double step = std::min(integration.step_s, dt_s / std::max(1.0, std::ceil(turn / 0.4)));
    if (!(dt_s / step <= most_substeps))
        return "needs more than a million steps: a smaller frame, a longer step or a slower turn";
    if (integration.method == Integration::Method::explicit_euler) {
        state.refer_to(model.body, fitted(model, state.reference, state.u), {&state.u});
        ExplicitStep(forces, state, integration).advance(dt_s, step, report);
    } else {
        ImplicitStep(forces, state, integration).advance(dt_s, step, report);
    }
    if (!report.failure.empty())
        return report.failure;
    state.update_positions(model.body);
    state.time_s = time + dt_s;
    return state.is_finite() ? "" : "positions are no longer finite";
}

} // namespace

BodySimulation::BodySimulation(MeshlessBody body, std::optional<DeformableSurface> surface)
    : model_(std::make_unique<BodyModel>(std::move(body), std::move(surface))), state_(model_->body), forces_(*model_)
{
}

void BodySimulation::add(std::unique_ptr<const Effect> effect)
{
    model_->add(std::move(effect));
    state_.memory.emplace_back();
    if (model_->is_plastic && state_.plastic_inverse.empty())
        state_.plastic_inverse.assign(body().size(), Mat3::Identity());
}

void BodySimulation::add(Pin pin) { model_->add(std::move(pin)); }

void BodySimulation::place(const Field& positions, const Field& velocities)
{
    Reference& reference = state_.reference;
    reference.rotation = Mat3::Identity();
    reference.origin = reference.low = Vec3::Zero();
    Vec3 mean = Vec3::Zero();
    for (std::size_t i = 0; i < body().size(); ++i)
        mean += (at(positions, i) - reference.place(body().rest[i])) / static_cast<double>(body().size());
    reference.origin = mean;
    for (std::size_t i = 0; i < body().size(); ++i)
        at(state_.u, i) = (at(positions, i) - mean) - reference.place(body().rest[i]);
    state_.x = positions;
    state_.v = velocities;
    state_.time_s = 0;
    model_->zero_pinned(state_.v);
}

void BodySimulation::place(const Vec3& position, const Mat3& rotation, const Field& velocities)
{
    Reference& reference = state_.reference;
    reference.origin = position;
    reference.low = Vec3::Zero();
    reference.rotation = rotation;
    if (reference.centre != Vec3::Zero())
        reference.move(rotation * reference.centre);
    std::fill(state_.u.begin(), state_.u.end(), 0);
    state_.v = velocities;
    state_.time_s = 0;
    model_->zero_pinned(state_.v);
    state_.update_positions(body());
}

StepReport BodySimulation::advance(double dt_s, const Integration& integration)
{
    require_default_arithmetic();
    if (!(dt_s >= 0) || !std::isfinite(dt_s))
        throw std::invalid_argument("advance: the time step must be finite and not negative");
    const auto start = std::chrono::steady_clock::now();
    completion_ = integration.completion;
    forces_.set(completion_);
    StepReport report;
    if (dt_s > 0) {
        BodyState next = state_;
        report.failure = advance_state(forces_, next, dt_s, integration, report);
        if (report.failure.empty())
            state_ = std::move(next);
        report.dt_s = dt_s;
        report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }
    report.kinetic = kinetic();
    report.potential = potential_of(forces_, state_);
    return report;
}

std::vector<AffineMap> BodySimulation::frame(const Vec3& from) const
{
    MatrixField gradient, strain, deformation; // the surface needs J where no effect does
    measure(body(), reference().rotation, state_.u, completion_, gradient, strain, deformation);
    return transforms(body(), reference(), state_.u, deformation, from);
}

double BodySimulation::potential() const
{
    BodyForces forces(*model_, completion_);
    return potential_of(forces, state_);
}

Field BodySimulation::forces(std::optional<std::size_t> only) const
{
    BodyForces forces(*model_, completion_);
    Field force(4 * body().size(), 0);
    forces.add(forces.configure(state_, state_.u, state_.time_s), force, only);
    return force;
}

Field BodySimulation::stiffness(const Field& dx) const
{
    BodyForces forces(*model_, completion_);
    const Configuration c = forces.configure(state_, state_.u, state_.time_s);
    Field force(4 * body().size(), 0), product(4 * body().size(), 0);
    forces.add(c, force);
    forces.assemble(c, BodyForces::Parts::all);
    forces.add_product(c, dx, product);
    whole(product) *= -1;
    return product;
}

void BodySimulation::restore(std::istream& in)
{
    BodyState read = state_;
    read.restore(in);
    if (in)
        state_ = std::move(read);
}

} // namespace cinch
