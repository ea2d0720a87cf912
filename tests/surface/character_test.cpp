// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <numbers>

#include <catch2/catch.hpp>

#include "tests/surface/gltf_example.hpp"
#include "toolkit/surface/character.hpp"
#include "toolkit/surface/triangle_mesh.hpp"

using namespace cinch;
using namespace cinch::test;

namespace {

AffineMap moving_joint(const Clip& clip, std::size_t frame) { return clip.frame(frame).at(1); }

} // namespace

TEST_CASE("a skin loads: welding, repeated joints, normalised weights")
{
    Document document = triangle();
    const Character c = document.parse();
    REQUIRE(c.mesh.vertices.size() == 3); // vertex 3 repeats vertex 0
    CHECK(c.mesh.triangles == std::vector<Triangle>{{0, 1, 2}, {0, 1, 2}});
    CHECK(c.influences.row == std::vector<std::uint32_t>{0, 2, 3, 4});
    CHECK(c.influences.node == std::vector<std::uint32_t>{0, 1, 1, 1});
    CHECK(c.influences.weight == std::vector<double>{51 / 255.0, 204 / 255.0, 1.0, 1.0});
    const Clip rest = rest_pose(c);
    for (int r = 0; r < 3; ++r)
        for (int col = 0; col < 4; ++col)
            CHECK(rest.frame(0)[1].m[r][col] == identity_map.m[r][col]); // (0, 1, 0) · inverse bind (0, −1, 0)
}

TEST_CASE("all interpolation modes follow the specification")
{
    Document d = triangle();
    d.animate("linear", "translation", "LINEAR", {1, 3}, {0, 1, 0, 4, 1, 0}, 3);
    d.animate("default", "translation", "", {1, 3}, {0, 1, 0, 4, 1, 0}, 3);
    d.animate("step", "translation", "STEP", {0, 1, 2}, {1, 1, 0, 2, 1, 0, 3, 1, 0}, 3);
    // Hermite with end values 0 and 4, out-tangent 2 at the first key, in-tangent −1 at the second, 2 s apart.
    d.animate("cubic", "translation", "CUBICSPLINE", {0, 2},
              {9, 9, 9, 0, 1, 0, 2, 0, 0, /**/ -1, 0, 0, 4, 1, 0, 9, 9, 9}, 3);
    d.animate("turn", "rotation", "LINEAR", {0, 1}, {0, 0, 0, 1, 0, 0, 0.70710678f, 0.70710678f}, 4);
    d.animate("long way", "rotation", "LINEAR", {0, 1}, {0, 0, 0, 1, 0, 0, -0.70710678f, -0.70710678f}, 4);
    d.animate("grow", "scale", "LINEAR", {0, 1}, {1, 1, 1, 3, 1, 0.5f}, 3);
    const Character c = d.parse();
    REQUIRE(c.animations.size() == 7);

    const Clip linear = sample(c, c.animations[0], 2);
    REQUIRE(linear.frame_count() == 5);
    for (std::size_t i = 0; i < 5; ++i)
        CHECK(linear.time_s(i) == 1 + 0.5 * static_cast<double>(i));
    CHECK(moving_joint(linear, 1).m[0][3] == 1);
    CHECK(moving_joint(sample(c, c.animations[1], 2), 3).m[0][3] == 3);
    const Clip step = sample(c, c.animations[2], 4);
    CHECK(moving_joint(step, 3).m[0][3] == 1);
    CHECK(moving_joint(step, 4).m[0][3] == 2);
    CHECK(moving_joint(step, 8).m[0][3] == 3);
    // At s = ½: ½·0 + ½·4 + 2 s · (⅛·2 − ⅛·(−1)) = 2.75.
    CHECK(moving_joint(sample(c, c.animations[3], 1), 1).m[0][3] == Approx(2.75).margin(1e-12));
    for (int turn : {4, 5}) { // q and −q are the same turn
        const AffineMap half = moving_joint(sample(c, c.animations[static_cast<std::size_t>(turn)], 2), 1);
        CHECK(half.m[0][0] == Approx(std::cos(std::numbers::pi / 4)).margin(1e-7));
        CHECK(half.m[1][0] == Approx(std::sin(std::numbers::pi / 4)).margin(1e-7));
    }
    const AffineMap grown = moving_joint(sample(c, c.animations[6], 2), 1);
    CHECK(grown.m[0][0] == 2);
    CHECK(grown.m[2][2] == 0.75);
    CHECK_THROWS_AS(sample(c, c.animations[0], 1e12), InputError);
}

TEST_CASE("sparse accessors replace elements")
{
    Document d = triangle();
    const int at = d.view<std::uint16_t>({2}), value = d.view<float>({7, 8, 9});
    d.root["accessors"][0]["sparse"] = {
        {"count", 1}, {"indices", {{"bufferView", at}, {"componentType", 5123}}}, {"values", {{"bufferView", value}}}};
    CHECK(d.parse().mesh.vertices[2] == Vec3(7, 8, 9));
}

