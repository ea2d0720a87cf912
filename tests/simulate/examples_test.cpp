// SPDX-License-Identifier: GPL-3.0-or-later
// What every effect that a scene can name says of itself: whoever adds one has it tested here.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>

#include <nlohmann/json.hpp>

#include "tests/simulate/bodies.hpp"
#include "toolkit/simulate/simulation.hpp"

using namespace cinch;
using nlohmann::json;

namespace {

// Two boxes that overlap, and one effect on both.
Simulation with_effect(const json& effect)
{
    json scene =
        json::parse(R"({"duration": 1, "frame": 1e-3, "integrator": {"method": "explicit", "step": 1e-4}, "bodies": [
        {"name": "a", "surface": "box", "box": [1, 0.8, 0.6], "cells": [2, 2, 2], "lattice": [4, 3, 3],
         "spin": [0.3, 1, 0]},
        {"name": "b", "surface": "box", "box": [1, 0.8, 0.6], "cells": [2, 2, 2], "lattice": [4, 3, 3],
         "position": [0.9, 0.1, 0]}]})");
    scene["effects"] = json::array({effect});
    return Simulation(parse_scene(scene.dump(), "s.json", "."), "s.json");
}

std::vector<json> examples()
{
    std::vector<json> all;
    const json schema = json::parse(scene_schema());
    for (const json& form : schema["$defs"]["effect"]["oneOf"])
        all.insert(all.end(), form.at("examples").begin(), form.at("examples").end());
    return all;
}

} // namespace

TEST_CASE("the shipped schema is the one that the effects make")
{
    std::ifstream in(CINCH_DATA "/scenes/schema.json");
    const std::string shipped{std::istreambuf_iterator<char>(in), {}};
    CHECK(shipped == scene_schema()); // cinch simulate --schema > data/scenes/schema.json
}

TEST_CASE("every effect has its own name, forms, and an example of each, with all that can stand in it")
{
    std::set<std::string> names, in_examples;
    for (const std::string& name : effect_names())
        CHECK(names.insert(name).second);
    for (const json& example : examples())
        in_examples.insert(example.at("effect").get<std::string>());
    CHECK(in_examples == names);
    const json schema = json::parse(scene_schema());
    for (const json& form : schema["$defs"]["effect"]["oneOf"]) {
        INFO(form["description"]);
        for (const auto& [key, field] : form["properties"].items())
            if (key != "bodies" && !(key == "nodes" && form["properties"].contains("clip")) &&
                field != json{{"const", false}})
                CHECK(form["examples"][0].contains(key));
    }
}

TEST_CASE("the example of every effect does something, by the name of its kind, and its forces are the derivative of "
          "its energy")
{
    std::size_t compared = 0;
    for (const json& example : examples()) {
        if (example.value("clip", false)) // of a character
            continue;
        INFO(example.dump());
        Simulation s = with_effect(example);
        for (const StepReport& r : s.advance())
            REQUIRE(r.failure.empty());
        BodySimulation& body = s.bodies()[0].simulation;
        CHECK(body.effects().size() + body.model().pins.size() == 1);
        for (const auto& effect : body.effects())
            CHECK(effect->name() == example["effect"]);
        if (body.effects().empty())
            continue;
        const Field keep = body.positions(), v = body.velocities();
        Field x = keep; // not special, and less than a contact is deep
        for (std::size_t i = 0; i < x.size(); ++i)
            x[i] += i % 4 == 3 ? 0 : 0.01 * std::sin(static_cast<double>(7 * i));
        body.place(x, v);
        const Field f = body.forces();
        double scale = 1e-9;
        for (const double value : f)
            scale = std::max(scale, std::abs(value));
        compared += scale > 1e-9;
        for (std::size_t k = 0; k < x.size(); k += 5) {
            if (k % 4 == 3)
                continue;
            auto moved_by = [&](double d) {
                Field y = x;
                y[k] += d;
                return test::energy_at(body, 0, y);
            };
            const double h = 1e-5,
                         slope = (8 * (moved_by(h) - moved_by(-h)) - (moved_by(2 * h) - moved_by(-2 * h))) / (12 * h);
            CHECK(std::abs(f[k] + slope) <= 1e-5 * scale);
        }
    }
    CHECK(compared >= 9);
}
