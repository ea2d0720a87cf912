// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/simulation/step_figures.hpp"

#include <algorithm>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "cinch/deform.hpp"
#include "experiments/simulation/plain_step.hpp"
#include "toolkit/deform/motion.hpp"
#include "toolkit/deform/sample_nodes.hpp"
#include "toolkit/simulate/body_simulation.hpp"
#include "toolkit/simulate/effects/effects.hpp"
#include "toolkit/surface/shapes.hpp"
#include "toolkit/surface/triangle_mesh.hpp"

namespace cinch {
namespace {

constexpr double young = 1e5, poisson = 0.3, dt = 1e-5;
const Vec3 gravity(0, 0, -9.81);

StepFigures::Row measure_step(const TriangleMesh& mesh, std::size_t nodes, double support, double seconds)
{
    const SimulationNodes sampled = sample_nodes(mesh, nodes, 0);
    MeshlessOptions options;
    options.support_factor = support;
    const MeshlessBody body = discretise(sampled.position, cell_volumes(mesh, sampled.position), options);
    BodySimulation ours(body, {});
    ours.add(make_gravity(gravity));
    ours.add(make_neo_hookean(young, poisson));
    ours.add(make_hourglass(body, 1, young));
    PlainBody plain(body, gravity, young, poisson, 1);
    Integration integration;
    integration.method = Integration::Method::explicit_euler;
    integration.step_s = dt;
    constexpr int steps = 100; // between two estimates of the stable step, whose cost is so shared
    const RaceTimes times = race({[&] { ours.advance(steps * dt, integration); },
                                  [&] {
                                      for (int s = 0; s < steps; ++s)
                                          plain.step(dt);
                                  }},
                                 seconds);
    // The race runs either as often as it has time for: compare them after as many steps, anew.
    BodySimulation again(body, {});
    again.add(make_gravity(gravity));
    again.add(make_neo_hookean(young, poisson));
    again.add(make_hourglass(body, 1, young));
    PlainBody reference(body, gravity, young, poisson, 1);
    Field x = again.positions(), v = again.velocities();
    for (std::size_t i = 0; i < body.size(); ++i) {
        reference.x[i] = at(x, i) = Vec3(1.2, 0.9, 1).cwiseProduct(body.rest[i]);
        reference.v[i] = at(v, i) = 100 * body.rest[i].cross(Vec3(0.3, 1, 0.2));
    }
    again.place(x, v);
    again.advance(steps * dt, integration);
    double off = 0;
    for (int s = 0; s < steps; ++s)
        reference.step(dt);
    for (std::size_t i = 0; i < body.size(); ++i)
        off = std::max(off, (at(again.positions(), i) - reference.x[i]).norm());
    return {body.size(),
            static_cast<double>(body.neighbour.size()) / static_cast<double>(body.size()),
            1e-3 * times.of(0).value / steps,
            1e-3 * times.of(1).value / steps,
            times.ratio(1, 0),
            off};
}

void measure_evaluation(StepFigures& out, double seconds)
{
    DeformableSurface surface{brain(30000), {}};
    centre_and_scale(surface.mesh, 1.2);
    const SimulationNodes nodes = sample_nodes(surface.mesh, 509, 0);
    surface.weights = kernel_weights(surface.mesh, nodes, 2);
    const std::vector<AffineMap> maps = scripted_clip(*named_motion("strong"), nodes.position, 1).frame(0);
    const SurfaceEvaluator<double> evaluate(surface);
    const SurfaceEvaluator<float> evaluate_float(surface);
    struct EigenMap {
        Mat3 a;
        Vec3 t;
    };
    std::vector<EigenMap> eigen;
    for (const AffineMap& m : maps) {
        EigenMap e;
        for (int r = 0; r < 3; ++r) {
            for (int c = 0; c < 3; ++c)
                e.a(r, c) = m.m[r][c];
            e.t[r] = m.m[r][3];
        }
        eigen.push_back(e);
    }
    std::vector<Vec3> ours(surface.mesh.vertices.size()), plain = ours;
    const RaceTimes times = race({[&] { evaluate(maps, ours); }, [&] { evaluate_float(maps, ours); },
                                  [&] {
                                      for (std::size_t k = 0; k < plain.size(); ++k) {
                                          Vec3 sum = Vec3::Zero();
                                          const Weights::Row row = surface.weights.of(k);
                                          for (std::size_t e = 0; e < row.node.size(); ++e)
                                              sum += row.weight[e] * (eigen[row.node[e]].a * surface.mesh.vertices[k] +
                                                                      eigen[row.node[e]].t);
                                          plain[k] = sum;
                                      }
                                  }},
                                 seconds);
    out.evaluate_us = 1e-3 * times.of(0).value;
    out.evaluate_float_us = 1e-3 * times.of(1).value;
    out.evaluate_plain_us = 1e-3 * times.of(2).value;
    out.evaluate_ratio = times.ratio(2, 0);
    out.evaluate_float_ratio = times.ratio(2, 1);
}

} // namespace

StepFigures measure_steps(double seconds)
{
    StepFigures out;
    TriangleMesh mesh = brain(3500);
    centre_and_scale(mesh, 1);
    const double share = seconds / 9;
    std::vector<double> size, by_size, neighbours, by_neighbours;
    for (const std::size_t nodes : {128u, 256u, 509u, 1024u}) {
        out.rows.push_back(measure_step(mesh, nodes, 1.85, share));
        size.push_back(static_cast<double>(nodes) * out.rows.back().neighbours);
        by_size.push_back(out.rows.back().step_us);
    }
    for (const double support : {1.5, 1.85, 2.2, 2.6}) {
        out.rows.push_back(measure_step(mesh, 509, support, share));
        neighbours.push_back(out.rows.back().neighbours);
        by_neighbours.push_back(out.rows.back().step_us);
    }
    measure_evaluation(out, share);
    out.nodes_slope = log_slope(size, by_size);
    out.neighbours_slope = log_slope(neighbours, by_neighbours);
    const StepFigures::Row& reference = out.rows[2];
    double off = 0;
    for (const StepFigures::Row& row : out.rows)
        off = std::max(off, row.off);
    auto times = [](const Range& ratio) { return fmt::format("{:.2f}{}", ratio.value, mark(ratio)); };
    out.figures = {
        {fmt::format("plain Eigen / substep, {:.0f} neighbours", reference.neighbours), times(reference.ratio), ">= 5",
         at_least(reference.ratio, 5)},
        {"difference of the two after 100 steps, m", fmt::format("{:.0e}", off), "<= 1e-12", off <= 1e-12},
        {"exponent of nodes x neighbours", fmt::format("{:.2f}", out.nodes_slope), "<= 1.1", out.nodes_slope <= 1.1},
        {"exponent of neighbours at 509 nodes", fmt::format("{:.2f}", out.neighbours_slope), "<= 1.1",
         out.neighbours_slope <= 1.1},
        {"plain Eigen / surface in float, 30K", times(out.evaluate_float_ratio), ">= 4",
         at_least(out.evaluate_float_ratio, 4)},
        {"plain Eigen / surface in double, 30K", times(out.evaluate_ratio), ">= 4", at_least(out.evaluate_ratio, 4)}};
    return out;
}

} // namespace cinch
