// SPDX-License-Identifier: GPL-3.0-or-later
// The whole surface or nothing: what touches the surface is modelled or refused by name, wherever it stands; what
// cannot move a vertex is no reason to refuse.
#include <cmath>
#include <random>

#include <catch2/catch.hpp>

#include "tests/surface/gltf_example.hpp"
#include "toolkit/surface/character.hpp"

using namespace cinch;
using namespace cinch::test;

namespace {

// The triangle, with what exporters add: materials, a camera, lights, names, extras, shading attributes, a second
// clip, an unskinned mesh and a second skinned one that another scene draws.
Document furnished()
{
    Document d = triangle();
    d.animate("walk", "rotation", "LINEAR", {0, 1}, {0, 0, 0, 1, 0, 0, 0.70710678f, 0.70710678f}, 4);
    d.animate("run", "translation", "STEP", {0, 1}, {0, 1, 0, 4, 1, 0}, 3);
    json& root = d.root;
    const int normals = d.floats(std::vector<float>(12, 0.5f), "VEC3", 3),
              other = d.floats({9, 9, 9, 9, 8, 9, 8, 9, 9}, "VEC3", 3);
    const int joints = d.accessor<std::uint8_t>(std::vector<std::uint8_t>(12, 0), "VEC4", 5121, 4),
              weights = d.floats({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4", 4);
    json& primitive = root["meshes"][0]["primitives"][0];
    primitive["attributes"].update(
        {{"NORMAL", normals}, {"TEXCOORD_0", normals}, {"COLOR_0", normals}, {"_ID", normals}});
    primitive["material"] = 0;
    root["meshes"][0]["name"] = "body";
    root["meshes"].push_back(
        {{"name", "elsewhere"},
         {"primitives", {{{"attributes", {{"POSITION", other}, {"JOINTS_0", joints}, {"WEIGHTS_0", weights}}}}}}});
    root["meshes"].push_back({{"name", "unused"}, {"primitives", {{{"attributes", {{"POSITION", other}}}}}}});
    root["skins"].push_back({{"joints", {5}}});
    root["nodes"][0]["name"] = "figure";
    root["nodes"].push_back({{"name", "camera"},
                             {"camera", 0},
                             {"rotation", {0, 0, 0, 1}},
                             {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}}); // 3
    root["nodes"].push_back({{"name", "elsewhere"}, {"mesh", 1}, {"skin", 1}}); // 4, with 5 and 6 in another scene
    root["nodes"].push_back({{"name", "bone"}});
    root["nodes"].push_back({{"name", "stone"}, {"mesh", 2}});
    root["scene"] = 0;
    root["scenes"] = {{{"name", "main"}, {"nodes", {0, 1, 2, 3}}}, {{"name", "other"}, {"nodes", {4, 5, 6}}}};
    root["materials"] = {{{"name", "skin"},
                          {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}},
                          {"extensions", {{"KHR_materials_unlit", json::object()}}}}};
    root["textures"] = {{{"source", 0}, {"sampler", 0}}};
    root["samplers"] = {{{"magFilter", 9729}}};
    root["images"] = {{{"uri", "there-is-no-such.png"}}};
    root["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}}};
    root["extensions"] = {{"KHR_lights_punctual", {{"lights", {{{"type", "point"}}}}}}};
    root["extensionsUsed"] = {"KHR_lights_punctual", "KHR_materials_unlit", "KHR_texture_transform"};
    root["extensionsRequired"] = {"KHR_materials_unlit", "KHR_texture_transform"};
    root["extras"] = {{"author", "nobody"}};
    root["nodes"][1]["extras"] = {{"translation", {9, 9, 9}}, {"extensions", {{"ACME_wobble", 1}}}};
    d.text(); // sets the buffer
    return d;
}

// Calls `visit` with the place of every object that may have extensions.
void each_object(json& value, const std::string& place, const std::function<void(json&, const std::string&)>& visit)
{
    if (value.is_object()) {
        visit(value, place);
        for (const auto& [key, member] : value.items())
            if (key != "extensions" && key != "extras" && key != "attributes")
                each_object(member, place + "/" + key, visit);
    } else if (value.is_array()) {
        for (std::size_t i = 0; i < value.size(); ++i)
            each_object(value[i], place + "/" + std::to_string(i), visit);
    }
}

bool lies_in(const std::string& place, const std::vector<std::string>& places)
{
    return std::any_of(places.begin(), places.end(),
                       [&](const std::string& p) { return place == p || place.starts_with(p + "/"); });
}

} // namespace

TEST_CASE("what cannot move a vertex is no reason to refuse")
{
    Document d = furnished();
    CHECK(refusal(d.root.dump()) == "");
    const Character c = parse_gltf(d.root.dump(), "document.gltf");
    CHECK(c.mesh.vertices.size() == 3); // nothing of the other scene
    CHECK(c.joints.size() == 2);
    CHECK(c.missing.empty());
}

TEST_CASE("an unknown extension is refused by name wherever it may touch the surface, and nowhere else")
{
    Document d = furnished();
    // What the surface of scene 0 is not made of: accessors and views of shading and of the other scene, and all that
    // is not geometry.
    std::vector<std::string> harmless{"/asset",    "/materials", "/textures", "/samplers", "/images",
                                      "/cameras",  "/scenes/1",  "/nodes/4",  "/nodes/5",  "/nodes/6",
                                      "/meshes/1", "/meshes/2",  "/skins/1"};
    const std::size_t all = d.root["accessors"].size();
    for (std::size_t i = all - 4; i < all; ++i) // normals, and three of the other scene
        for (const char* list : {"/accessors/", "/bufferViews/"})
            harmless.push_back(list + std::to_string(i));
    std::size_t refused = 0, accepted = 0;
    each_object(d.root, "", [&](json& object, const std::string& place) {
        INFO(place);
        const json before = object;
        object["extensions"]["ACME_wobble"] = json::object();
        const std::string message = refusal(d.root.dump());
        if (lies_in(place, harmless)) {
            CHECK(message == "");
            ++accepted;
        } else {
            CHECK_THAT(message, Catch::StartsWith("document.gltf: ") && Catch::Contains("the extension ACME_wobble"));
            const Character partial = parse_gltf(d.root.dump(), "document.gltf", Coverage::partial);
            CHECK(partial.mesh.triangles.size() == 2);
            std::size_t named = partial.missing.size();
            for (const auto& animation : partial.animations)
                named += animation.missing.size();
            CHECK(named > 0);
            ++refused;
        }
        for (const char* name :
             {"KHR_materials_clearcoat", "KHR_texture_transform", "EXT_texture_webp", "KHR_lights_punctual",
              "KHR_xmp_json_ld", "KHR_materials_variants", "EXT_mesh_features"}) {
            object = before;
            object["extensions"][name] = json::object();
            CHECK(refusal(d.root.dump()) == "");
        }
        for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression", "KHR_draco_mesh_compression"}) {
            object = before;
            object["extensions"][name] = json::object();
            if (!lies_in(place, harmless))
                CHECK_THAT(refusal(d.root.dump()), Catch::Contains(std::string("is compressed with ") + name));
        }
        object = before;
    });
    CHECK(refused > 25);
    CHECK(accepted > 15);
}

TEST_CASE("an extension that the file requires is known or named")
{
    for (const std::string name :
         {"ACME_wobble", "KHR_interactivity", "MSFT_lod", "VRMC_springBone", "KHR_materials_displacement", ""}) {
        Document d = furnished();
        d.root["extensionsRequired"] = {"KHR_materials_unlit", name};
        CHECK_THAT(refusal(d.root.dump()),
                   Catch::Contains("what is not modelled: the extension " + name + " (required)"));
    }
    for (const std::string name :
         {"KHR_mesh_quantization", "KHR_node_visibility", "KHR_animation_pointer", "EXT_mesh_gpu_instancing",
          "KHR_texture_basisu", "KHR_lights_punctual", "KHR_materials_variants"}) {
        Document d = furnished();
        d.root["extensionsRequired"] = {name};
        CHECK(refusal(d.root.dump()) == "");
    }
}

TEST_CASE("what programs add that moves or multiplies the surface is refused by name")
{
    for (const auto& [node, name] : {std::pair(0, "EXT_mesh_gpu_instancing"),
                                     {1, "VRMC_node_constraint"},
                                     {0, "MSFT_lod"},
                                     {3, "VRMC_springBone_collider"},
                                     {2, "AGI_articulations"}}) {
        Document d = furnished();
        d.root["nodes"][static_cast<std::size_t>(node)]["extensions"][name] = json::object();
        CHECK_THAT(refusal(d.root.dump()),
                   Catch::Contains(std::string("the extension ") + name + " (nodes[" + std::to_string(node) + "]"));
    }
    for (const char* name : {"VRMC_springBone", "KHR_interactivity", "KHR_physics_rigid_bodies", "CESIUM_RTC"}) {
        Document d = furnished();
        d.root["extensions"][name] = json::object();
        CHECK_THAT(refusal(d.root.dump()), Catch::Contains(std::string("the extension ") + name));
    }
    for (const char* name : {"VRM", "VRMC_vrm"}) { // an avatar's names of bones and faces; its springs move it
        Document d = furnished();
        d.root["extensionsRequired"] = {name};
        d.root["extensions"][name] = {{"secondaryAnimation", {{"boneGroups", json::array()}}}};
        CHECK(refusal(d.root.dump()) == "");
        d.root["extensions"][name]["secondaryAnimation"]["boneGroups"].push_back({{"bones", {1}}});
        if (name == std::string("VRM"))
            CHECK_THAT(refusal(d.root.dump()), Catch::Contains("the extension VRM"));
    }
    Document bare = furnished(); // a part of the skinned mesh that no joint moves
    bare.root["meshes"][0]["primitives"].push_back(bare.root["meshes"][2]["primitives"][0]);
    CHECK_THAT(refusal(bare.root.dump()),
               Catch::Contains("a part of a skinned mesh without joints and weights (meshes[0].primitives[1])"));
    for (int mode = 0; mode < 4; ++mode) {
        Document thin = furnished();
        json line = thin.root["meshes"][0]["primitives"][0];
        line["mode"] = mode;
        thin.root["meshes"][0]["primitives"].push_back(line);
        CHECK_THAT(refusal(thin.root.dump()),
                   Catch::Contains(mode == 0 ? "points (meshes[0].primitives[1])" : "lines (meshes[0].primitives[1])"));
    }
    Document attribute = furnished();
    attribute.root["meshes"][0]["primitives"][0]["attributes"]["WOBBLE"] = 0;
    CHECK_THAT(refusal(attribute.root.dump()), Catch::Contains("the attribute 'WOBBLE'"));
    Document path = furnished();
    path.root["animations"][0]["channels"][0]["target"]["path"] = "skew";
    CHECK_THAT(refusal(path.root.dump()), Catch::Contains("the animation of 'skew'"));
}

TEST_CASE("hidden nodes are not drawn")
{
    Document d = furnished();
    d.root["scenes"][0]["nodes"].push_back(6);
    d.root["nodes"][6]["extensions"]["KHR_node_visibility"] = {{"visible", true}};
    const Character with_stone = parse_gltf(d.root.dump(), "document.gltf");
    CHECK(with_stone.carried == 1);
    CHECK(with_stone.mesh.triangles.size() == 3);
    d.root["nodes"][6]["extensions"]["KHR_node_visibility"]["visible"] = false;
    CHECK(parse_gltf(d.root.dump(), "document.gltf").mesh.triangles.size() == 2);
    d.root["scenes"][0]["nodes"] = {0, 1, 2, 3};
    d.root["nodes"][3]["children"] = {6};
    d.root["nodes"][6].erase("extensions");
    d.root["nodes"][3]["extensions"]["KHR_node_visibility"] = {{"visible", false}};
    CHECK_THAT(refusal(d.root.dump()), Catch::Contains("is named by scenes[1] 'other'") || Catch::Equals(""));
    d.root["scenes"].erase(1);
    CHECK(parse_gltf(d.root.dump(), "document.gltf").mesh.triangles.size() == 2);
}

TEST_CASE("the default scene alone is read")
{
    Document d = furnished();
    d.root["scene"] = 1;
    d.root["scenes"][1]["nodes"] = {4, 5};
    const Character other = parse_gltf(d.root.dump(), "document.gltf");
    CHECK(other.joints.size() == 1);
    CHECK(other.mesh.triangles.size() == 1);
    CHECK(other.mesh.vertices[0] == Vec3(9, 9, 9));
    d.root.erase("scene"); // the first then
    CHECK(parse_gltf(d.root.dump(), "document.gltf").joints.size() == 2);
    d.root["scene"] = 7;
    CHECK_THAT(refusal(d.root.dump()), Catch::Contains("scenes[7] does not exist"));
    d.root.erase("scene");
    d.root.erase("scenes"); // all nodes then, so the stone too
    const Character all = parse_gltf(d.root.dump(), "document.gltf");
    CHECK(all.joints.size() == 4);
    CHECK(all.carried == 1);
    CHECK(all.influences.node.back() == 3);
    d.root["nodes"].erase(6);
    CHECK(parse_gltf(d.root.dump(), "document.gltf").joints.size() == 3);
}

TEST_CASE("morph targets: refused where a weight of one that displaces positions is not 0 in the clip")
{
    std::mt19937 random(1);
    auto chance = [&](double p) { return std::uniform_real_distribution<>(0, 1)(random) < p; };
    std::size_t refused = 0;
    const std::size_t cases = share_of(3000);
    for (std::size_t i = 0; i < cases; ++i) {
        Document d = furnished();
        json& mesh = d.root["meshes"][0];
        const std::size_t targets = 1 + random() % 3;
        std::vector<bool> displaces;
        for (std::size_t t = 0; t < targets; ++t) {
            displaces.push_back(chance(0.6));
            mesh["primitives"][0]["targets"].push_back({{displaces[t] ? "POSITION" : "NORMAL", 0}});
        }
        auto weights = [&] {
            std::vector<float> w;
            for (std::size_t t = 0; t < targets; ++t)
                w.push_back(chance(0.5) ? 0.0f : chance(0.5) ? 0.5f : -1.0f);
            return w;
        };
        auto moves = [&](const std::vector<float>& w) {
            for (std::size_t k = 0; k < w.size(); ++k)
                if (w[k] != 0 && displaces[k % targets])
                    return true;
            return false;
        };
        std::vector<float> standing(targets, 0.0f);
        if (chance(0.5))
            mesh["weights"] = standing = weights();
        if (chance(0.5))
            d.root["nodes"][0]["weights"] = standing = weights();
        bool expected[2];
        for (std::size_t a = 0; a < 2; ++a) {
            expected[a] = moves(standing);
            if (!chance(0.5))
                continue;
            std::vector<float> values;
            const bool cubic = chance(0.3);
            for (int set = 0; set < (cubic ? 6 : 2); ++set)
                for (const float w : weights())
                    values.push_back(chance(0.5) ? 0 : w);
            const bool pointer = chance(0.3);
            json target = {{"path", pointer ? "pointer" : "weights"}};
            if (pointer)
                target["extensions"]["KHR_animation_pointer"]["pointer"] = "/nodes/0/weights";
            else
                target["node"] = 0;
            json& animation = d.root["animations"][a];
            animation["samplers"].push_back({{"input", d.floats({0, 1}, "SCALAR", 1)},
                                             {"output", d.floats(values, "SCALAR", 1)},
                                             {"interpolation", cubic ? "CUBICSPLINE" : "LINEAR"}});
            animation["channels"].push_back({{"sampler", 1}, {"target", target}});
            expected[a] = moves(values);
        }
        const bool drawn = !chance(0.2);
        if (!drawn) { // the same mesh, but another is drawn
            d.root["scenes"][0]["nodes"] = {1, 2, 3, 4, 5};
            d.root["scenes"].erase(1);
        }
        const Character c = d.parse(Coverage::partial);
        CHECK(c.rest.missing.empty() == !(drawn && moves(standing)));
        for (std::size_t a = 0; a < 2; ++a) {
            INFO(i << ' ' << d.root["meshes"].dump() << d.root["nodes"].dump() << d.root["animations"].dump());
            REQUIRE(c.animations[a].fault == "");
            REQUIRE(c.animations[a].missing.empty() == !(drawn && expected[a]));
            refused += drawn && expected[a];
            const Character whole = d.parse();
            if (drawn && expected[a])
                CHECK_THROWS_WITH(sample(whole, whole.animations[a], 1),
                                  Catch::Contains("morph targets with weights that are not 0 (nodes[0] 'figure')"));
            else
                CHECK(sample(whole, whole.animations[a], 1).frame_count() == 2);
        }
    }
    CHECK(refused > cases / 4);
}

TEST_CASE("pointers at nodes are channels, those at materials are nothing, all others are named")
{
    const Document d = furnished();
    auto with = [&](const std::string& pointer) {
        Document copy = d;
        json& target = copy.root["animations"][0]["channels"][0]["target"];
        target = {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}};
        return copy;
    };
    Document plain = d, pointed = with("/nodes/1/rotation");
    const Character a = plain.parse(), b = pointed.parse();
    for (const double t : {0.0, 0.3, 1.0}) {
        CHECK(box_at(a, a.animations[0], t).low == box_at(b, b.animations[0], t).low);
        CHECK(box_at(a, a.animations[0], t).high == box_at(b, b.animations[0], t).high);
    }
    for (const char* pointer :
         {"/materials/0/pbrMetallicRoughness/baseColorFactor", "/cameras/0/perspective/yfov",
          "/extensions/KHR_lights_punctual/lights/0/intensity", "/materials/0/extensions/KHR_texture_transform/offset",
          "/nodes/3/extensions/KHR_lights_punctual/light", "/nodes/3/translation"})
        CHECK(refusal(with(pointer).text()) == "");
    for (const char* pointer :
         {"/nodes/1/matrix", "/nodes/1/extensions/KHR_node_visibility/visible", "/nodes/1/translation/0",
          "/meshes/0/weights", "/skins/0/inverseBindMatrices", "/scenes/0/nodes", "nodes/1/rotation",
          "/nodes/x/rotation", "/nodes", "/extensions/ACME_wobble/force", "/accessors/0/count"})
        CHECK_THAT(refusal(with(pointer).text()), Catch::Contains(std::string("the animation of ") + pointer));
    CHECK_THAT(refusal(with("/nodes/99/rotation").text()), Catch::Contains("nodes[99] does not exist"));
}
