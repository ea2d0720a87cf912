// SPDX-License-Identifier: GPL-3.0-or-later
// The command simulate, as its user sees it.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <nlohmann/json.hpp>

#include "experiments/report/provenance.hpp"
#include "experiments/simulation/find_scene.hpp"
#include "tests/support.hpp"
#include "toolkit/simulate/frame_file.hpp"
#include "toolkit/surface/checksum.hpp"
#include "toolkit/surface/read_mesh.hpp"

using namespace cinch;
using test::TemporaryFolder;
using json = nlohmann::json;
namespace fs = std::filesystem;

namespace {

std::string bytes_of(const fs::path& path)
{
    std::ifstream in(path, std::ios::binary);
    std::ostringstream out;
    out << in.rdbuf();
    return out.str();
}

} // namespace

TEST_CASE("every shipped scene starts, and writes finite frames")
{
    TemporaryFolder folder;
    const auto scenes = shipped_scenes();
    REQUIRE(scenes.size() >= 16);
    for (const std::string& scene : scenes) {
        INFO(scene);
        const auto run =
            test::cinch("simulate " + scene + " --duration 0.05 --json --frames " + (folder.path() / scene).string());
        REQUIRE(run.status == 0);
        CHECK(run.err.empty());
        const json first = json::parse(run.lines().front());
        CHECK(first["scene"] == scene);
        CHECK(first["steps"].get<std::size_t>() > 0);
        std::size_t named = 0;
        for (const json& effect : first["effects"])
            named += effect != "pinned" && effect != "scripted";
        CHECK(run.lines().size() == 2 + named); // one record for each effect, and the shared work
        const FrameFile frames = read_frames(folder.path() / scene);
        CHECK(frames.bodies.size() == first["bodies"]);
        CHECK(frames.bodies[0].frame_count() == 4);
        for (const Clip& body : frames.bodies)
            for (std::size_t f = 0; f < body.frame_count(); ++f)
                for (const AffineMap& map : body.frame(f))
                    for (const auto& row : map.m)
                        for (const double value : row)
                            REQUIRE(std::isfinite(value));
    }
}

TEST_CASE("a run that is interrupted, or killed, and resumed writes the bytes of an uninterrupted one")
{
    TemporaryFolder folder;
    auto in = [&](const std::string& name) { return (folder.path() / name).string(); };
    for (const std::string kind : {"frames", "jsonl"}) {
        const std::string whole = in("whole." + kind), part = in("part." + kind), state = in("state-" + kind);
        const std::string scene = "simulate twist-180 --duration 3 --every 3 --threads 1";
        REQUIRE(test::cinch(scene + " --frames " + whole + " --meshes " + in("meshes-" + kind)).status == 0);
        const std::string begin =
            scene + " --frames " + part + " --checkpoint " + state + " --meshes " + in("parts-" + kind);
        const std::string resume =
            scene + " --frames " + part + " --resume " + state + " --meshes " + in("parts-" + kind);
        test::cinch_killed(begin, 0.4);
        for (const double after : {0.25, 0.35, 0.3})
            if (fs::exists(state))
                test::cinch_killed(resume, after);
        const auto last = test::cinch(fs::exists(state) ? resume : begin);
        REQUIRE(last.status == 0);
        CHECK(bytes_of(part) == bytes_of(whole));
        std::size_t meshes = 0;
        for (const auto& entry : fs::directory_iterator(in("meshes-" + kind))) {
            ++meshes;
            CHECK(bytes_of(entry.path()) == bytes_of(in("parts-" + kind) / entry.path().filename()));
        }
        CHECK(meshes == 181);
    }
    const auto stopped = test::cinch_interrupted(
        "simulate twist-180 --duration 10000 --frames " + in("long") + " --checkpoint " + in("long-state"), 3);
    CHECK(stopped.status == 130);
    CHECK(stopped.err.find("interrupted at frame") != std::string::npos);
    CHECK(stopped.out.find("elastic") != std::string::npos); // what is done is shown
    CHECK(stopped.err.find("the frames so far are in ") != std::string::npos);
    CHECK_FALSE(fs::exists(in("long")));
    const FrameFile kept = read_frames(in("long.part"));
    CHECK_FALSE(kept.cut_off);
    CHECK(kept.bodies[0].frame_count() > 1);
}

