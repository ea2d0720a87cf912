// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/body_simulation.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include "cinch/environment.hpp"
#include "toolkit/simulate/explicit_step.hpp"
#include "toolkit/simulate/implicit_step.hpp"
#include "toolkit/simulate/stream.hpp"

namespace cinch {

using Clock = std::chrono::steady_clock;
namespace {
constexpr double most_substeps = 1e6; // of one call
double since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }
} // namespace

BodySimulation::BodySimulation(MeshlessBody body, std::optional<DeformableSurface> surface)
    : body_(std::move(body)), surface_(std::move(surface))
{
    if (surface_ && surface_->weights.node_count != body_.size())
        throw std::invalid_argument("BodySimulation: the surface's weights are of other nodes");
    x_.assign(4 * body_.size(), 0);
    v_ = x_;
    u_ = v_;
    from_origin_ = v_;
    Vec3 low = Vec3::Constant(HUGE_VAL), high = -low, mean = Vec3::Zero();
    for (const Vec3& p : body_.rest) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
        mean += p / static_cast<double>(body_.size());
    }
    if (mean.stableNorm() > (high - low).stableNorm())
        reference_.centre = reference_.origin = mean;
    update_positions();
    pinned_.assign(body_.size(), 0);
}

void BodySimulation::add(std::unique_ptr<Effect> effect)
{
    needs_deformation_ |= effect->needs_deformation();
    if (effect->has_springs())
        spring_.assign(body_.size(), 0);
    if (std::string(effect->name()) == "plasticity")
        plastic_inverse_.assign(body_.size(), Mat3::Identity());
    effects_.push_back({std::move(effect)});
}

void BodySimulation::add(Pin pin)
{
    for (const std::uint32_t i : pin.nodes)
        pinned_.at(i) = 1;
    pins_.push_back(std::move(pin));
}

void BodySimulation::place(const Field& positions, const Field& velocities)
{
    reference_.rotation = Mat3::Identity();
    reference_.origin = reference_.low = Vec3::Zero();
    Vec3 mean = Vec3::Zero();
    for (std::size_t i = 0; i < body_.size(); ++i)
        mean += (at(positions, i) - reference_.place(body_.rest[i])) / static_cast<double>(body_.size());
    reference_.origin = mean;
    for (std::size_t i = 0; i < body_.size(); ++i)
        at(u_, i) = (at(positions, i) - mean) - reference_.place(body_.rest[i]);
    x_ = positions;
    v_ = velocities;
    time_s_ = 0;
    zero_pinned(v_);
}

void BodySimulation::place(const Vec3& position, const Mat3& rotation, const Field& velocities)
{
    reference_.origin = position;
    reference_.low = Vec3::Zero();
    reference_.rotation = rotation;
    if (reference_.centre != Vec3::Zero())
        reference_.move(rotation * reference_.centre);
    std::fill(u_.begin(), u_.end(), 0);
    v_ = velocities;
    time_s_ = 0;
    zero_pinned(v_);
    update_positions();
}

void BodySimulation::update_positions()
{
    for (std::size_t i = 0; i < body_.size(); ++i)
        at(x_, i) = reference_.origin + (reference_.low + (reference_.place(body_.rest[i]) + at(u_, i)));
}

