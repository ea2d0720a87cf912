// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/body_forces.hpp"

#include <algorithm>
#include <chrono>

#include <Eigen/Eigenvalues>

namespace cinch {
namespace {

using Clock = std::chrono::steady_clock;
double since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

Configuration seen_by(std::size_t effect, const Configuration& c)
{
    Configuration seen = c;
    seen.effect = effect;
    return seen;
}

} // namespace

BodyForces::BodyForces(const BodyModel& model, Completion completion)
    : model_(&model), completion_(completion), from_origin_(4 * model.body.size(), 0)
{
}

template <class Call> void BodyForces::timed(const Configuration& c, std::size_t effect, const Call& call)
{
    const Configuration seen = seen_by(effect, c);
    cost_.resize(model_->effects.size());
    const auto start = Clock::now();
    call(*model_->effects[effect], seen);
    cost_[effect].seconds += since(start);
    ++cost_[effect].calls;
}

Configuration BodyForces::configure(const BodyState& state, const Field& u, double time_s, const Vec3& datum)
{
    const MeshlessBody& body = model_->body;
    for (std::size_t i = 0; i < body.size(); ++i)
        at(from_origin_, i) = state.reference.place(body.rest[i]) + at(u, i);
    const Configuration c{body,
                          model_->surface ? &*model_->surface : nullptr,
                          state.reference,
                          from_origin_,
                          u,
                          gradient_,
                          strain_,
                          deformation_,
                          state.plastic_inverse,
                          time_s,
                          datum,
                          state.memory};
    if (!model_->needs_deformation)
        return c;
    const auto start = Clock::now();
    measure(body, state.reference.rotation, u, completion_, gradient_, strain_, deformation_);
    shared_s_ += since(start);
    return c;
}

double BodyForces::greatest_acceleration(const Field& force) const
{
    double most = 0;
    for (std::size_t i = 0; i < model_->body.size(); ++i)
        if (!model_->pinned[i])
            most = std::max(most, at(force, i).norm() / model_->body.mass[i]);
    return most;
}

void BodyForces::begin_forces()
{
    if (model_->needs_deformation)
        stress_.assign(12 * model_->body.size(), 0);
    spring_.assign(model_->has_springs ? model_->body.size() : 0, 0);
}

void BodyForces::scatter(const Field& x, Field& force)
{
    if (!model_->needs_deformation)
        return;
    const auto start = Clock::now();
    scatter_stresses(lists_of(model_->body), stress_, spring_, x, force);
    shared_s_ += since(start);
}

void BodyForces::add(const Configuration& c, Field& force, std::optional<std::size_t> only)
{
    begin_forces();
    for (std::size_t e = 0; e < model_->effects.size(); ++e)
        if (!only || *only == e)
            timed(c, e, [&](const Effect& effect, const Configuration& seen) {
                effect.add_forces(seen, {force, stress_, spring_});
            });
    scatter(c.u, force);
}

BodyForces::Greatest BodyForces::add_and_measure(const Configuration& c, Field& force)
{
    Greatest greatest;
    begin_forces();
    for (std::size_t e = 0; e < model_->effects.size(); ++e) {
        const Effect& one = *model_->effects[e];
        part_.assign(force.size(), 0);
        timed(c, e, [&](const Effect& effect, const Configuration& seen) {
            effect.add_forces(seen, {part_, stress_, spring_});
        });
        const double most = greatest_acceleration(part_);
        greatest.any = std::max(greatest.any, most);
        if (!one.dissipates() && !one.has_springs())
            greatest.applied = std::max(greatest.applied, most);
        whole(force) += whole(part_);
    }
    if (model_->needs_deformation) {
        part_.assign(force.size(), 0);
        scatter(c.u, part_);
        greatest.any = std::max(greatest.any, greatest_acceleration(part_));
        whole(force) += whole(part_);
    }
    return greatest;
}

double BodyForces::energy(const Configuration& c, std::size_t e)
{
    double energy = 0;
    timed(c, e, [&](const Effect& effect, const Configuration& seen) { energy = effect.energy(seen); });
    return energy;
}

double BodyForces::potential(const Configuration& c) const
{
    double sum = 0;
    for (std::size_t e = 0; e < model_->effects.size(); ++e)
        if (!model_->effects[e]->dissipates())
            sum += model_->effects[e]->energy(seen_by(e, c));
    return sum;
}

void BodyForces::assemble(const Configuration& c, Parts parts)
{
    if (model_->needs_deformation)
        local_.assign(model_->body.size(), Mat9::Zero());
    block_.assign(model_->body.size(), Mat3::Zero());
    for (std::size_t e = 0; e < model_->effects.size(); ++e) {
        const Effect& one = *model_->effects[e];
        if (parts == Parts::damping)
            one.add_damping(seen_by(e, c), {local_, block_});
        else if (parts == Parts::all || !one.dissipates())
            timed(c, e, [&](const Effect& effect, const Configuration& seen) {
                effect.add_curvature(seen, {local_, block_});
            });
    }
    if (model_->needs_deformation && !model_->body.deficient.empty() && completion_ == Completion::on)
        complete_curvature(model_->body, c.deformation, parts == Parts::all ? stress_ : MatrixField(), local_);
    if (parts == Parts::damping)
        return;
    touching_.resize(model_->effects.size());
    for (std::size_t e = 0; e < model_->effects.size(); ++e) {
        touching_[e].clear();
        model_->effects[e]->find_touching(seen_by(e, c), parts == Parts::stiffness, touching_[e]);
    }
}

void BodyForces::project()
{
    for (Mat9& h : local_) {
        const Eigen::SelfAdjointEigenSolver<Mat9> eigen(0.5 * (h + h.transpose()));
        if (eigen.eigenvalues()[0] >= 0)
            continue;
        h = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).asDiagonal() * eigen.eigenvectors().transpose();
    }
}

