// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <random>

#include "toolkit/simulate/body_simulation.hpp"
#include "toolkit/simulate/effects/effects.hpp"

namespace cinch::test {

/// Nodes at the centres of the cells of a box about the origin; `jitter` moves them by so much of a cell.
inline MeshlessBody lattice_body(const Vec3& size, int x, int y, int z, const MeshlessOptions& options = {},
                                 double jitter = 0)
{
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> uniform(-jitter, jitter);
    std::vector<Vec3> nodes;
    for (int i = 0; i < x; ++i)
        for (int j = 0; j < y; ++j)
            for (int k = 0; k < z; ++k)
                nodes.emplace_back(size[0] * ((i + 0.5 + uniform(random)) / x - 0.5),
                                   size[1] * ((j + 0.5 + uniform(random)) / y - 0.5),
                                   z == 1 && size[2] == 0 ? 0 : size[2] * ((k + 0.5 + uniform(random)) / z - 0.5));
    const double volume = size[0] * size[1] * (size[2] > 0 ? size[2] : 0.01);
    return discretise(nodes, std::vector<double>(nodes.size(), volume / static_cast<double>(nodes.size())), options);
}

/// Positions at rest moved by x ↦ A x + b, and by up to `noise` at random.
inline Field moved(const MeshlessBody& body, const Mat3& a, const Vec3& b, double noise, std::uint64_t seed)
{
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(-noise, noise);
    Field x(4 * body.size(), 0);
    for (std::size_t i = 0; i < body.size(); ++i)
        at(x, i) = a * body.rest[i] + b + Vec3(uniform(random), uniform(random), uniform(random));
    return x;
}

/// The energy of one effect of a body, at present, with the nodes at `x` instead; what dissipates included.
inline double energy_at(const BodySimulation& simulation, std::size_t effect, const Field& x)
{
    const MeshlessBody& body = simulation.body();
    MatrixField d, h, j;
    Field u = x;
    for (std::size_t i = 0; i < body.size(); ++i)
        at(u, i) -= body.rest[i];
    const Reference reference;
    measure(body, reference.rotation, u, Completion::on, d, h, j);
    const DeformableSurface* surface = simulation.surface() ? &*simulation.surface() : nullptr;
    return simulation.effects()[effect]->energy({.body = body,
                                                 .surface = surface,
                                                 .reference = reference,
                                                 .x = x,
                                                 .u = u,
                                                 .gradient = d,
                                                 .strain = h,
                                                 .deformation = j,
                                                 .plastic_inverse = simulation.plastic_inverse(),
                                                 .time_s = simulation.time_s(),
                                                 .memory = simulation.state().memory,
                                                 .effect = effect});
}

inline Vec3 total(const Field& f)
{
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < f.size() / 4; ++i)
        sum += at(f, i);
    return sum;
}

} // namespace cinch::test