Reference BodySimulation::fitted(const Field& u) const
{
    Reference to = reference_;
    if (!pins_.empty())
        return to;
    double mass = 0;
    Vec3 mean = Vec3::Zero(), rest = Vec3::Zero();
    for (std::size_t i = 0; i < body_.size(); ++i) {
        mass += body_.mass[i];
        mean += body_.mass[i] * at(u, i);
        rest += body_.mass[i] * (body_.rest[i] - reference_.centre);
    }
    mean /= mass;
    rest /= mass;
    Mat3 a = Mat3::Zero(); // Σ m (X − mean X) (x − mean x)ᵀ, whose polar factor is the rotation
    for (std::size_t i = 0; i < body_.size(); ++i) {
        const Vec3 x = (body_.rest[i] - reference_.centre) - rest;
        a += body_.mass[i] * (reference_.rotation * x + (at(u, i) - mean)) * x.transpose();
    }
    const Eigen::JacobiSVD<Mat3> svd(a, Eigen::ComputeFullU | Eigen::ComputeFullV);
    if (a.allFinite() && svd.singularValues()[0] > 0) {
        const Mat3 r = svd.matrixU() * svd.matrixV().transpose();
        Mat3 turned =
            r.determinant() > 0 ? r : Mat3(svd.matrixU() * Vec3(1, 1, -1).asDiagonal() * svd.matrixV().transpose());
        if (!(svd.singularValues()[1] > 1e-6 * svd.singularValues()[0])) // a line: by the least turn
            turned =
                Eigen::Quaterniond::FromTwoVectors(reference_.rotation * svd.matrixV().col(0), svd.matrixU().col(0))
                    .toRotationMatrix() *
                reference_.rotation;
        if ((turned - reference_.rotation).norm() > 0x1p-26)
            to.rotation = turned;
    }
    to.move((reference_.rotation - to.rotation) * rest + mean);
    return to;
}

void BodySimulation::refer_to(const Reference& to, std::initializer_list<Field*> fields)
{
    const Mat3 turn = reference_.rotation - to.rotation;
    const Vec3 way = reference_.way_to(to);
    for (Field* u : fields)
        for (std::size_t i = 0; i < body_.size(); ++i)
            at(*u, i) += turn * (body_.rest[i] - reference_.centre) - way;
    reference_ = to;
}

Configuration BodySimulation::configure(const Field& u, double time_s, const Vec3& datum)
{
    for (std::size_t i = 0; i < body_.size(); ++i)
        at(from_origin_, i) = reference_.place(body_.rest[i]) + at(u, i);
    const Configuration c{body_,
                          surface_ ? &*surface_ : nullptr,
                          reference_,
                          from_origin_,
                          u,
                          gradient_,
                          strain_,
                          deformation_,
                          plastic_inverse_,
                          time_s,
                          datum};
    if (!needs_deformation_)
        return c;
    const auto start = Clock::now();
    measure(body_, reference_.rotation, u, completion_, gradient_, strain_, deformation_);
    shared_s_ += since(start);
    return c;
}

double BodySimulation::greatest_acceleration(const Field& force) const
{
    double most = 0;
    for (std::size_t i = 0; i < body_.size(); ++i)
        if (!pinned_[i])
            most = std::max(most, at(force, i).norm() / body_.mass[i]);
    return most;
}

void BodySimulation::add_forces(const Configuration& c, Field& force, std::optional<std::size_t> only, double* greatest,
                                double* applied)
{
    if (needs_deformation_)
        stress_.assign(12 * body_.size(), 0);
    std::fill(spring_.begin(), spring_.end(), 0);
    Field part;
    for (std::size_t e = 0; e < effects_.size(); ++e) {
        if (only && *only != e)
            continue;
        if (greatest)
            part.assign(force.size(), 0);
        Field& out = greatest ? part : force;
        timed(effects_[e], [&](const Effect& effect) { effect.add_forces(c, {out, stress_, spring_}); });
        if (greatest) {
            const double most = greatest_acceleration(part);
            *greatest = std::max(*greatest, most);
            if (!effects_[e].effect->dissipates() && !effects_[e].effect->has_springs())
                *applied = std::max(*applied, most);
            whole(force) += whole(part);
        }
    }
    if (needs_deformation_) {
        const auto start = Clock::now();
        if (greatest)
            part.assign(force.size(), 0);
        scatter_stresses(lists_of(body_), stress_, spring_, c.u, greatest ? part : force);
        if (greatest) {
            *greatest = std::max(*greatest, greatest_acceleration(part));
            whole(force) += whole(part);
        }
        shared_s_ += since(start);
    }
}

