// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "experiments/stability/stability.hpp"
#include "toolkit/deform/sample_nodes.hpp"
#include "toolkit/simulate/body_simulation.hpp"
#include "toolkit/simulate/effects/effects.hpp"
#include "toolkit/surface/shapes.hpp"

namespace cinch::stability_bodies {

inline std::vector<Vec3> lattice(const Vec3& size, int x, int y, int z)
{
    std::vector<Vec3> nodes;
    for (int i = 0; i < x; ++i)
        for (int j = 0; j < y; ++j)
            for (int k = 0; k < z; ++k)
                nodes.emplace_back(size[0] * ((i + 0.5) / x - 0.5), size[1] * ((j + 0.5) / y - 0.5),
                                   size[2] * ((k + 0.5) / z - 0.5));
    return nodes;
}

/// Nodes with the surface of a box around them (a sheet, if the box is flat) that they move.
inline BodySimulation body_in_box(const Vec3& size, const std::vector<Vec3>& nodes, const MeshlessOptions& options = {},
                                  double thickness = 0.01)
{
    DeformableSurface surface{box(size, {8, 4, 4}), {}};
    double fill = 0;
    for (const Vec3& v : surface.mesh.vertices) {
        double nearest = std::numeric_limits<double>::infinity();
        for (const Vec3& node : nodes)
            nearest = std::min(nearest, (v - node).norm());
        fill = std::max(fill, nearest);
    }
    surface.weights = kernel_weights(surface.mesh, {nodes, fill}, 2);
    const double volume = size[0] * size[1] * (size[2] > 0 ? size[2] : thickness);
    return {discretise(nodes, std::vector<double>(nodes.size(), volume / static_cast<double>(nodes.size())), options),
            std::move(surface)};
}

inline void add_elastic(BodySimulation& s, double young, Missing missing, double poisson = 0.3)
{
    s.add(make_neo_hookean(young, poisson));
    if (missing != Missing::hourglass)
        s.add(make_hourglass(s.body(), 1, young));
}

inline Integration implicit_steps(double step, Missing missing, double tolerance = 1e-5)
{
    Integration i;
    i.step_s = step;
    i.tolerance = tolerance;
    i.project = missing != Missing::projection;
    i.completion = missing == Missing::completion ? Completion::off : Completion::on;
    return i;
}
inline Integration explicit_steps(double longest)
{
    Integration i;
    i.method = Integration::Method::explicit_euler;
    i.step_s = longest;
    return i;
}

inline Field moved(const MeshlessBody& body, const Mat3& a, const Vec3& b)
{
    Field x(4 * body.size(), 0);
    for (std::size_t i = 0; i < body.size(); ++i)
        at(x, i) = a * body.rest[i] + b;
    return x;
}
inline void place(BodySimulation& s, const Mat3& a, const Vec3& b = Vec3::Zero())
{
    s.place(moved(s.body(), a, b), Field(4 * s.body().size(), 0));
}

inline bool is_finite(const BodySimulation& s)
{
    return whole(s.positions()).allFinite() && whole(s.velocities()).allFinite();
}

inline StabilityState state_of(BodySimulation& s) { return {*s.surface(), {s.frame()}}; }

/// Greatest distance of a node from where A x + b takes it.
inline double away(const BodySimulation& s, const Mat3& a, const Vec3& b)
{
    double most = 0;
    for (std::size_t i = 0; i < s.body().size(); ++i)
        most = std::max(most, (at(s.positions(), i) - (a * s.body().rest[i] + b)).norm());
    return most;
}

} // namespace cinch::stability_bodies
