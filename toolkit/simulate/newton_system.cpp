// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/newton_system.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

namespace cinch {

NewtonSystem::NewtonSystem(BodyForces& forces) : model_(forces.model()), forces_(forces)
{
    for (Field* f : {&residual_, &conjugate_, &product_, &scaled_})
        f->assign(4 * model_.body.size(), 0);
    for (const double m : model_.body.mass)
        mass_ += m;
}

void NewtonSystem::precondition(const Configuration& c, double dt)
{
    const MeshlessBody& body = model_.body;
    const std::vector<Mat3> diagonal = forces_.diagonal(c, held_);
    inverse_block_.resize(body.size());
    for (std::size_t i = 0; i < body.size(); ++i) {
        const Mat3 whole_block = body.mass[i] * Mat3::Identity() + dt * dt * diagonal[i];
        const double scale = std::max(body.mass[i], std::abs(whole_block.trace()) / 3);
        const Mat3 m = whole_block / scale, inverse = m.inverse();
        const bool positive =
            m(0, 0) > 0 && m.topLeftCorner<2, 2>().determinant() > 0 && m.determinant() > 0 && inverse.allFinite();
        inverse_block_[i] = (positive ? inverse : Mat3(Mat3::Identity())) / scale;
    }
    find_rigid_motions(c);
}

void NewtonSystem::find_rigid_motions(const Configuration& c)
{
    const MeshlessBody& body = model_.body;
    arm_.clear();
    if (!model_.pins.empty())
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
void NewtonSystem::apply_preconditioner()
{
    const MeshlessBody& body = model_.body;
    for (std::size_t i = 0; i < body.size(); ++i)
        at(scaled_, i) = inverse_block_[i] * at(residual_, i);
    model_.zero_pinned(scaled_);
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

bool NewtonSystem::solve(const Configuration& c, double dt, const Field& gradient, double reduction, Field& direction,
                         int& products)
{
    const MeshlessBody& body = model_.body;
    std::fill(direction.begin(), direction.end(), 0);
    whole(residual_) = -whole(gradient);
    apply_preconditioner();
    conjugate_ = scaled_;
    double rho = whole(residual_).dot(whole(scaled_));
    const double enough = reduction * reduction * rho;
    const std::size_t most = 12 * body.size() + 50;
    for (std::size_t k = 0; k < most && rho > enough; ++k) {
        std::fill(product_.begin(), product_.end(), 0);
        forces_.add_product(c, conjugate_, product_);
        ++products;
        for (std::size_t i = 0; i < body.size(); ++i)
            at(product_, i) = body.mass[i] * at(conjugate_, i) - dt * dt * at(product_, i);
        model_.zero_pinned(product_);
        const double curvature = whole(conjugate_).dot(whole(product_));
        if (!(curvature > 0))
            return false;
        const double alpha = rho / curvature;
        whole(direction) += alpha * whole(conjugate_);
        whole(residual_) -= alpha * whole(product_);
        apply_preconditioner();
        const double next = whole(residual_).dot(whole(scaled_));
        whole(conjugate_) = whole(scaled_) + next / rho * whole(conjugate_);
        rho = next;
    }
    return true;
}

} // namespace cinch
