// SPDX-License-Identifier: GPL-3.0-or-later
// A state is a value: what failed leaves no trace, and a copy has the future of the one that it was made of.
#include <catch2/catch.hpp>

#include <algorithm>
#include <atomic>
#include <sstream>
#include <stdexcept>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "tests/simulate/bodies.hpp"
#include "toolkit/simulate/simulation.hpp"

using namespace cinch;
using nlohmann::json;

namespace {

std::string bytes_of(const BodySimulation& s)
{
    std::ostringstream out;
    s.save(out);
    return out.str();
}

std::string bytes_of(const Simulation& s)
{
    std::ostringstream out;
    s.save(out);
    return out.str();
}

Integration integration(Integration::Method method)
{
    Integration how;
    how.method = method;
    how.step_s = 1e-3;
    return how;
}

constexpr Integration::Method both[] = {Integration::Method::implicit_euler, Integration::Method::explicit_euler};

// Slides over the ground and yields, with every effect that remembers.
BodySimulation sliding(std::function<Vec3(std::size_t, double)> target)
{
    const MeshlessBody body = test::lattice_body({1, 0.8, 0.6}, 4, 3, 3, {}, 0.2);
    BodySimulation s(body, {});
    s.add(make_gravity({0, 0, -9.81}));
    s.add(make_neo_hookean(1e4, 0.3));
    s.add(make_hourglass(body, 1, 1e4));
    s.add(make_viscosity(50));
    s.add(make_mass_damping(1));
    s.add(make_plasticity({0.005, 20, 2}));
    s.add(make_ground({Vec3(0, 0, -0.29), Vec3::UnitZ(), 1e5, 0.5, true}));
    s.add(make_pulling(body, PullingTarget{{0, 5, 9}, 100, std::move(target)}));
    Field v(4 * body.size(), 0);
    for (std::size_t i = 0; i < body.size(); ++i)
        at(v, i) = Vec3(1, 0.2, -0.5) + Vec3(0, 1, 0).cross(body.rest[i]);
    s.place(Vec3::Zero(), Mat3::Identity(), v);
    return s;
}

// How often it is asked whether it is cancelled, and from when on it is.
std::atomic<int> asked = 0, most = 0;
bool cancelled() { return ++asked > most; }

json two_boxes()
{
    return json::parse(R"({"duration": 1, "frame": 0.02, "integrator": {"step": 0.01}, "bodies": [
        {"name": "a", "surface": "box", "box": [1, 1, 1], "cells": [2, 2, 2], "lattice": [3, 3, 3],
         "velocity": [2, 0, -1]},
        {"name": "b", "surface": "box", "box": [1, 1, 1], "cells": [2, 2, 2], "lattice": [3, 3, 3],
         "position": [0.95, 0.1, 0.05]}],
        "effects": [{"effect": "elastic", "young": 1e4}, {"effect": "hourglass"},
                    {"effect": "viscosity", "viscosity": 10},
                    {"effect": "ground", "point": [0, 0, -0.48], "stiffness": 1e5, "friction": 0.4},
                    {"effect": "contact", "stiffness": 1e6}, {"effect": "plasticity", "yield": 0.005, "creep": 5}]})");
}

Simulation make(const json& scene) { return Simulation(parse_scene(scene.dump(), "s.json", "."), "s.json"); }

} // namespace

TEST_CASE("a call that fails in its midst leaves every later frame as if it had not been made")
{
    for (const auto method : both) {
        const bool is_explicit = method == Integration::Method::explicit_euler;
        CAPTURE(is_explicit);
        auto still = [](std::size_t, double) { return Vec3(0.2, 0, 0.3); };
        BodySimulation without = sliding(still), with = sliding(still);
        for (int frame = 0; frame < 6; ++frame) {
            if (frame == 3) {
                const std::string before = bytes_of(with);
                Integration stopped = integration(method);
                stopped.cancelled = cancelled;
                asked = 0;
                most = 5;
                const double frame_s = is_explicit ? 1.0 : 0.02;
                const StepReport report = with.advance(frame_s, stopped);
                CHECK(report.failure == "cancelled");
                CHECK(report.substeps >= 5); // it got somewhere
                CHECK(bytes_of(with) == before);
                CHECK(report.kinetic == with.kinetic());
            }
            REQUIRE(without.advance(0.02, integration(method)).failure.empty());
            REQUIRE(with.advance(0.02, integration(method)).failure.empty());
            REQUIRE(bytes_of(with) == bytes_of(without));
        }
        std::size_t rubbing = 0;
        for (const Memory& memory : with.state().memory)
            rubbing += !memory.values.empty();
        CHECK(rubbing == 3); // viscosity, damping and friction
        CHECK(with.plastic_inverse() != std::vector<Mat3>(with.body().size(), Mat3::Identity()));
    }
}

