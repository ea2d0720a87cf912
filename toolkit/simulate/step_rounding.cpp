// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/step_rounding.hpp"

#include <algorithm>

namespace cinch {
namespace {

constexpr double unit = 0x1p-53; // of rounding

} // namespace

// u times the magnitudes that are summed, 16 operations each; and of every node the stress, at most its stiffness times
// ‖H‖, times the error of H, at most 4 (n_k/2 + 16) u ‖H‖ as Σ_j ‖d_kj‖ ‖u_j − u_k‖ is at most 4 ‖H‖ about, and u after
// plastic flow.
double rounding_of_energy(const BodyForces& forces, const Configuration& c, double magnitude, double dt)
{
    const std::vector<Mat9>& local = forces.local();
    const MeshlessBody& body = c.body;
    double stresses = 0;
    for (std::size_t k = 0; k < local.size(); ++k) {
        const double strain = matrix_at(c.strain, k).norm(), operations = 0.5 * (body.row[k + 1] - body.row[k]) + 16;
        stresses += local[k].norm() * strain * (4 * operations * strain + (c.plastic_inverse.empty() ? 0 : 32));
    }
    return unit * (16 * magnitude + dt * dt * stresses);
}

double rounding_of_acceleration(const BodyForces& forces, const Configuration& c, std::span<const double> held,
                                const Field& inertial, double dt)
{
    const MeshlessBody& body = c.body;
    const std::vector<Mat9>& local = forces.local();
    const std::vector<double>& springs = forces.spring();
    const std::size_t n = body.size();
    std::vector<double> size(n), force(n);
    for (std::size_t i = 0; i < n; ++i) {
        size[i] = at(c.u, i).norm();
        const double inertia = body.mass[i] * (size[i] + at(inertial, i).norm()) / (dt * dt);
        force[i] = 4 * unit * (held[i] * at(c.x, i).norm() + inertia);
    }
    for (std::size_t k = 0; k < local.size(); ++k) {
        const double operations = 0.5 * (body.row[k + 1] - body.row[k]) + 8, spring = springs.empty() ? 0 : springs[k];
        double error = 0;
        for (std::uint32_t e = body.row[k]; e < body.row[k + 1]; ++e)
            error += body.d(e).norm() * (size[body.neighbour[e]] + size[k]);
        const double strain = matrix_at(c.strain, k).norm() + (c.plastic_inverse.empty() ? 0 : 1);
        const double stress = unit * local[k].norm() * (operations * error + 32 * strain);
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
        if (!forces.model().pinned[i])
            most = std::max(most, force[i] / body.mass[i]);
    return most;
}

double greatest_pull(const BodyForces& forces, const Field& u)
{
    const MeshlessBody& body = forces.model().body;
    const std::vector<double>& springs = forces.spring();
    std::vector<double> pull(body.size(), 0);
    for (std::size_t k = 0; 12 * k < forces.stress().size(); ++k)
        for (std::uint32_t e = body.row[k]; e < body.row[k + 1]; ++e) {
            Vec3 force = matrix_at(forces.stress(), k) * body.d(e);
            if (!springs.empty())
                force += springs[k] * body.kernel(e) * (at(u, k) - at(u, body.neighbour[e]));
            const double size = force.norm();
            pull[body.neighbour[e]] += size;
            pull[k] += size;
        }
    double most = 0;
    for (std::size_t i = 0; i < body.size(); ++i)
        if (!forces.model().pinned[i])
            most = std::max(most, pull[i] / body.mass[i]);
    return most;
}

} // namespace cinch