void BodySimulation::assemble(const Configuration& c, Parts parts)
{
    if (needs_deformation_)
        local_.assign(body_.size(), Mat9::Zero());
    block_.assign(body_.size(), Mat3::Zero());
    for (Slot& slot : effects_) {
        if (parts == Parts::damping)
            slot.effect->add_damping(c, {local_, block_});
        else if (parts == Parts::all || !slot.effect->dissipates())
            timed(slot, [&](const Effect& effect) { effect.add_curvature(c, {local_, block_}); });
    }
    if (needs_deformation_ && !body_.deficient.empty() && completion_ == Completion::on)
        complete_curvature(body_, c.deformation, parts == Parts::all ? stress_ : MatrixField(), local_);
    if (parts == Parts::damping)
        return;
    for (Slot& slot : effects_)
        slot.effect->prepare_product(c, parts == Parts::stiffness);
}

// stress_ = −H dG and out −= block p; the stresses are still to be carried to the nodes.
void BodySimulation::begin_product(const Field& p, Field& out)
{
    for (std::size_t i = 0; i < body_.size(); ++i)
        at(out, i) -= block_[i] * at(p, i);
    if (!needs_deformation_)
        return;
    const auto start = Clock::now();
    change_.resize(12 * body_.size());
    std::fill(spring_.begin(), spring_.end(), 0);
    stress_.assign(12 * body_.size(), 0);
    gather_gradients(lists_of(body_), p, change_);
    for (std::size_t i = 0; i < body_.size(); ++i) {
        const Mat3 dj = matrix_at(change_, i);
        Mat3 dp;
        Eigen::Map<Eigen::Matrix<double, 9, 1>>(dp.data()).noalias() =
            local_[i] * Eigen::Map<const Eigen::Matrix<double, 9, 1>>(dj.data());
        matrix_at(stress_, i) = -dp;
    }
    shared_s_ += since(start);
}

void BodySimulation::end_product(const Field& p, Field& out)
{
    if (!needs_deformation_)
        return;
    const auto start = Clock::now();
    scatter_stresses(lists_of(body_), stress_, spring_, p, out);
    shared_s_ += since(start);
}

void BodySimulation::add_product(const Configuration& c, const Field& p, Field& out)
{
    begin_product(p, out);
    for (Slot& slot : effects_)
        if (slot.effect->couples_nodes())
            timed(slot, [&](const Effect& effect) { effect.add_product(c, p, change_, {out, stress_, spring_}); });
    end_product(p, out);
}

void BodySimulation::add_local_product(const Field& p, Field& out)
{
    begin_product(p, out);
    end_product(p, out);
}

void BodySimulation::finish(double from_s, double dt_s)
{
    for (const Pin& pin : pins_)
        for (std::size_t k = 0; k < pin.nodes.size(); ++k)
            at(v_, pin.nodes[k]) = (pin.path(k, from_s + dt_s) - pin.path(k, from_s)) / dt_s;
    move_pins(u_, from_s + dt_s);
    if (plastic_inverse_.empty())
        return;
    const Configuration c = configure(u_, time_s_);
    for (Slot& slot : effects_)
        timed(slot, [&](Effect& effect) { effect.flow(c, dt_s, plastic_inverse_); });
}

void BodySimulation::move_pins(Field& u, double time_s) const
{
    for (const Pin& pin : pins_) {
        const Vec3 origin = reference_.relative(pin.origin);
        for (std::size_t k = 0; k < pin.nodes.size(); ++k)
            at(u, pin.nodes[k]) = (pin.path(k, time_s) - reference_.place(body_.rest[pin.nodes[k]])) + origin;
    }
}

void BodySimulation::zero_pinned(Field& f) const
{
    for (std::size_t i = 0; i < pinned_.size(); ++i)
        if (pinned_[i])
            at(f, i).setZero();
}