TEST_CASE("checkpoints continue only what they are of")
{
    TemporaryFolder folder;
    const std::string state = (folder.path() / "s").string(), frames = (folder.path() / "f").string();
    REQUIRE(test::cinch("simulate skin --duration 0.2 --checkpoint " + state + " --frames " + frames).status == 0);
    CHECK(test::cinch("simulate skin --duration 0.3 --resume " + state + " --frames " + frames).status ==
          0); // longer is fine
    CHECK(read_frames(frames).bodies[0].frame_count() == 19);
    auto refused = [&](const std::string& arguments, const std::string& why) {
        const auto run = test::cinch("simulate " + arguments);
        INFO(run.err);
        CHECK(run.status == 2);
        CHECK(run.err.find(why) != std::string::npos);
        CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
    };
    refused("beam --resume " + state, "is of another scene");
    refused("skin --step 0.001 --resume " + state, "or of other settings");
    refused("skin --resume " + frames, "is no checkpoint");
    refused("skin --resume " + state + "x", "no such file");
    std::string bytes = bytes_of(state);
    auto with_checksum = [](std::string changed) {
        changed.resize(changed.size() - 8);
        const std::uint64_t sum = checksum(changed);
        return changed.append(reinterpret_cast<const char*>(&sum), 8);
    };
    REQUIRE(with_checksum(bytes) == bytes);
    for (std::size_t i = 0; i < bytes.size(); i += 1 + bytes.size() / 30) {
        std::string changed = bytes;
        changed[i] = static_cast<char>(changed[i] ^ 4);
        refused("skin --resume " + folder.write("d", changed).string(), i < 9 ? "is no checkpoint" : "was changed");
        refused("skin --resume " + folder.write("d", bytes.substr(0, i)).string(), i == 0   ? "is empty"
                                                                                   : i < 73 ? "is no checkpoint"
                                                                                            : "was changed");
    }
    // Damage that a checksum does not see: fields that contradict each other, a program that is another.
    const std::string written = bytes_of(frames);
    for (std::size_t i = 9; i < bytes.size() - 8; i += i < 73 ? 4 : bytes.size() / 20) { // 9 to 64 the header
        folder.write("f", written);
        std::string changed = bytes;
        changed[i] = static_cast<char>(changed[i] ^ 0x40);
        const auto run = test::cinch("simulate skin --duration 0.3 --resume " +
                                     folder.write("d", with_checksum(changed)).string() + " --frames " + frames);
        INFO(i << " " << run.err);
        if (i < 65)
            CHECK(run.status == 2);
        CHECK((run.status == 0 || run.status == 1 || run.status == 2)); // a crash is none
        CHECK(std::count(run.err.begin(), run.err.end(), '\n') <= 1);
    }
    folder.write("f", written);
    std::string other = bytes;
    const std::size_t commit = other.find(provenance(1, 0).version + " (");
    REQUIRE(commit != std::string::npos);
    other[commit] = '9';
    refused("skin --resume " + folder.write("d", with_checksum(other)).string(), "was written by cinch 9");
    std::string edited = bytes_of(frames);
    edited[edited.size() / 2] ^= 1;
    refused("skin --duration 0.3 --resume " + state + " --frames " + folder.write("edited", edited).string(),
            "does not have the");
    CHECK(bytes_of(folder.path() / "edited") == edited);
    refused("skin --duration 0.1 --resume " + state + " --frames " + frames,
            "is at frame 18, and this run ends with frame 6");
    refused("skin --resume " + state + " --frames " + folder.write("short", "abc").string(), "does not have the");
    refused("skin --resume " + state, "continues with --frames FILE, binary");
    refused("skin --resume " + state + " --frames " + frames + ".jsonl", "continues with --frames FILE, binary");
    REQUIRE(test::cinch("simulate skin --duration 0.1 --checkpoint " + state + "2").status == 0);
    refused("skin --resume " + state + "2 --frames " + frames, "is of a run without --frames");
    CHECK(read_frames(frames).bodies[0].frame_count() == 19); // and left alone
    refused("skin --checkpoint /dev/full", "is no regular file");
    // A surface that changed beside the scene.
    const std::string own =
        R"({"duration": 0.05, "bodies": [{"surface": "m.off", "places": [[0,0,0],[1,0,0],[0,1,0],[0,0,1]]}],
            "effects": [{"effect": "gravity"}]})";
    const std::string scene = folder.write("own.json", own).string(),
                      mesh = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
    folder.write("m.off", mesh);
    REQUIRE(test::cinch("simulate " + scene + " --checkpoint " + state + "3").status == 0);
    folder.write("m.off", "OFF\n4 4 0\n0 0 0\n2 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n");
    refused(scene + " --resume " + state + "3", "is of another scene");
    refused(
        folder.write("gone.json", R"({"duration": 1, "bodies": [{"surface": "gone.off", "nodes": 4}], "effects": []})")
            .string(),
        "gone.json: /bodies/0/surface: ");
    refused("skin --duration nan", "--duration");
    refused("skin --duration 1e9", "--duration");
    refused("skin --frames /nonexistent/f", "cannot be written");
    refused("skin --meshes " + state, "is no folder");
    refused("nothing", "no such scene; known are beam, brain-pull");
    refused("nothing.json", "no such file");
    refused("brain-pull --nodes 0", "--nodes");
    refused("beam --nodes 5", "gives them");
    refused(folder.write("scene.json", R"({"duration": 1, "bodies": [{"surface": "box"}], "effects": []})").string(),
            "scene.json: /bodies/0/box: is missing");
}