// stress_ = −H dG and out −= block p; the stresses are still to be carried to the nodes.
void BodyForces::begin_product(const Field& p, Field& out)
{
    const std::size_t n = model_->body.size();
    for (std::size_t i = 0; i < n; ++i)
        at(out, i) -= block_[i] * at(p, i);
    if (!model_->needs_deformation)
        return;
    const auto start = Clock::now();
    change_.resize(12 * n);
    begin_forces();
    gather_gradients(lists_of(model_->body), p, change_);
    for (std::size_t i = 0; i < n; ++i) {
        const Mat3 dj = matrix_at(change_, i);
        Mat3 dp;
        Eigen::Map<Eigen::Matrix<double, 9, 1>>(dp.data()).noalias() =
            local_[i] * Eigen::Map<const Eigen::Matrix<double, 9, 1>>(dj.data());
        matrix_at(stress_, i) = -dp;
    }
    shared_s_ += since(start);
}

void BodyForces::add_product(const Configuration& c, const Field& p, Field& out)
{
    begin_product(p, out);
    for (std::size_t e = 0; e < model_->effects.size(); ++e)
        if (model_->effects[e]->couples_nodes())
            timed(c, e, [&](const Effect& effect, const Configuration& seen) {
                effect.add_product(seen, touching_[e], p, change_, {out, stress_, spring_});
            });
    scatter(p, out);
}

void BodyForces::add_local_product(const Field& p, Field& out)
{
    begin_product(p, out);
    scatter(p, out);
}

std::vector<Mat3> BodyForces::diagonal(const Configuration& c, std::vector<double>& held) const
{
    const MeshlessBody& body = model_->body;
    std::vector<Mat3> diagonal(block_);
    auto add_coupled = [&](bool springs) {
        for (std::size_t e = 0; e < model_->effects.size(); ++e)
            if (const Effect& effect = *model_->effects[e]; effect.couples_nodes() && effect.has_springs() == springs)
                effect.add_diagonal(seen_by(e, c), touching_[e], diagonal);
    };
    add_coupled(false);
    held.resize(body.size());
    for (std::size_t i = 0; i < body.size(); ++i)
        held[i] = diagonal[i].norm();
    add_coupled(true);
    if (!model_->needs_deformation)
        return diagonal;
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
            add(local_[i], d, diagonal[body.neighbour[e]]);
        }
        add(local_[i], sum, diagonal[i]);
    }
    return diagonal;
}

void BodyForces::begin_step(const Configuration& c, double dt_s, BodyState& state) const
{
    for (std::size_t e = 0; e < model_->effects.size(); ++e)
        model_->effects[e]->remember(seen_by(e, c), dt_s, state.memory[e]);
}

void BodyForces::end_step(double from_s, double dt_s, BodyState& state)
{
    for (const Pin& pin : model_->pins)
        for (std::size_t k = 0; k < pin.nodes.size(); ++k)
            at(state.v, pin.nodes[k]) = (pin.path(k, from_s + dt_s) - pin.path(k, from_s)) / dt_s;
    model_->move_pins(state.reference, from_s + dt_s, state.u);
    if (!model_->is_plastic)
        return;
    const Configuration c = configure(state, state.u, state.time_s);
    for (std::size_t e = 0; e < model_->effects.size(); ++e)
        timed(c, e,
              [&](const Effect& effect, const Configuration& seen) { effect.flow(seen, dt_s, state.plastic_inverse); });
}

bool BodyForces::allow(const Configuration& c, double dt_s) const
{
    for (std::size_t e = 0; e < model_->effects.size(); ++e)
        if (!(dt_s <= model_->effects[e]->longest_step(seen_by(e, c))))
            return false;
    return true;
}

} // namespace cinch
