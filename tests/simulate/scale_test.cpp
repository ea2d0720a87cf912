// SPDX-License-Identifier: GPL-3.0-or-later
// A motion does not depend on the units in which a scene is written, nor on where it is.
#include <catch2/catch.hpp>

#include <nlohmann/json.hpp>

#include "tests/simulate/bodies.hpp"
#include "tests/support.hpp"
#include "toolkit/simulate/contact_search.hpp"
#include "toolkit/simulate/simulation.hpp"

using namespace cinch;
using json = nlohmann::json;

namespace {

struct Units {
    double length = 1, time = 1, mass = 1;
};

json scaled(const json& value, double factor)
{
    if (value.is_number())
        return value.get<double>() * factor;
    json out = json::array();
    for (const json& part : value)
        out.push_back(scaled(part, factor));
    return out;
}

// Multiplies the fields of an object by the factors of their dimensions.
void scale(json& object, const std::vector<std::pair<const char*, double>>& factors)
{
    for (const auto& [name, factor] : factors)
        if (object.contains(name))
            object[name] = scaled(object[name], factor);
}

json in_units(json scene, const Units& u)
{
    const double l = u.length, t = u.time, m = u.mass, pressure = m / l / t / t;
    scale(scene, {{"duration", t}, {"frame", t}});
    scale(scene["integrator"], {{"step", t}});
    for (json& body : scene["bodies"])
        scale(body, {{"box", l},
                     {"size", l},
                     {"thickness", l},
                     {"position", l},
                     {"velocity", l / t},
                     {"spin", 1 / t},
                     {"density", m / l / l / l}});
    for (json& effect : scene["effects"]) {
        const std::string name = effect["effect"];
        const double stiffness = name == "volume" ? pressure : name == "contact" ? pressure / l : m / t / t;
        scale(effect, {{"acceleration", l / t / t},
                       {"young", pressure},
                       {"viscosity", pressure * t},
                       {"rate", 1 / t},
                       {"stiffness", stiffness},
                       {"point", l},
                       {"force", m * l / t / t},
                       {"period", t},
                       {"start", t},
                       {"end", t},
                       {"ramp", t},
                       {"offset", l},
                       {"creep", 1 / t},
                       {"centre", l},
                       {"velocity", l / t}});
        if (effect.contains("nodes"))
            scale(effect["nodes"], {{"box", l}});
    }
    return scene;
}

json box_body(const char* name, const json& extra)
{
    json body = {{"name", name},       {"surface", "box"},     {"box", {0.75, 0.5, 0.5}},
                 {"cells", {6, 4, 4}}, {"lattice", {4, 3, 3}}, {"density", 1000}};
    body.update(extra);
    return body;
}

// A pair that falls on the ground, slides and meets; a bar that is held, pulled and flows; a sheet in a spin; a single
// node; a body with nodes sampled in it.
json everything(const std::string& method)
{
    json integrator = {{"method", method}, {"step", 0.015625}};
    if (method == "implicit")
        integrator["tolerance"] = 1e-7; // what may differ is what rounding makes of it
    return {{"duration", 0.25},
            {"frame", 0.03125},
            {"integrator", integrator},
            {"bodies",
             {box_body("low", {{"position", {0, 0, 0.3125}}, {"velocity", {0.5, 0, -1}}}),
              box_body("high", {{"position", {0.125, 0.0625, 0.9375}},
                                {"velocity", {0, 0, -2}},
                                {"spin", {0.5, 1, 0}},
                                {"rotation", {{"axis", {1, 2, 3}}, {"degrees", 30}}}}),
              box_body("bar", {{"position", {4, 0, 4}}}),
              {{"name", "sheet"},
               {"surface", "sheet"},
               {"box", {1, 1, 0}},
               {"cells", {4, 4, 1}},
               {"lattice", {5, 5, 1}},
               {"thickness", 0.03125},
               {"density", 1000},
               {"position", {0, 8, 4}},
               {"spin", {1, 2, 3}}},
              {{"name", "one"},
               {"surface", "box"},
               {"box", {0.5, 0.5, 0.5}},
               {"cells", {1, 1, 1}},
               {"lattice", {1, 1, 1}},
               {"density", 1000},
               {"position", {-8, 0, 0.25}},
               {"velocity", {1, 0, 0}}},
              {{"name", "sampled"},
               {"surface", "box"},
               {"box", {0.75, 0.5, 0.5}},
               {"cells", {6, 4, 4}},
               {"nodes", 24},
               {"density", 1000},
               {"position", {0, -8, 1}},
               {"spin", {1, 2, 0}}}}},
            {"effects",
             {{{"effect", "gravity"}, {"acceleration", {0, 0, -9.81}}},
              {{"effect", "elastic"}, {"young", 1e5}},
              {{"effect", "hourglass"}},
              {{"effect", "volume"}, {"stiffness", 2e4}},
              {{"effect", "viscosity"}, {"viscosity", 100}},
              {{"effect", "damping"}, {"rate", 0.5}},
              {{"effect", "ground"}, {"stiffness", 1e6}, {"friction", 0.5}, {"point", {0, 0, 0}}},
              {{"effect", "contact"}, {"stiffness", 3e6}, {"bodies", {"low", "high"}}},
              {{"effect", "plasticity"}, {"bodies", {"bar"}}, {"yield", 0.02}, {"creep", 20}},
              {{"effect", "pinned"}, {"bodies", {"bar"}}, {"nodes", {{"box", {{-1, -1, -1}, {-0.25, 1, 1}}}}}},
              {{"effect", "pulling"},
               {"bodies", {"bar"}},
               {"nodes", {{"box", {{0.25, -1, -1}, {1, 1, 1}}}}},
               {"force", {900, 0, 0}},
               {"period", 1}},
              {{"effect", "pulling"},
               {"bodies", {"sheet"}},
               {"nodes", {{"box", {{-1, -1, -1}, {-0.25, 1, 1}}}}},
               {"stiffness", 500},
               {"offset", {0, 0, 0.5}},
               {"ramp", 0.25}}}}};
}

struct Motion {
    std::vector<Field> positions; ///< of every body after every frame
    std::string failure;
};

Motion run(const json& scene)
{
    Simulation s(parse_scene(scene.dump(), "scene", "."), "scene");
    Motion out;
    while (s.frame() + 1 < s.frame_count() && out.failure.empty()) {
        for (const StepReport& r : s.advance())
            if (!r.failure.empty())
                out.failure = r.failure;
        for (const Simulation::Body& body : s.bodies())
            out.positions.push_back(body.simulation.positions());
    }
    return out;
}

double difference(const Motion& a, const Motion& b, double length)
{
    double most = 0, size = 0;
    for (std::size_t k = 0; k < a.positions.size(); ++k) {
        most = std::max(most, (whole(a.positions[k]) - whole(b.positions[k]) / length).lpNorm<Eigen::Infinity>());
        size = std::max(size, whole(a.positions[k]).lpNorm<Eigen::Infinity>());
    }
    return most / size;
}

} // namespace

