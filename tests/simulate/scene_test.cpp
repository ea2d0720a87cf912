// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes: what is wrong is named by its path; what is right runs, the same for any number of threads, and continues
// from a checkpoint.
#include <catch2/catch.hpp>

#include <sstream>

#include <nlohmann/json.hpp>
#include <tbb/global_control.h>

#include "cinch/surface.hpp"
#include "toolkit/simulate/frame_file.hpp"
#include "toolkit/simulate/simulation.hpp"

#include "tests/support.hpp"

using namespace cinch;
using nlohmann::json;

namespace {

json good()
{
    return json::parse(R"({"name": "bar", "duration": 0.2, "integrator": {"method": "implicit", "step": 0.02},
        "bodies": [{"name": "bar", "surface": "box", "box": [1, 0.3, 0.3], "cells": [8, 2, 2], "lattice": [6, 2, 2],
                    "density": 900},
                   {"name": "ball", "surface": "santa", "size": 0.5, "nodes": 30, "position": [0, 0, 2],
                    "rotation": {"axis": [1, 0, 0], "degrees": 30}}],
        "effects": [{"effect": "gravity"}, {"effect": "elastic", "young": 1e4, "poisson": 0.3}, {"effect": "hourglass"},
                    {"effect": "viscosity", "viscosity": 20}, {"effect": "damping", "rate": 0.1},
                    {"effect": "plasticity", "yield": 0.01, "creep": 5, "bodies": ["bar"]},
                    {"effect": "ground", "point": [0, 0, -0.3], "stiffness": 1e5, "friction": 0.4},
                    {"effect": "pulling", "nodes": {"nearest": [0.5, 0, 0], "count": 3}, "force": [5, 0, 0],
                     "bodies": ["bar"]},
                    {"effect": "pinned", "nodes": {"box": [[-1, -1, -1], [-0.4, 1, 1]]}, "bodies": ["bar"]},
                    {"effect": "scripted", "nodes": {"nearest": [0, 0, 0.5], "count": 4}, "axis": [0, 0, 1], "rate": 3,
                     "bodies": ["ball"]}]})");
}