TEST_CASE("a step that cannot be solved is reported with time and body, and no file has NaN")
{
    TemporaryFolder folder;
    const fs::path scene = folder.write(
        "hard.json", R"({"duration": 1, "integrator": {"method": "implicit", "iterations": 1, "tolerance": 1e-12},
        "bodies": [{"name": "bar", "surface": "box", "box": [1, 0.3, 0.3], "cells": [8, 2, 2], "lattice": [6, 2, 2],
                    "spin": [0, 9, 0]}],
        "effects": [{"effect": "elastic", "young": 1e7}]})");
    const auto run = test::cinch("simulate " + scene.string() + " --frames " + (folder.path() / "f").string());
    CHECK(run.status == 1);
    CHECK(run.err.find("body 'bar' at 0 s: no minimum within 1 Newton iterations") != std::string::npos);
    CHECK_FALSE(fs::exists(folder.path() / "f"));
    CHECK(read_frames(folder.path() / "f.part").bodies[0].frame_count() == 1);
}

TEST_CASE(
    "what is stiff, far away, hardly drawn or tiny moves, or is reported: with time, body, and by how much it is off")
{
    TemporaryFolder folder;
    auto scene = [](const std::string& body, const std::string& young, const std::string& more) {
        return R"({"duration": 0.5,
                   "bodies": [{"name": "bar", "surface": "box", "cells": [4, 2, 2], "lattice": [6, 3, 3], )" +
               body + R"(}], "effects": [{"effect": "elastic", "young": )" + young + R"(}, {"effect": "hourglass"}, )" +
               more + "]}";
    };
    const std::string metre = R"("box": [1, 0.3, 0.3])",
                      gravity = R"({"effect": "gravity", "acceleration": [0, 0, -9.81]})";
    struct Case {
        std::string text;
        double fall; ///< m
    };
    const double steps = 30.0 * 31 / 2 / 3600; // implicit Euler's parabola
    for (const Case& c :
         {Case{scene(metre, "1e16", gravity), 9.81 * steps}, Case{scene(metre, "1e18", gravity), 9.81 * steps},
          Case{scene(metre + R"(, "position": [0, 0, 1e12])", "1e6", gravity), 9.81 * steps},
          Case{scene(metre, "1e6", R"({"effect": "gravity", "acceleration": [0, 0, -1e-5]})"), 1e-5 * steps}}) {
        const fs::path file = folder.write("falls.json", c.text), frames = folder.path() / "falls.frames";
        INFO(c.text);
        const auto run = test::cinch("simulate " + file.string() + " --frames " + frames.string());
        INFO(run.err);
        REQUIRE(run.status == 0);
        const Clip clip = read_frames(frames).bodies[0];
        CHECK(clip.frame(0)[0].m[2][3] - clip.frame(clip.frame_count() - 1)[0].m[2][3] ==
              Approx(c.fall).epsilon(1e-4).margin(std::abs(clip.frame(0)[0].m[2][3]) * 0x1p-51));
    }
    const fs::path tiny = folder.write("tiny.json", scene(R"("box": [1e-6, 3e-7, 3e-7], "spin": [0, 0, 6.283185307])",
                                                          "1e6", R"({"effect": "damping", "rate": 0})")),
                   turned = folder.path() / "turned";
    REQUIRE(test::cinch("simulate " + tiny.string() + " --frames " + turned.string()).status == 0);
    const Clip turning = read_frames(turned).bodies[0];
    const AffineMap half = turning.frame(turning.frame_count() - 1)[0];
    CHECK(half.m[0][0] < -0.7); // half a turn, less what implicit Euler damps
    // Held by an end that turns, stiffer than the places of that end are fine.
    const fs::path hard = folder.write(
        "hard.json",
        scene(metre, "1e19", gravity + R"(, {"effect": "scripted", "nodes": {"box": [[-1, -1, -1], [-0.3, 1, 1]]},
                              "axis": [1, 1, 0], "rate": 3})"));
    const auto run = test::cinch("simulate " + hard.string() + " --frames " + (folder.path() / "h").string());
    CHECK(run.status == 1);
    CHECK(run.err.find("body 'bar' at 0 s: rounding: accelerations are off by ") != std::string::npos);
    CHECK(run.err.find(" m/s2, where ") != std::string::npos);
    CHECK(read_frames(folder.path() / "h.part").bodies[0].frame_count() == 1);
}

TEST_CASE(
    "santa-ring with 550 nodes is stable at 1/60 s over four decades of stiffness, and gains no energy without work")
{
    std::ifstream in(fs::path(CINCH_DATA) / "scenes" / "santa-ring-2.json");
    const json original = json::parse(in);
    for (const double young : {1e3, 1e4, 1e5, 1e6, 1e7})
        for (const bool swings : {true, false}) {
            json scene = original;
            scene["bodies"] = json::array({original["bodies"][0]});
            scene["duration"] = 0.5;
            for (json& effect : scene["effects"]) {
                if (effect["effect"] == "elastic")
                    effect["young"] = young;
                if (effect["effect"] == "scripted" && !swings)
                    effect["swing"] = 0;
            }
            if (!swings)
                scene["bodies"][0]["velocity"] = {0.5, 1, 2};
            CAPTURE(young, swings);
            Simulation simulation(parse_scene(scene.dump(), "scene", "."), "scene");
            REQUIRE(simulation.bodies()[0].simulation.body().size() == 550);
            REQUIRE(simulation.scene().integration.step_s == 1.0 / 60);
            double energy = HUGE_VAL;
            while (simulation.frame() + 1 < simulation.frame_count()) {
                const StepReport r = simulation.advance()[0];
                REQUIRE(r.failure.empty());
                REQUIRE(r.substeps == 1);
                if (!swings)
                    REQUIRE(r.kinetic + r.potential <= energy + 1e-9 * std::abs(energy));
                energy = r.kinetic + r.potential;
            }
        }
}

TEST_CASE("positions that leave the numbers end a run, and are not written")
{
    TemporaryFolder folder;
    const std::string body =
        R"("bodies": [{"surface": "box", "box": [1, 1, 1], "cells": [1, 1, 1], "lattice": [2, 2, 2])";
    const fs::path flung =
        folder.write("flung.json", R"({"duration": 10, )" + body +
                                       R"(}], "effects": [{"effect": "scripted", "velocity": [1e308, 0, 0]}]})");
    const std::string frames = (folder.path() / "f").string();
    const auto run = test::cinch("simulate " + flung.string() + " --frames " + frames);
    CHECK(run.status == 1);
    CHECK(run.err.find("body 'body-0' at 1.7") != std::string::npos);
    const FrameFile written = read_frames(frames + ".part");
    CHECK(written.bodies[0].frame_count() > 100);
    for (std::size_t f = 0; f < written.bodies[0].frame_count(); ++f)
        for (const AffineMap& map : written.bodies[0].frame(f))
            REQUIRE(std::isfinite(map.m[0][3]));
    const fs::path far =
        folder.write("far.json", R"({"duration": 0.1, )" + body + R"(, "position": [1e39, 0, 0]}], "effects": []})");
    const auto meshes = test::cinch("simulate " + far.string() + " --meshes " + (folder.path() / "m").string());
    CHECK(meshes.status == 1);
    CHECK(meshes.err.find("beyond what a mesh file holds") != std::string::npos);
    CHECK(fs::is_empty(folder.path() / "m"));
}

TEST_CASE("meshes are those of the frames")
{
    TemporaryFolder folder;
    for (const std::string format : {"ply", "obj"}) {
        REQUIRE(
            test::cinch("simulate beam --duration 0.1 --mesh-format " + format + " --meshes " + folder.path().string())
                .status == 0);
        const TriangleMesh mesh = read_mesh(folder.path() / ("beam-00006." + format)).mesh;
        CHECK(mesh.vertices.size() == 1610);
        double lowest = 0;
        for (const Vec3& v : mesh.vertices)
            lowest = std::min(lowest, v.z());
        CHECK(lowest < -0.055); // it has begun to fall
    }
}

TEST_CASE("what is not named is said to be left out")
{
    const auto run = test::cinch("simulate beam --duration 0.1 --explain");
    REQUIRE(run.status == 0);
    std::string text = run.out;
    std::replace(text.begin(), text.end(), '\n', ' ');
    CHECK(text.find("never constructed: pulling volume plasticity damping ground contact scripted") !=
          std::string::npos);
    for (const std::string& line : run.lines())
        CHECK(line.size() <= 80);
}
