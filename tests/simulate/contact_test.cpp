// SPDX-License-Identifier: GPL-3.0-or-later
// Contact between bodies: what lies inside, forces that are a derivative and opposite, impacts that keep momentum, runs
// that repeat.
#include <catch2/catch.hpp>

#include <algorithm>
#include <numeric>
#include <sstream>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>
#include <tbb/global_control.h>

#include "cinch/collider.hpp"
#include "cinch/deform.hpp"
#include "cinch/surface.hpp"
#include "toolkit/simulate/contact_search.hpp"
#include "toolkit/simulate/find_inside.hpp"
#include "toolkit/simulate/simulation.hpp"
#include "toolkit/surface/shapes.hpp"

#include "tests/simulate/bodies.hpp"
#include "tests/support.hpp"

using namespace cinch;
using nlohmann::json;

namespace {

// The convex mesh `m`, moved by `by`.
bool is_in_convex(const TriangleMesh& m, const Vec3& by, const Vec3& p)
{
    return std::all_of(m.triangles.begin(), m.triangles.end(), [&](const Triangle& t) {
        const Vec3 &a = m.vertices[t[0]], &b = m.vertices[t[1]], &c = m.vertices[t[2]];
        return (b - a).cross(c - a).dot(p - by - a) < 0;
    });
}

// Of two meshes that move rigidly, by one simulation node each.
std::vector<std::pair<std::uint32_t, std::uint32_t>> meeting(const TriangleMesh& a, const TriangleMesh& b,
                                                             const Vec3& by)
{
    auto surface = [](const TriangleMesh& mesh) {
        Weights rigid;
        rigid.node_count = 1;
        rigid.node.assign(mesh.vertices.size(), 0);
        rigid.weight.assign(mesh.vertices.size(), 1.0);
        rigid.row = std::vector<std::uint32_t>(mesh.vertices.size() + 1);
        std::iota(rigid.row.begin(), rigid.row.end(), 0);
        return DeformableSurface{mesh, rigid};
    };
    const DeformableSurface first = surface(a), second = surface(b);
    Collider collider(LazyOptions{});
    collider.add(build_bvh(first, ClusterSize{16, 16}), first);
    collider.add(build_bvh(second, ClusterSize{16, 16}), second);
    AffineMap moved = identity_map;
    for (int r = 0; r < 3; ++r)
        moved.m[static_cast<std::size_t>(r)][3] = by[r];
    const BodyFrame frames[] = {{std::span(&identity_map, 1)}, {std::span(&moved, 1)}};
    collider.update(frames);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (const TrianglePair& p : collider.pairs())
        pairs.emplace_back(p.triangle_a, p.triangle_b);
    return pairs;
}

json two_boxes()
{
    return json::parse(
        R"({"name": "impact", "duration": 0.5, "frame": 0.01, "integrator": {"method": "implicit", "step": 0.01},
        "bodies": [{"name": "a", "surface": "box", "box": [1, 1, 1], "cells": [8, 8, 8], "lattice": [3, 3, 3],
                    "position": [-0.7, 0, 0], "velocity": [2, 0, 0]},
                   {"name": "b", "surface": "box", "box": [1, 1, 1], "cells": [7, 7, 7], "lattice": [3, 3, 3],
                    "position": [0.7, 0.05, 0.03], "velocity": [-2, 0, 0]}],
        "effects": [{"effect": "elastic", "young": 3e5, "poisson": 0.3}, {"effect": "hourglass"},
                    {"effect": "contact", "stiffness": 1e7}]})");
}

Simulation make(const json& scene) { return Simulation(parse_scene(scene.dump(), "s.json", "."), "s.json"); }

std::string state_of(const Simulation& s)
{
    std::ostringstream out;
    s.save(out);
    return out.str();
}

Vec3 momentum(const BodySimulation& s)
{
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < s.body().size(); ++i)
        sum += s.body().mass[i] * at(s.velocities(), i);
    return sum;
}

double mass(const BodySimulation& s)
{
    double sum = 0;
    for (const double m : s.body().mass)
        sum += m;
    return sum;
}

ContactSearch& search_of(Simulation& s) { return dynamic_cast<ContactSearch&>(*s.couplings()[0]); }
std::size_t pairs(Simulation& s) { return search_of(s).pairs(); }

} // namespace

TEST_CASE("vertices inside a convex surface are those behind all its planes, deep ones too, and their closest points "
          "lie on it")
{
    TriangleMesh cube = box(Vec3(1, 1, 1), {6, 6, 6}), ball = ring_sphere(600);
    for (Vec3& v : ball.vertices)
        v *= 0.6;
    const TrianglesAround around_cube(cube), around_ball(ball);
    std::size_t found = 0;
    for (const Vec3& by : {Vec3(0.9, 0.1, 0.07), Vec3(0.5, 0.4, 0.3), Vec3(0.03, 0.31, -0.52), Vec3(0.3, 0.2, 0.1)}) {
        std::vector<Vec3> moved = ball.vertices;
        for (Vec3& v : moved)
            v += by;
        const auto pairs = meeting(cube, ball, by);
        REQUIRE_FALSE(pairs.empty());
        for (const double side : {1.0, -1.0}) { // inside out too
            TriangleMesh turned = ball;
            if (side < 0)
                for (Triangle& t : turned.triangles)
                    std::swap(t[1], t[2]);
            const PosedSurface a{cube, around_cube, cube.vertices, 1}, b{turned, around_ball, moved, side};
            std::vector<bool> inside(cube.vertices.size(), false);
            for (const InsideVertex& v : find_inside(a, b, pairs)) {
                CHECK_FALSE(inside[v.vertex]);
                inside[v.vertex] = true;
                const Triangle& t = turned.triangles[v.triangle];
                const Vec3 q = v.share[0] * moved[t[0]] + v.share[1] * moved[t[1]] + v.share[2] * moved[t[2]];
                double closest = 1e9; // over the corners, which the walk may not beat by much
                for (const Vec3& p : moved)
                    closest = std::min(closest, (p - cube.vertices[v.vertex]).norm());
                CHECK((q - cube.vertices[v.vertex]).norm() <= closest);
                CHECK(v.share[0] + v.share[1] + v.share[2] == Approx(1));
                ++found;
            }
            for (std::size_t k = 0; k < cube.vertices.size(); ++k)
                CHECK(inside[k] == is_in_convex(ball, by, cube.vertices[k]));
        }
    }
    CHECK(found > 200);
}

