// SPDX-License-Identifier: GPL-3.0-or-later
// Hard arrangements of simulation nodes and weights.
#include <numbers>

#include "cinch/surface.hpp"
#include "experiments/stability/bodies.hpp"

namespace cinch {
namespace {

using namespace stability_bodies;

// The greatest force, over rotations, on nodes that are turned as a rigid body; in units of E V^(2/3).
StabilityOutcome turned(BodySimulation s, double young, Missing missing)
{
    double volume = 0, most = 0;
    for (const double v : s.body().volume)
        volume += v;
    StabilityOutcome out;
    for (const double angle : {0.5, 1.6, 3.1}) {
        place(s, Eigen::AngleAxisd(angle, Vec3(1, 2, 3).normalized()).toRotationMatrix(), {1, 0, 0});
        s.advance(0, implicit_steps(1, missing));
        most = std::max(most, whole(s.forces()).lpNorm<Eigen::Infinity>() / (young * std::pow(volume, 2.0 / 3)));
        out.states.push_back(state_of(s));
    }
    out.pass = most < 1e-10;
    out.observed = fmt::format("greatest force {:.1e} E V^(2/3)", most);
    return out;
}

StabilityOutcome coplanar(Missing missing)
{
    BodySimulation s = body_in_box({1, 1, 0}, lattice({1, 1, 0}, 7, 7, 1));
    add_elastic(s, 1e5, missing);
    return turned(std::move(s), 1e5, missing);
}

StabilityOutcome collinear(Missing missing)
{
    BodySimulation s = body_in_box({1, 0.1, 0.1}, lattice({1, 0, 0}, 12, 1, 1));
    add_elastic(s, 1e5, missing);
    return turned(std::move(s), 1e5, missing);
}

StabilityOutcome coincident(Missing missing)
{
    std::vector<Vec3> nodes = lattice({1, 0.5, 0.5}, 4, 2, 2);
    for (std::size_t i = 0; i < 16; i += 3)
        nodes.push_back(nodes[i]);
    BodySimulation s = body_in_box({1, 0.5, 0.5}, nodes);
    add_elastic(s, 1e4, missing);
    s.add(make_gravity({0, 0, -9.81}));
    const StepReport r = s.advance(0.5, implicit_steps(1.0 / 60, missing));
    StabilityOutcome out;
    out.pass = r.failure.empty() && is_finite(s) && s.body().notes.size() == 1;
    out.observed =
        s.body().notes.empty() ? "no warning" : s.body().notes[0] + (is_finite(s) ? "; finite" : "; not finite");
    out.states.push_back(state_of(s));
    return out;
}

StabilityOutcome isolated(Missing missing)
{
    std::vector<Vec3> nodes = lattice({1, 0.5, 0.5}, 4, 2, 2);
    nodes.emplace_back(30, 0, 0);
    MeshlessOptions options;
    options.support_radius = 0.6;
    BodySimulation s = body_in_box({1, 0.5, 0.5}, nodes, options);
    add_elastic(s, 1e4, missing);
    s.add(make_gravity({0, 0, -10}));
    Field x = moved(s.body(), Mat3::Identity(), Vec3::Zero()), v(x.size(), 0);
    at(v, 16) = Vec3(1, 2, 3);
    s.place(x, v);
    const int steps = 50;
    const double dt = 0.01;
    Integration exact = implicit_steps(dt, missing, 1e-9);
    const StepReport r = s.advance(steps * dt, exact);
    // Implicit Euler of a free fall: x0 + v t + g Δt² n (n + 1) / 2.
    const Vec3 expected =
        Vec3(30, 0, 0) + steps * dt * Vec3(1, 2, 3) + 0.5 * dt * dt * steps * (steps + 1) * Vec3(0, 0, -10);
    const double off = (at(s.positions(), 16) - expected).norm();
    const auto& map = s.frame()[16].m;
    bool identity = true;
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
            identity &= map[a][b] == (a == b);
    StabilityOutcome out;
    out.pass = r.failure.empty() && off < 1e-9 && identity && s.body().rank[16] == 0;
    out.observed = fmt::format("J = I: {}; off its parabola by {:.0e} m", identity ? "yes" : "no", off);
    out.states.push_back(state_of(s));
    return out;
}

StabilityOutcome few_nodes(Missing missing)
{
    StabilityOutcome out;
    out.pass = true;
    for (const std::size_t n : {1u, 2u, 3u, 5u, 9u}) {
        std::vector<Vec3> nodes = lattice({1, 0.6, 0.4}, 3, 3, 1);
        nodes.resize(n);
        BodySimulation s = body_in_box({1, 0.6, 0.4}, nodes);
        add_elastic(s, 1e4, missing);
        s.add(make_gravity({0, 0, -9.81}));
        const StepReport r = s.advance(0.5, implicit_steps(1.0 / 60, missing));
        bool finite =
            r.failure.empty() && is_finite(s) && std::isfinite(s.body().support[0]) && s.body().support[0] > 0;
        if (n == 1) // falls as a whole
            finite &= std::abs(at(s.positions(), 0)[2] - s.body().rest[0][2] + 9.81 * 30 * 31 / 2 / 3600) < 1e-9;
        out.pass &= finite;
        out.observed += fmt::format("{}n = {} {}", out.observed.empty() ? "" : ", ", n, finite ? "falls" : "FAILS");
        out.states.push_back(state_of(s));
    }
    return out;
}

StabilityOutcome beyond_supports(Missing)
{
    DeformableSurface surface;
    surface.mesh.vertices = {{0, 0, 0}, {0.1, 0, 0}, {5, 0, 0}, {0, -7, 0}};
    surface.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    std::size_t alone = 0;
    surface.weights = kernel_weights(surface.mesh, {{{0, 0, 0}, {1, 0, 0}}, 0.5}, 2, &alone);
    StabilityOutcome out;
    const Weights::Row far = surface.weights.of(2);
    out.pass = alone == 2 && far.node.size() == 1 && far.node[0] == 1 && far.weight[0] == 1;
    out.observed = fmt::format("{} counted; weight {} of node {}", alone, far.weight[0], far.node[0]);
    out.states.push_back({surface, {{identity_map, identity_map}}});
    return out;
}

StabilityOutcome one_support(Missing)
{
    TriangleMesh mesh = box({1, 1, 1}, {4, 4, 4});
    const Weights weights = kernel_weights(mesh, {{{0.1, 0.2, 0.3}}, 1.0 / 3}, 7);
    StabilityOutcome out;
    out.pass = true;
    for (const double w : weights.weight)
        out.pass &= w == 1;
    out.pass &= weights.weight.size() == mesh.vertices.size();
    out.observed = out.pass ? "every weight is 1" : "a weight is not 1";
    out.states.push_back({{mesh, weights}, {{AffineMap{{{0.3, 0.1, 0, 5}, {0, 1.0 / 3, 0.2, 1}, {0, 0, 1.1, 0}}}}}});
    return out;
}

StabilityOutcome underflowing_weights(Missing)
{
    Influences in;
    in.node_count = 3;
    in.row = {0, 2, 4, 7};
    in.node = {0, 1, 0, 1, 0, 1, 2};
    in.weight = {5e-324, 5e-324, 1, 1e-300, 3e-310, 1e-310, 1e-320};
    DeformableSurface surface;
    surface.mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    surface.mesh.triangles = {{0, 1, 2}};
    surface.weights = to_dyadic(in);
    StabilityOutcome out;
    out.pass = true;
    for (std::size_t k = 0; k < 3; ++k) {
        double sum = 0;
        for (const double w : surface.weights.of(k).weight) {
            sum += w;
            out.pass &= w >= 0x1p-53;
        }
        out.pass &= sum == 1;
    }
    out.pass &= surface.weights.of(0).weight[0] == 0.5 && surface.weights.of(1).weight.size() == 1 &&
                std::abs(surface.weights.of(2).weight[0] - 0.75) < 1e-10;
    out.observed =
        fmt::format("{} | {} | {:.3f} {:.3f}", surface.weights.of(0).weight[0], surface.weights.of(1).weight[0],
                    surface.weights.of(2).weight[0], surface.weights.of(2).weight[1]);
    out.states.push_back(
        {surface, {{identity_map, AffineMap{{{0, 1, 0, 1}, {1, 0, 0, 1}, {0, 0, 2, 1}}}, identity_map}}});
    return out;
}

// Power-of-two scales change no bit of what has no unit.
StabilityOutcome scales(Missing)
{
    const std::vector<Vec3> nodes = lattice({1, 0.7, 0.4}, 4, 3, 3);
    const MeshlessBody unit = discretise(nodes, {}, {});
    StabilityOutcome out;
    bool same = true;
    for (const int power : {-300, 300}) {
        std::vector<Vec3> scaled = nodes;
        for (Vec3& p : scaled)
            p *= std::ldexp(1.0, power);
        const MeshlessBody body = discretise(scaled, {}, {});
        for (std::size_t e = 0; e < unit.neighbour.size(); ++e) {
            same &= body.kernel(e) == unit.kernel(e);
            for (int r = 0; r < 3; ++r)
                same &= std::ldexp(body.d(e)[r], power) == unit.d(e)[r];
        }
    }
    int refused = 0;
    for (const double size : {1e-300, 1e300}) {
        std::vector<Vec3> scaled = nodes;
        for (Vec3& p : scaled)
            p *= size;
        try {
            discretise(scaled, {}, {});
        } catch (const std::invalid_argument&) {
            ++refused; // their volumes are no doubles
        }
    }
    out.pass = same && refused == 2;
    out.observed =
        fmt::format("2^±300 {}; 1e±300 {}", same ? "the same bits" : "DIFFERS", refused == 2 ? "refused" : "ACCEPTED");
    return out;
}

StabilityOutcome checkerboard(Missing missing)
{
    // Nodal integration hardly sees a field that alternates from node to node: compare its stiffness per mass to that
    // of a smooth shear.
    BodySimulation s = body_in_box({1, 1, 1}, lattice({1, 1, 1}, 8, 8, 8));
    add_elastic(s, 1e5, missing);
    auto quotient = [&](auto&& field) {
        Field u(4 * s.body().size(), 0);
        double mass = 0;
        for (std::size_t i = 0; i < s.body().size(); ++i) {
            at(u, i)[0] = field(s.body().rest[i]);
            mass += s.body().mass[i] * at(u, i).squaredNorm();
        }
        return whole(u).dot(whole(s.stiffness(u))) / mass;
    };
    const double smooth = quotient([](const Vec3& p) { return std::sin(std::numbers::pi * p[1]); });
    const double alternating =
        quotient([](const Vec3& p) { return std::lround(8 * (p[0] + p[1] + p[2]) + 12) % 2 ? 1.0 : -1.0; });
    StabilityOutcome out;
    out.pass = alternating > 10 * smooth;
    out.observed = fmt::format("{:.1f} times", alternating / smooth);
    return out;
}

} // namespace

std::vector<StabilityCase> model_cases()
{
    return {{"01 coplanar nodes", "turning creates no force (< 1e-10 E V^(2/3))", coplanar},
            {"01 collinear nodes", "turning creates no force (< 1e-10 E V^(2/3))", collinear},
            {"02 coincident nodes", "finite, with a warning", coincident},
            {"03 isolated node", "J = I, and it falls freely", isolated},
            {"04 fewer than 10 nodes", "1, 2, 3, 5, 9 nodes fall, finite", few_nodes},
            {"05 vertex outside supports", "its nearest node with weight 1, counted", beyond_supports},
            {"06 one node's support", "weight 1 exactly", one_support},
            {"07 weights that underflow", "scaled first, dropped below 2^-53, sum 1", underflowing_weights},
            {"16 scales of the model", "ratios without unit keep their bits", scales},
            {"36 alternating motion", "over 10 times as stiff as a smooth shear", checkerboard}};
}

} // namespace cinch