TEST_CASE("malformed characters are refused in one line")
{
    auto refused = [](Document d, const std::string& reason) {
        try {
            const Character c = d.parse();
            for (const auto& animation : c.animations)
                sample(c, animation, 1);
            FAIL("loaded, expected: " << reason);
        } catch (const InputError& error) {
            const std::string message = error.what();
            CHECK_THAT(message, Catch::StartsWith("document.gltf: ") && Catch::Contains(reason));
            CHECK(message.find('\n') == std::string::npos);
        }
    };
    Document d = triangle();
    SECTION("joint index")
    {
        d.root["accessors"][1]["bufferView"] = d.view<std::uint8_t>(std::vector<std::uint8_t>(16, 7));
        refused(d, "names joint 7; skin 0 has 2");
    }
    SECTION("negative joint index")
    {
        d.root["accessors"][1]["bufferView"] = d.view<std::int8_t>(std::vector<std::int8_t>(16, -3));
        d.root["accessors"][1]["componentType"] = 5120;
        refused(d, "names joint -3");
    }
    SECTION("vertex index")
    {
        d.root["accessors"][4]["bufferView"] = d.view<std::uint16_t>({0, 1, 2, 3, 1, 9});
        refused(d, "vertex index 9 is out of range");
    }
    SECTION("accessor past its view")
    {
        d.root["accessors"][0]["count"] = 5;
        refused(d, "reaches past bufferViews[0]");
    }
    SECTION("absurd count")
    {
        d.root["accessors"][0]["count"] = 4000000000u;
        refused(d, "more than the file's buffers have bytes");
    }
    SECTION("NaN")
    {
        d.root["accessors"][0]["bufferView"] = d.view<float>(std::vector<float>(12, NAN));
        refused(d, "not finite");
    }
    SECTION("cycle")
    {
        d.root["nodes"][1]["children"] = {2};
        d.root["nodes"][2]["children"] = {1};
        refused(d, "its own ancestor");
    }
    SECTION("two parents")
    {
        d.root["nodes"].push_back({{"children", {1}}});
        d.root["nodes"].push_back({{"children", {1}}});
        refused(d, "two parents");
    }
    SECTION("no mesh")
    {
        d.root["nodes"][0].erase("mesh");
        refused(d, "draws no mesh");
    }
    SECTION("short bind matrices")
    {
        d.root["accessors"][3]["count"] = 1;
        refused(d, "fewer inverse bind matrices");
    }
    SECTION("interpolation")
    {
        d.animate("a", "scale", "BEZIER", {0, 1}, {1, 1, 1, 1, 1, 1}, 3);
        refused(d, "unknown interpolation");
    }
    SECTION("key times")
    {
        d.animate("a", "scale", "LINEAR", {1, 0}, {1, 1, 1, 1, 1, 1}, 3);
        refused(d, "do not ascend");
    }
    SECTION("key count")
    {
        d.animate("a", "scale", "CUBICSPLINE", {0, 1}, {1, 1, 1, 1, 1, 1}, 3);
        refused(d, "2 keys but 2 values");
    }
    SECTION("compression")
    {
        d.root["extensionsRequired"] = {"KHR_draco_mesh_compression"};
        refused(d, "compressed");
    }
    CHECK_THROWS_AS(parse_gltf("glTF and then nothing", "a.glb"), InputError);
    CHECK_THROWS_AS(parse_gltf("{", "a.gltf"), InputError);
}

TEST_CASE("joint matrices and weights equal the reference of every character")
{
    const auto folder = test::shared("meshes/skin");
    if (!folder)
        return;
    for (const std::string name : {"CesiumMan", "Fox", "RiggedFigure", "robot"}) {
        INFO(name);
        const Character c = read_gltf(*folder / (name + ".glb"));
        const Influences weights = read_weights_text(*folder / (name + ".weights.txt"), c.mesh.vertices.size());
        CHECK(c.influences.row == weights.row);
        CHECK(c.influences.node == weights.node);
        REQUIRE(c.influences.weight.size() == weights.weight.size());
        for (std::size_t i = 0; i < weights.weight.size(); ++i)
            REQUIRE(std::abs(c.influences.weight[i] - weights.weight[i]) <= 1e-8);

        const std::vector<Clip> clips = read_clips_text(*folder / (name + ".frames.txt"), weights.node_count);
        REQUIRE(clips.size() == c.animations.size());
        const double size = extent(c.mesh).longest_half;
        for (std::size_t i = 0; i < clips.size(); ++i) {
            const Clip ours = sample(c, c.animations[i], 30);
            INFO(clips[i].name);
            CHECK(ours.name == clips[i].name);
            REQUIRE(ours.frame_count() == clips[i].frame_count());
            double worst = 0;
            for (std::size_t f = 0; f < ours.frame_count(); ++f) {
                REQUIRE(ours.time_s(f) == Approx(clips[i].time_s(f)).margin(1e-6));
                const Clip::Frame frame = ours.frame(f), reference = clips[i].frame(f);
                for (std::size_t j = 0; j < frame.size(); ++j)
                    for (int r = 0; r < 3; ++r)
                        for (int col = 0; col < 4; ++col) {
                            const double wanted = reference[j].m[r][col];
                            worst = std::max(worst, std::abs(frame[j].m[r][col] - wanted) /
                                                        std::max({1.0, std::abs(wanted), col == 3 ? size : 0.0}));
                        }
            }
            CHECK(worst < 5e-6); // key frames are floats, and chains of up to ten joints multiply them
        }
    }
}