std::string complaint(const json& scene)
{
    try {
        Simulation simulation(parse_scene(scene.dump(), "s.json", "."), "s.json");
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

std::string state_of(const Simulation& s)
{
    std::ostringstream out;
    s.save(out);
    return out.str();
}

Simulation make(const json& scene) { return Simulation(parse_scene(scene.dump(), "s.json", "."), "s.json"); }

} // namespace

TEST_CASE("what is wrong in a scene is named by its path")
{
    REQUIRE(complaint(good()).empty());
    struct Case {
        const char* pointer; ///< of the field that is changed; removed if the value is null
        json value;
        const char* expected;
    };
    const Case cases[] = {
        {"/effects/1/effect", "elastik", "/effects/1/effect: 'elastik' is unknown; known are gravity"},
        {"/effects/1/young", -3, "/effects/1/young: expected a number > 0, found -3"},
        {"/effects/1/young", "soft", "/effects/1/young: expected a number > 0, found \"soft\""},
        {"/effects/1/young", nullptr, "/effects/1/young: is missing"},
        {"/effects/1/yung", 3, "/effects/1/yung: is unknown; known here are bodies, effect, model, poisson, young"},
        {"/effects/1/poisson", 0.5, "/effects/1/poisson: must lie below 0.5"},
        {"/effects/1/poisson", 0.6, "/effects/1/poisson: expected a number above -1 and below 0.5"},
        {"/effects/1/poisson", -1, "/effects/1/poisson: expected a number above -1"},
        {"/effects/1/model", "rubber", "/effects/1/model: 'rubber' is unknown"},
        {"/effects/0/acceleration", json::array({0, 1}), "/effects/0/acceleration: expected an array of 3 numbers"},
        {"/effects/0/acceleration", json::array({0, 1, "x"}),
         "/effects/0/acceleration/2: expected a number, found \"x\""},
        {"/effects/5/bodies", "bar", "/effects/5/bodies: expected names of bodies"},
        {"/effects/5/bodies/0", "bra", "/effects/5/bodies/0: there is no body 'bra'"},
        {"/effects/7/nodes/count", 0, "/effects/7/nodes/count: expected a whole number from 1"},
        {"/effects/8/nodes", json::parse(R"({"box": [[5, 5, 5], [6, 6, 6]]})"),
         "/effects/8/nodes: selects no simulation node of body 'bar'"},
        {"/effects/8/nodes", json::parse(R"({"index": [3, 99]})"),
         "/effects/8/nodes/index: body 'bar' has simulation nodes 0 to 23, not 99"},
        {"/effects/8/nodes", json::parse(R"({"index": [-1]})"), "/effects/8/nodes/index/0: expected a whole number"},
        {"/effects/8/nodes", "some", "/effects/8/nodes: expected an object"},
        {"/effects/8/bodies", nullptr, "/effects/8/nodes: selects no simulation node of body 'ball'"},
        {"/effects/9", json::parse(R"({"effect": "pinned", "bodies": ["bar"]})"),
         "/effects/9: simulation node 0 of body 'bar' is pinned or scripted already"},
        {"/effects/9/clip", true, "/effects/9/axis: is unknown"},
        {"/effects/9", json::parse(R"({"effect": "scripted", "clip": true})"),
         "'clip' needs a body whose surface is an animated character"},
        {"/effects/9/axis", json::array({0, 0, 0}), "/effects/9/axis: must not be 0"},
        {"/effects/6/stiffness", -1, "/effects/6/stiffness: expected a number >= 0"},
        {"/bodies/0/density", 0, "/bodies/0/density: expected a number > 0"},
        {"/bodies/0/density", -5, "/bodies/0/density: expected a number > 0"},
        {"/bodies/0/surface", "boxx", "/bodies/0/"},
        {"/bodies/1/surface", "nowhere.off", "nowhere.off"},
        {"/bodies/1/surface", "cube", "/bodies/1/surface: 'cube' is no shape"},
        {"/bodies/1/nodes", 0, "/bodies/1/nodes: expected a whole number from 1"},
        {"/bodies/1/nodes", nullptr, "/bodies/1: needs one of nodes"},
        {"/bodies/1/name", "bar", "/bodies/1/name: 'bar' stands twice"},
        {"/bodies/0/box", json::array({1, 0, 1}), "/bodies/0/box/1: expected a number from 1e-30"},
        {"/bodies/0/lattice", json::array({1, 2.5, 1}), "/bodies/0/lattice/1: expected a whole number"},
        {"/bodies/1/name", "../escape", "/bodies/1/name: must be"},
        {"/bodies/1/name", "a\nb", "/bodies/1/name: must be"},
        {"/effects/1/model", "a\n\x1b[31m", "/effects/1/model: 'a??[31m' is unknown"},
        {"/bodies/0/lattice", json::array({100, 100, 100}), "/bodies/0/lattice: makes more than 20,000"},
        {"/bodies/0/cells", json::array({1000, 1000, 1000}), "/bodies/0/cells: makes more than"},
        {"/effects/5/bodies", json::array(), "/effects/5/bodies: expected names of bodies"},
        {"/frame", 1e300, "/frame: expected a number from 1e-30"},
        {"/bodies", json::array(), "/bodies: is empty"},
        {"/bodies/0", 7, "/bodies/0: expected an object, found 7"},
        {"/duration", -1, "/duration: expected a number >= 0"},
        {"/duration", 1e9, "/duration: makes more than a million frames"},
        {"/integrator/step", 0, "/integrator/step: expected a number from 1e-30"},
        {"/integrator/step", -0.1, "/integrator/step: expected a number from 1e-30"},
        {"/integrator/method", "rk4", "/integrator/method: 'rk4' is unknown; known are implicit, explicit"},
        {"/integrator/safety", 0.5, "/integrator/safety: is unknown"},
        {"/colour", "red", "/colour: is unknown"},
    };
    for (const Case& c : cases) {
        json scene = good();
        const json::json_pointer pointer(c.pointer);
        if (c.value.is_null())
            scene[pointer.parent_pointer()].erase(pointer.back());
        else
            scene[pointer] = c.value;
        const std::string said = complaint(scene);
        INFO(c.pointer << " = " << c.value.dump() << ": " << said);
        CHECK(said.find(c.expected) != std::string::npos);
        CHECK(said.find('\n') == std::string::npos);
    }
    auto text_complaint = [](const std::string& text) {
        try {
            parse_scene(text, "s.json", ".");
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    CHECK(text_complaint("{\n\"a\": ,\n}") == "s.json:2: is no JSON from here on");
    CHECK(text_complaint("") == "s.json:1: is no JSON from here on");
    CHECK(text_complaint("{\"duration\": " + std::string(200000, '[') + std::string(200000, ']') + "}")
              .find("nested more than 32 deep") != std::string::npos);
    CHECK(text_complaint(R"({"duration": 1, "duration": 2})").find("'duration' stands twice") != std::string::npos);
    CHECK(text_complaint("{\"duration\": 1, \"name\": \"\xff\"}").find("is no JSON") != std::string::npos);
    CHECK(text_complaint("[1]").find("expected an object") != std::string::npos);
    CHECK(text_complaint("{\"duration\": NaN}").find("is no JSON") != std::string::npos);
    CHECK(text_complaint("{\"duration\": 1e999}").find("s.json") != std::string::npos);
    CHECK_FALSE(text_complaint("{\"duration\": 1e999}").empty());
}

TEST_CASE("a run with every effect is the same for any number of threads, and after a checkpoint")
{
    for (const char* method : {"implicit", "explicit"}) {
        json scene = good();
        scene["integrator"] = {{"method", method}, {"step", 0.01}};
        Simulation whole = make(scene);
        std::string middle;
        while (whole.frame() + 1 < whole.frame_count()) {
            for (const StepReport& r : whole.advance())
                REQUIRE(r.failure.empty());
            if (whole.frame() == 5)
                middle = state_of(whole);
        }
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
        CHECK(rest.frame() == 5);
        while (rest.frame() + 1 < rest.frame_count())
            rest.advance();
        CHECK(state_of(rest) == state_of(whole));
    }
}

TEST_CASE("frames are read back as they were written, and damage is seen")
{
    test::TemporaryFolder folder;
    const FrameLayout layout{0.25, {2, 1}};
    std::vector<std::vector<AffineMap>> maps{{identity_map, identity_map}, {identity_map}};
    maps[0][1].m[2][3] = 1.0 / 3;
    std::string bytes = frame_header(layout);
    CHECK(bytes.size() == layout.header_bytes());
    for (std::uint64_t f = 0; f < 3; ++f) {
        const std::string record = frame_record(layout, f, 0.25 * double(f), maps);
        CHECK(record.size() == layout.frame_bytes());
        bytes += record;
    }
    const FrameFile all = read_frames(folder.write("a", bytes));
    REQUIRE(all.bodies.size() == 2);
    REQUIRE(all.bodies[0].frame_count() == 3);
    CHECK(all.bodies[0].frame(2)[1].m[2][3] == 1.0 / 3);
    CHECK(all.bodies[1].time_s(2) == 0.5);
    CHECK_FALSE(all.cut_off);
    const FrameFile cut = read_frames(folder.write("b", std::string_view(bytes).substr(0, bytes.size() - 1)));
    CHECK(cut.bodies[0].frame_count() == 2);
    CHECK(cut.cut_off);
    bytes[layout.header_bytes() + 100] ^= 1;
    CHECK_THROWS_WITH(read_frames(folder.write("c", bytes)), Catch::Contains("frame 0 was changed"));
    CHECK_THROWS_WITH(read_frames(folder.write("d", "hello, this is no such file at all")),
                      Catch::Contains("is no file of frames"));
}