StepReport BodySimulation::advance(double dt_s, const Integration& integration)
{
    require_default_arithmetic();
    if (!(dt_s >= 0) || !std::isfinite(dt_s))
        throw std::invalid_argument("advance: the time step must be finite and not negative");
    const auto start = Clock::now();
    completion_ = integration.completion;
    StepReport report;
    if (dt_s == 0) {
        report.kinetic = kinetic();
        report.potential = potential();
        return report;
    }
    std::ostringstream before;
    save(before);
    const double time = time_s_;
    double turn = 0;
    for (const Pin& pin : pins_)
        turn = std::max(turn, pin.turn(time_s_, time_s_ + dt_s));
    const double step = std::min(integration.step_s, dt_s / std::max(1.0, std::ceil(turn / 0.4)));
    if (!(dt_s / step <= most_substeps)) {
        report.failure = "needs more than a million steps: a smaller frame, a longer step or a slower turn";
    } else if (integration.method == Integration::Method::explicit_euler) {
        refer_to(fitted(u_), {&u_});
        ExplicitStep(*this, integration).advance(dt_s, step, report);
    } else {
        ImplicitStep(*this, integration).advance(dt_s, step, report);
    }
    if (report.failure.empty())
        update_positions();
    if (report.failure.empty() &&
        !(whole(x_).allFinite() && whole(v_).allFinite() &&
          std::all_of(plastic_inverse_.begin(), plastic_inverse_.end(), [](const Mat3& p) { return p.allFinite(); })))
        report.failure = "positions are no longer finite";
    report.dt_s = dt_s;
    report.seconds = since(start);
    if (!report.failure.empty()) {
        std::istringstream back(before.str());
        restore(back);
    } else {
        time_s_ = time + dt_s;
    }
    report.kinetic = kinetic();
    report.potential = potential();
    return report;
}

std::vector<AffineMap> BodySimulation::frame(const Vec3& from)
{
    MatrixField gradient, strain, deformation; // the surface needs J where no effect does
    measure(body_, reference_.rotation, u_, completion_, gradient, strain, deformation);
    return transforms(body_, reference_, u_, deformation, from);
}

double BodySimulation::kinetic() const
{
    double sum = 0;
    for (std::size_t i = 0; i < body_.size(); ++i)
        sum += 0.5 * body_.mass[i] * at(v_, i).squaredNorm();
    return sum;
}

double BodySimulation::potential() { return potential_at(u_, time_s_, reference_.relative(Vec3::Zero())); }

Field BodySimulation::forces(std::optional<std::size_t> only)
{
    Field force(4 * body_.size(), 0);
    add_forces(configure(u_, time_s_), force, only);
    return force;
}

Field BodySimulation::stiffness(const Field& dx)
{
    const Configuration c = configure(u_, time_s_);
    Field force(x_.size(), 0), product(x_.size(), 0);
    add_forces(c, force);
    assemble(c, Parts::all);
    add_product(c, dx, product);
    whole(product) *= -1;
    return product;
}

bool BodySimulation::pins_move(double from_s, double to_s) const
{
    for (const Pin& pin : pins_)
        for (std::size_t k = 0; k < pin.nodes.size(); ++k)
            if (pin.path(k, from_s) != pin.path(k, to_s))
                return true;
    return false;
}

double BodySimulation::potential_at(const Field& u, double time_s, const Vec3& datum)
{
    const Configuration c = configure(u, time_s, datum);
    double sum = 0;
    for (Slot& slot : effects_)
        if (!slot.effect->dissipates())
            sum += slot.effect->energy(c);
    return sum;
}

void BodySimulation::save(std::ostream& out) const
{
    write_raw<double>(out, {&time_s_, 1});
    reference_.save(out);
    write_raw<double>(out, u_);
    write_raw<double>(out, x_);
    write_raw<double>(out, v_);
    for (const Mat3& p : plastic_inverse_)
        write_raw<double>(out, {p.data(), 9});
    write_list(out, slow_mode_);
    for (const Slot& slot : effects_)
        slot.effect->save(out);
}

void BodySimulation::restore(std::istream& in)
{
    read_raw<double>(in, {&time_s_, 1});
    reference_.restore(in);
    read_raw<double>(in, u_);
    read_raw<double>(in, x_);
    read_raw<double>(in, v_);
    for (Mat3& p : plastic_inverse_)
        read_raw<double>(in, {p.data(), 9});
    read_list(in, slow_mode_);
    for (Slot& slot : effects_)
        slot.effect->restore(in);
}

} // namespace cinch