TEST_CASE("scenes in units that are powers of two give the same bits, whatever acts, by both integrators")
{
    for (const std::string method : {"implicit", "explicit"}) {
        const json scene = everything(method);
        const Motion one = run(scene);
        REQUIRE(one.failure == "");
        const double big = 0x1p30, small = 0x1p-30;
        const Units units[] = {{small, big, small}, {big, small, small}, {big, 1, 1}, {small, 1, 1},
                               {1, big, 1},         {1, small, 1},       {1, 1, big}, {1, 1, small}};
        for (const Units& u : test::share_of(units)) {
            INFO(method << ": length " << u.length << ", time " << u.time << ", mass " << u.mass);
            const Motion other = run(in_units(scene, u));
            REQUIRE(other.failure == "");
            CHECK(difference(one, other, u.length) == 0);
        }
    }
}

TEST_CASE("scenes scaled by 1e-9 to 1e9 in length, time and mass give the same motion")
{
    for (const std::string method : {"implicit", "explicit"}) {
        const json scene = everything(method);
        const Motion one = run(scene);
        REQUIRE(one.failure == "");
        const Units units[] = {{1e-9, 1e9, 1e-9}, {1e3, 1e-5, 1e7}, {1e9, 1, 1},  {1e-9, 1, 1},       {1, 1e9, 1},
                               {1, 1e-9, 1},      {1, 1, 1e9},      {1, 1, 1e-9}, {1e-9, 1e-9, 1e-9}, {1e9, 1e9, 1e9}};
        for (const Units& u : test::share_of(units)) {
            INFO(method << ": length " << u.length << ", time " << u.time << ", mass " << u.mass);
            const Motion other = run(in_units(scene, u));
            REQUIRE(other.failure == "");
            CHECK(difference(one, other, u.length) < 1e-9);
        }
    }
}

