// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/simulation/plain_step.hpp"

#include <Eigen/Geometry>

namespace cinch {

PlainBody::PlainBody(const MeshlessBody& body, const Vec3& gravity, double young, double poisson, double hourglass)
    : x(body.rest), v(body.size(), Vec3::Zero()), body_(body), gravity_(gravity), force_(body.size()), f_(body.size())
{
    const double mu = young / (2 * (1 + poisson)), lambda = young * poisson / ((1 + poisson) * (1 - 2 * poisson));
    mu_ = 4.0 / 3 * mu;
    lambda_ = lambda + 5.0 / 6 * mu;
    alpha_ = 1 + 0.75 * mu_ / lambda_;
    for (std::size_t i = 0; i < body.size(); ++i) {
        double moment = 0;
        for (auto e = body.row[i]; e < body.row[i + 1]; ++e) {
            d_.push_back(body.d(e));
            offset_.push_back(body.rest[body.neighbour[e]] - body.rest[i]);
            moment += body.kernel(e) * offset_.back().squaredNorm();
        }
        for (auto e = body.row[i]; e < body.row[i + 1]; ++e)
            stiffness_.push_back(hourglass * young * body.volume[i] * body.kernel(e) / moment);
    }
}

void PlainBody::step(double dt_s)
{
    const std::size_t n = x.size();
    for (std::size_t i = 0; i < n; ++i)
        force_[i] = body_.mass[i] * gravity_;
    for (std::size_t i = 0; i < n; ++i) {
        f_[i].setZero();
        for (auto e = body_.row[i]; e < body_.row[i + 1]; ++e)
            f_[i] += (x[body_.neighbour[e]] - x[i]) * d_[e].transpose();
    }
    for (std::size_t i = 0; i < n; ++i) { // neo-Hookean
        const Mat3& f = f_[i];
        Mat3 cofactor;
        cofactor << f.col(1).cross(f.col(2)), f.col(2).cross(f.col(0)), f.col(0).cross(f.col(1));
        const Mat3 p = mu_ * (1 - 1 / (f.squaredNorm() + 1)) * f + lambda_ * (f.determinant() - alpha_) * cofactor;
        const Mat3 stress = -body_.volume[i] * p;
        for (auto e = body_.row[i]; e < body_.row[i + 1]; ++e) {
            const Vec3 t = stress * d_[e];
            force_[body_.neighbour[e]] += t;
            force_[i] -= t;
        }
    }
    for (std::size_t i = 0; i < n; ++i) // hourglass control
        for (auto e = body_.row[i]; e < body_.row[i + 1]; ++e) {
            const auto j = body_.neighbour[e];
            const Vec3 t = stiffness_[e] * (x[j] - x[i] - f_[i] * offset_[e]);
            force_[j] -= t;
            force_[i] += t;
        }
    for (std::size_t i = 0; i < n; ++i) {
        v[i] += dt_s / body_.mass[i] * force_[i];
        x[i] += dt_s * v[i];
    }
}

} // namespace cinch
