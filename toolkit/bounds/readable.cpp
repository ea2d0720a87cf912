// SPDX-License-Identifier: Apache-2.0
#include "toolkit/bounds/readable.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace cinch {
namespace {

// γ·(A x + t) = q·x + θ.
struct Functional {
    Vec3 q = Vec3::Zero();
    double theta = 0;
};

Functional along(const Axis& axis, const AffineMap& map)
{
    Functional f;
    for (int r = 0; r < 3; ++r) {
        for (int s = 0; s < 3; ++s)
            f.q[s] += axis[static_cast<std::size_t>(r)] * map.m[r][s];
        f.theta += axis[static_cast<std::size_t>(r)] * map.m[r][3];
    }
    return f;
}

std::vector<Functional> along(const Axis& axis, std::span<const std::uint32_t> node, std::span<const AffineMap> maps)
{
    std::vector<Functional> all;
    for (const std::uint32_t j : node)
        all.push_back(along(axis, maps[j]));
    return all;
}

Functional mean_of(const std::vector<Functional>& all, std::span<const WeightModel> model)
{
    Functional mean;
    for (std::size_t j = 0; j < all.size(); ++j) {
        mean.q += model[j].mean * all[j].q;
        mean.theta += model[j].mean * all[j].theta;
    }
    return mean;
}

double radius(const Functional& f, const RestBox& box) { return f.q.cwiseAbs().dot(box.half); }

// The least of D at the λ of `start` and the greatest b.
double dual(WeightSpace space, const std::vector<double>& b, double start)
{
    const double greatest = *std::max_element(b.begin(), b.end());
    double ranges = 0, mean = 0;
    for (std::size_t j = 0; j < b.size(); ++j) {
        ranges += space.h[j] - space.l[j];
        mean += (space.h[j] - space.l[j]) * b[j];
    }
    mean = ranges > 0 ? mean / ranges : greatest;
    const double lambda = mean + start * (greatest - mean);
    double d = lambda;
    for (std::size_t j = 0; j < b.size(); ++j)
        d += space.l[j] * (b[j] - lambda) + (space.h[j] - space.l[j]) * std::max(b[j] - lambda, 0.0);
    return std::min(d, greatest);
}

// max q·(x − z) over the rest vertices: over the extreme ones and their slack, or over the box.
double rest_support(const RestBv& bv, std::span<const Vec3> x, const Vec3& q)
{
    double most = -std::numeric_limits<double>::infinity();
    for (const std::uint32_t k : bv.point)
        most = std::max(most, q.dot(x[k] - bv.pivot));
    return std::min(most + bv.slack * q.norm(), q.dot(bv.box.centre - bv.pivot) + q.cwiseAbs().dot(bv.box.half));
}

// D(λ) of the extrema b_j of γ·(A_j x + t_j) over each simulation node's own rest box, cut by its ball; never more
// than the greatest b.
void readable_local(const RestBv& bv, std::span<const AffineMap> maps, double start, std::span<const Axis> axes,
                    std::span<double> supports)
{
    for (std::size_t a = 0; a < axes.size(); ++a) {
        const std::vector<Functional> all = along(axes[a], bv.node, maps);
        for (const int side : {1, -1}) {
            std::vector<double> b;
            for (std::size_t j = 0; j < all.size(); ++j)
                b.push_back(side * (all[j].q.dot(bv.local[j].centre) + all[j].theta) +
                            std::min(radius(all[j], bv.local[j]), all[j].q.norm() * bv.radius[j]));
            supports[2 * a + (side < 0)] = dual(bv.space, b, start);
        }
    }
}

// The support of the mean map over the rest vertices, and D(λ) of the extrema of what each map differs from it over
// the node's box.
void readable_support(const RestBv& bv, std::span<const Vec3> x, std::span<const AffineMap> maps, double start,
                      std::span<const Axis> axes, std::span<double> supports)
{
    for (std::size_t a = 0; a < axes.size(); ++a) {
        std::vector<Functional> all = along(axes[a], bv.node, maps);
        const Functional mean = mean_of(all, bv.model);
        for (Functional& f : all)
            f = {f.q - mean.q, f.theta - mean.theta};
        for (const int side : {1, -1}) {
            std::vector<double> b;
            for (std::size_t j = 0; j < all.size(); ++j)
                b.push_back(side * (all[j].q.dot(bv.local[j].centre) + all[j].theta) + radius(all[j], bv.local[j]));
            supports[2 * a + (side < 0)] = side * (mean.q.dot(bv.pivot) + mean.theta) +
                                           rest_support(bv, x, side * mean.q) + dual(bv.space, b, start);
        }
    }
}

// The affine model of the weights: w_j = m_j + g_j·y + ρ_j, y = x − z, |ρ_j| ≤ residual_j, |(w_j − m_j) y| ≤ moment_j.
//   γ·v = q̄·x + θ̄ + Σ_j (w_j − m_j)(dq_j·x + dθ_j)
//       = q̄·z + θ̄ + (q̄ + Σ_j P_j g_j)·y + Σ_j ρ_j P_j + Σ_j (w_j − m_j) dq_j·y,   P_j = dq_j·z + dθ_j,  dq_j = q_j −
//       q̄,
// so the support of q̄ + Σ P_j g_j over y, Σ residual_j |P_j|, and Σ |dq_j|·moment_j.
void readable_linear(const RestBv& bv, std::span<const Vec3> x, std::span<const AffineMap> maps,
                     std::span<const Axis> axes, std::span<double> supports)
{
    for (std::size_t a = 0; a < axes.size(); ++a) {
        const std::vector<Functional> all = along(axes[a], bv.node, maps);
        const Functional mean = mean_of(all, bv.model);
        Vec3 direction = mean.q;
        double rest = 0;
        for (std::size_t j = 0; j < all.size(); ++j) {
            const Vec3 dq = all[j].q - mean.q;
            const double p = dq.dot(bv.pivot) + (all[j].theta - mean.theta);
            direction += p * bv.model[j].gradient;
            rest += std::abs(p) * bv.model[j].residual + dq.cwiseAbs().dot(bv.model[j].moment);
        }
        for (const int side : {1, -1})
            supports[2 * a + (side < 0)] =
                side * (mean.q.dot(bv.pivot) + mean.theta) + rest_support(bv, x, side * direction) + rest;
    }
}

} // namespace

void readable_bound(Method kind, const RestBv& bv, std::span<const Vec3> x, std::span<const AffineMap> maps,
                    double start, std::span<const Axis> axes, std::span<double> supports)
{
    switch (kind) {
    case Method::local:
        return readable_local(bv, maps, start, axes, supports);
    case Method::support:
        return readable_support(bv, x, maps, start, axes, supports);
    case Method::linear:
        return readable_linear(bv, x, maps, axes, supports);
    default:
        throw std::invalid_argument("no formula of " + std::string(name_of(kind)));
    }
}

} // namespace cinch
