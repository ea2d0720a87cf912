// SPDX-License-Identifier: GPL-3.0-or-later
// Files of tests/reports: each gives the box that its .txt states, or is refused by name.
#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>

#include <catch2/catch.hpp>

#include "tests/surface/gltf_example.hpp"
#include "toolkit/surface/read_mesh.hpp"

using namespace cinch;
using namespace cinch::test;

namespace {

std::filesystem::path report(const std::string& name) { return std::filesystem::path(CINCH_REPORTS) / name; }

struct TrueBox {
    double time_s = 0;
    Box box;
};

std::vector<TrueBox> true_boxes(const std::string& name)
{
    std::vector<TrueBox> out;
    std::ifstream in(report(name + ".txt"));
    for (std::string line; std::getline(in, line);) {
        TrueBox b;
        Vec3 &l = b.box.low, &h = b.box.high;
        REQUIRE(std::sscanf(line.c_str(),
                            "t=%lf s: true box of the deformed surface min (%lf, %lf, %lf) max (%lf, %lf, %lf)",
                            &b.time_s, &l[0], &l[1], &l[2], &h[0], &h[1], &h[2]) == 7);
        out.push_back(b);
    }
    REQUIRE(out.size() == 3);
    return out;
}

} // namespace

TEST_CASE("reported characters have the boxes that they have")
{
    for (const std::string name :
         {"F02_animation_pointer", "F04_matrix_scale10_translation", "F06_zero_accessor_joints", "F07_long_clip_memory",
          "F09_duplicate_key_times_other_clip", "F11_plus_in_uri", "F16_other_scene"}) {
        INFO(name);
        const Character c = read_gltf(report(name + ".gltf"));
        CHECK(c.missing.empty());
        for (const TrueBox& wanted : true_boxes(name)) {
            INFO(wanted.time_s << " s");
            const Box box = box_at(c, c.animations.at(0), wanted.time_s);
            for (int a = 0; a < 3; ++a) {
                CHECK(box.low[a] == Approx(wanted.box.low[a]).margin(1e-5));
                CHECK(box.high[a] == Approx(wanted.box.high[a]).margin(1e-5));
            }
        }
    }
}

TEST_CASE("reported characters that are not modelled are refused by name")
{
    for (const auto& [name, reason] :
         {std::pair("F03_morph_animated_noted.gltf",
                    "what is not modelled: morph targets with weights that are not 0 (nodes[0])"),
          {"F03_morph_static_node_weights.gltf",
           "what is not modelled: morph targets with weights that are not 0 (nodes[0])"},
          {"F05_khr_meshopt_required_silent.glb",
           "is compressed with KHR_meshopt_compression, which is not supported; export it without compression"},
          {"F08_draco_required.glb",
           "is compressed with KHR_draco_mesh_compression, which is not supported; export it without compression"},
          {"F10_message_empty.gltf", "draws no mesh that a skin deforms"}}) {
        INFO(name);
        CHECK_THAT(refusal(read_bytes(report(name)), name),
                   Catch::StartsWith(std::string(name) + ": ") && Catch::Contains(reason));
    }
    for (const std::string name : {"F03_morph_animated_noted", "F03_morph_static_node_weights"}) {
        const Character c = read_gltf(report(name + ".gltf"), Coverage::partial);
        CHECK(c.animations.at(0).missing.size() == 1);
        CHECK(sample(c, c.animations[0], 1).frame_count() == 2); // the rest of it can be bounded
    }
}

TEST_CASE("the frames that are looked at are the ones that take memory")
{
    auto peak_kb = [] {
        std::ifstream in("/proc/self/status");
        for (std::string line; std::getline(in, line);)
            if (line.starts_with("VmHWM:"))
                return std::stol(line.substr(6));
        return 0L;
    };
    const long before = peak_kb();
    const Character c = read_gltf(report("F07_long_clip_memory.gltf"));
    const Clip all = sample(c, c.animations.at(0), 30), three = evenly_spread(all, 3);
    CHECK(all.frame_count() == 900001);
    REQUIRE(three.frame_count() == 3);
    CHECK(three.time_s(1) == Approx(15000));
    for (std::size_t f = 0; f < 3; ++f)
        CHECK(three.frame(f).size() == 60);
    CHECK(peak_kb() - before < 20000);
}