TEST_CASE("a call in which an effect or a pin throws leaves every later frame as if it had not been made")
{
    for (const auto method : both) {
        const bool is_explicit = method == Integration::Method::explicit_euler;
        CAPTURE(is_explicit);
        double from = 1e9; // time from which on it throws
        auto target = [&from](std::size_t, double t) {
            if (t > from)
                throw std::runtime_error("no target");
            return Vec3(0.2, 0, 0.3);
        };
        BodySimulation without = sliding(target), with = sliding(target);
        for (int frame = 0; frame < 6; ++frame) {
            if (frame == 3) {
                from = with.time_s() + 0.0107;
                CHECK_THROWS_WITH(with.advance(0.02, integration(method)), "no target");
                from = 1e9;
            }
            REQUIRE(without.advance(0.02, integration(method)).failure.empty());
            REQUIRE(with.advance(0.02, integration(method)).failure.empty());
            REQUIRE(bytes_of(with) == bytes_of(without));
        }
    }
}

TEST_CASE("a state that is given back continues to the same bits, and is that of its moment")
{
    for (const auto method : both) {
        BodySimulation s = sliding([](std::size_t, double) { return Vec3(0.2, 0, 0.3); });
        REQUIRE(s.advance(0.04, integration(method)).failure.empty());
        const BodyState middle = s.state();
        const std::string there = bytes_of(s);
        REQUIRE(s.advance(0.04, integration(method)).failure.empty());
        const std::string end = bytes_of(s);
        CHECK(end != there);
        s.set_state(middle);
        CHECK(bytes_of(s) == there);
        REQUIRE(s.advance(0.04, integration(method)).failure.empty());
        CHECK(bytes_of(s) == end);
    }
}

TEST_CASE("a scene in which one body fails goes on as if nothing had been tried, contacts and friction included")
{
    for (const char* method : {"implicit", "explicit"}) {
        json scene = two_boxes();
        scene["integrator"] = {{"method", method}, {"step", 0.005}};
        Simulation without = make(scene);
        Scene stopped = parse_scene(scene.dump(), "s.json", ".");
        stopped.integration.cancelled = cancelled;
        Simulation with(stopped, "s.json");
        for (int frame = 0; frame < 6; ++frame) {
            asked = 0;
            most = method == std::string("explicit") ? 1 : 3; // the second body, and either of them
            if (frame % 2 == 1) {
                const std::vector<StepReport> reports = with.advance();
                CHECK(std::any_of(reports.begin(), reports.end(),
                                  [](const StepReport& r) { return r.failure == "cancelled"; }));
                CHECK(with.frame() == without.frame());
                CHECK(bytes_of(with) == bytes_of(without));
            }
            most = 1000000;
            for (Simulation* s : {&without, &with})
                for (const StepReport& r : s->advance())
                    REQUIRE(r.failure.empty());
            REQUIRE(bytes_of(with) == bytes_of(without));
        }
    }
}

TEST_CASE("a checkpoint that is cut off changes nothing")
{
    Simulation s = make(two_boxes());
    s.advance();
    const std::string early = bytes_of(s);
    s.advance();
    const std::string late = bytes_of(s);
    for (std::size_t length = 0; length < early.size(); length += 97) {
        std::istringstream in(early.substr(0, length));
        s.restore(in);
        CHECK_FALSE(in);
        REQUIRE(bytes_of(s) == late);
    }
    std::istringstream in(early);
    s.restore(in);
    CHECK(in);
    CHECK(bytes_of(s) == early);
}