TEST_CASE("contact forces are the derivative of their energy, their product is that of the forces, and both bodies' "
          "add up to nothing")
{
    Simulation s = make(two_boxes());
    while (pairs(s) == 0)
        for (const StepReport& r : s.advance())
            REQUIRE(r.failure.empty());
    search_of(s).find(); // for the configuration as it is
    const std::size_t slot = s.bodies()[0].simulation.effects().size() - 1;
    Vec3 sum = Vec3::Zero();
    double size = 0;
    for (Simulation::Body& body : s.bodies()) {
        const Field f = body.simulation.forces(slot);
        sum += test::total(f);
        size += test::total(f).norm();
    }
    CHECK(size > 1);
    CHECK(sum.norm() <= 1e-9 * size);

    BodySimulation& body = s.bodies()[0].simulation;
    const Field x = body.positions(), v = body.velocities();
    auto energy = [&](const Field& y) {
        body.place(y, v);
        return test::energy_at(body, slot, y);
    };
    const Field f = body.forces(slot);
    double scale = 0;
    for (const double value : f)
        scale = std::max(scale, std::abs(value));
    Field direction(x.size(), 0);
    for (std::size_t i = 0; i < x.size(); ++i) {
        if (i % 4 == 3)
            continue;
        direction[i] = std::sin(static_cast<double>(i));
        Field up = x, down = x;
        up[i] += 1e-6;
        down[i] -= 1e-6;
        CHECK(std::abs((energy(up) - energy(down)) / 2e-6 + f[i]) <= 1e-5 * scale);
    }
    body.place(x, v);
}

TEST_CASE("an impact in free space keeps momentum, turns the bodies around, and without contact they pass")
{
    for (const char* method : {"implicit", "explicit"}) {
        INFO(method);
        json scene = two_boxes();
        scene["integrator"] = {{"method", method}, {"step", 0.01}};
        Simulation s = make(scene);
        const double m = mass(s.bodies()[0].simulation);
        std::size_t deepest = 0;
        while (s.frame() + 1 < s.frame_count()) {
            for (const StepReport& r : s.advance())
                REQUIRE(r.failure.empty());
            deepest = std::max(deepest, pairs(s));
        }
        CHECK(deepest > 0);
        CHECK(pairs(s) == 0); // apart again
        const Vec3 a = momentum(s.bodies()[0].simulation), b = momentum(s.bodies()[1].simulation);
        CHECK(a[0] < -0.3 * 2 * m);
        CHECK(b[0] > 0.3 * 2 * m);
        CHECK((a + b).norm() < 0.1 * 2 * m); // opposite and equal when a frame begins, not quite through it

        scene["effects"].erase(2);
        Simulation through = make(scene);
        CHECK(through.bodies()[0].simulation.effects().size() == s.bodies()[0].simulation.effects().size() - 1);
        CHECK(through.couplings().empty());
        while (through.frame() + 1 < through.frame_count())
            through.advance();
        CHECK(momentum(through.bodies()[0].simulation)[0] == Approx(2 * m));
    }
}

TEST_CASE("a run with contact is the same for any number of threads, and after a checkpoint in the midst of an impact")
{
    for (const char* method : {"implicit", "explicit"}) {
        json scene = two_boxes();
        scene["duration"] = 0.25;
        scene["integrator"] = {{"method", method}, {"step", 0.01}};
        Simulation whole = make(scene);
        std::string middle;
        while (whole.frame() + 1 < whole.frame_count()) {
            whole.advance();
            if (middle.empty() && pairs(whole) > 0)
                middle = state_of(whole);
        }
        REQUIRE_FALSE(middle.empty());
        {
            const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
            Simulation alone = make(scene);
            while (alone.frame() + 1 < alone.frame_count())
                alone.advance();
            CHECK(state_of(alone) == state_of(whole));
        }
        Simulation rest = make(scene);
        std::istringstream in(middle);
        rest.restore(in);
        while (rest.frame() + 1 < rest.frame_count())
            rest.advance();
        CHECK(state_of(rest) == state_of(whole));
    }
}

TEST_CASE("contact needs two bodies and a stiffness above 0")
{
    auto complaint = [](const json& scene) {
        try {
            make(scene);
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    json scene = two_boxes();
    REQUIRE(complaint(scene).empty());
    scene["effects"][2]["bodies"] = {"a"};
    CHECK(complaint(scene) == "s.json: /effects/2: needs at least two bodies");
    scene = two_boxes();
    scene["effects"][2]["stiffness"] = 0;
    CHECK(complaint(scene) == "s.json: /effects/2/stiffness: expected a number > 0, found 0");
    scene["effects"][2].erase("stiffness");
    CHECK(complaint(scene) == "s.json: /effects/2/stiffness: is missing");
}