TEST_CASE("a body moves far away as it does here")
{
    const json here = {{"duration", 0.25},
                       {"frame", 0.015625},
                       {"integrator", {{"method", "implicit"}, {"tolerance", 1e-9}}},
                       {"bodies",
                        {box_body("low", {{"position", {0, 0, 0.3125}}, {"velocity", {0.5, 0, -1}}}),
                         box_body("high", {{"position", {0.125, 0.0625, 0.9375}},
                                           {"velocity", {0, 0, -2}},
                                           {"rotation", {{"axis", {1, 2, 3}}, {"degrees", 30}}}}),
                         box_body("bar", {{"position", {4, 0, 4}}})}},
                       {"effects",
                        {{{"effect", "gravity"}},
                         {{"effect", "elastic"}, {"young", 1e5}},
                         {{"effect", "hourglass"}},
                         {{"effect", "damping"}, {"rate", 0.5}},
                         {{"effect", "ground"}, {"stiffness", 1e6}, {"friction", 0.5}, {"point", {0, 0, 0}}},
                         {{"effect", "contact"}, {"stiffness", 3e6}, {"bodies", {"low", "high"}}},
                         {{"effect", "scripted"},
                          {"bodies", {"bar"}},
                          {"nodes", {{"box", {{-1, -1, -1}, {-0.25, 1, 1}}}}},
                          {"axis", {1, 0, 0}},
                          {"centre", {4, 0, 4}},
                          {"rate", 3}},
                         {{"effect", "pulling"},
                          {"bodies", {"bar"}},
                          {"nodes", {{"box", {{0.25, -1, -1}, {1, 1, 1}}}}},
                          {"stiffness", 2000},
                          {"offset", {0, 0, 0.5}}}}}};
    const Vec3 far(0x1p40, -0x1p40, 0x1p39); // about 1e12 m: doubles are 1e-4 m apart there
    json there = here;
    for (json& body : there["bodies"])
        for (std::size_t r = 0; r < 3; ++r)
            body["position"][r] = body["position"][r].get<double>() + far[static_cast<Eigen::Index>(r)];
    for (json& effect : there["effects"])
        for (const char* name : {"point", "centre"})
            for (std::size_t r = 0; effect.contains(name) && r < 3; ++r)
                effect[name][r] = effect[name][r].get<double>() + far[static_cast<Eigen::Index>(r)];
    Simulation a(parse_scene(here.dump(), "here", "."), "here"), b(parse_scene(there.dump(), "there", "."), "there");
    std::size_t pairs = 0;
    while (a.frame() + 1 < a.frame_count()) {
        for (Simulation* s : {&a, &b})
            for (const StepReport& r : s->advance())
                REQUIRE(r.failure == "");
        pairs += dynamic_cast<const ContactSearch&>(*a.couplings()[0]).pairs();
    }
    CHECK(pairs > 0);
    for (std::size_t k = 0; k < a.bodies().size(); ++k) {
        // Seen from either place; what frames and positions() give is in the world, and as coarse as that is there.
        const auto near = a.bodies()[k].simulation.frame(Vec3::Zero()), away = b.bodies()[k].simulation.frame(far);
        double off = 0;
        for (std::size_t i = 0; i < near.size(); ++i)
            for (int r = 0; r < 3; ++r)
                for (int c = 0; c < 4; ++c)
                    off = std::max(off, std::abs(near[i].m[r][c] - away[i].m[r][c]));
        CAPTURE(a.bodies()[k].name);
        CHECK(off < 1e-9);
    }
}
