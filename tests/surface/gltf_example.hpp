// SPDX-License-Identifier: GPL-3.0-or-later
// Characters made piece by piece, and where their surface is.
#pragma once

#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "cinch/deform.hpp"
#include "cinch/surface.hpp"
#include "tests/support.hpp"
#include "toolkit/surface/character.hpp"

namespace cinch::test {

using nlohmann::json;

inline std::string base64(const std::string& bytes)
{
    const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t group = 0;
        for (std::size_t k = 0; k < 3; ++k)
            group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k)
            out += i + k > bytes.size() ? '=' : digits[group >> (18 - 6 * k) & 63];
    }
    return out;
}

/// A glTF document with one buffer, built piece by piece.
struct Document {
    json root = {{"asset", {{"version", "2.0"}}},
                 {"accessors", json::array()},
                 {"bufferViews", json::array()},
                 {"animations", json::array()}};
    std::string bytes;

    template <class T> int view(const std::vector<T>& values)
    {
        while (bytes.size() % 4)
            bytes += '\0';
        root["bufferViews"].push_back(
            {{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", values.size() * sizeof(T)}});
        bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
        return static_cast<int>(root["bufferViews"].size()) - 1;
    }
    template <class T> int accessor(const std::vector<T>& values, const char* type, int component, int per_element,
                                    bool normalized = false)
    {
        root["accessors"].push_back({{"bufferView", view(values)},
                                     {"componentType", component},
                                     {"type", type},
                                     {"count", values.size() / static_cast<std::size_t>(per_element)},
                                     {"normalized", normalized}});
        return static_cast<int>(root["accessors"].size()) - 1;
    }
    int floats(const std::vector<float>& values, const char* type, int per_element)
    {
        return accessor(values, type, 5126, per_element);
    }
    void animate(const std::string& name, const char* path, const char* interpolation, std::vector<float> times,
                 std::vector<float> values, int per_element)
    {
        const int input = floats(times, "SCALAR", 1),
                  output = floats(values, per_element == 4 ? "VEC4" : "VEC3", per_element);
        json sampler = {{"input", input}, {"output", output}};
        if (*interpolation)
            sampler["interpolation"] = interpolation;
        root["animations"].push_back({{"name", name},
                                      {"samplers", {sampler}},
                                      {"channels", {{{"sampler", 0}, {"target", {{"node", 1}, {"path", path}}}}}}});
    }
    std::string text()
    {
        root["buffers"] = {
            {{"byteLength", bytes.size()}, {"uri", "data:application/octet-stream;base64," + base64(bytes)}}};
        return root.dump();
    }
    Character parse(Coverage coverage = Coverage::whole) { return parse_gltf(text(), "document.gltf", coverage); }
};

/// One triangle; joint 0 is still, joint 1 (bone 1, offset (0, 1, 0) by its bind matrix) moves.
inline Document triangle()
{
    Document d;
    d.root["nodes"] = {
        {{"mesh", 0}, {"skin", 0}}, {{"name", "moving"}, {"translation", {0, 1, 0}}}, {{"name", "still"}}};
    d.root["scenes"] = {{{"nodes", {0, 1, 2}}}};
    const int position = d.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0}, "VEC3", 3);
    const int joints = d.accessor<std::uint8_t>({0, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 0, 0, 1, 0, 0}, "VEC4", 5121, 4);
    const int weights =
        d.accessor<std::uint8_t>({51, 204, 0, 0, 255, 0, 0, 0, 128, 127, 0, 0, 51, 204, 0, 0}, "VEC4", 5121, 4, true);
    const int bind =
        d.floats({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, /**/ 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1},
                 "MAT4", 16);
    const int indices = d.accessor<std::uint16_t>({0, 1, 2, 3, 1, 2}, "SCALAR", 5123, 1);
    d.root["skins"] = {{{"joints", {2, 1}}, {"inverseBindMatrices", bind}}};
    d.root["meshes"] = {{{"primitives",
                          {{{"attributes", {{"POSITION", position}, {"JOINTS_0", joints}, {"WEIGHTS_0", weights}}},
                            {"indices", indices}}}}}};
    return d;
}

/// The box of a character's surface at a time of an animation: of the frame nearest to it.
struct Box {
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
};
inline Box box_at(const Character& character, const Character::Animation& animation, double time_s)
{
    const double length = animation.last_s - animation.first_s;
    const Clip clip = sample(character, animation, length > 0 ? 240 / length : 1);
    std::size_t nearest = 0;
    for (std::size_t f = 0; f < clip.frame_count(); ++f)
        if (std::abs(clip.time_s(f) - time_s) < std::abs(clip.time_s(nearest) - time_s))
            nearest = f;
    std::vector<Vec3> positions(character.mesh.vertices.size());
    evaluate(character.mesh.vertices, to_dyadic(character.influences), clip.frame(nearest), positions);
    Box box;
    for (const Triangle& t : character.mesh.triangles)
        for (const std::uint32_t v : t) {
            box.low = box.low.cwiseMin(positions[v]);
            box.high = box.high.cwiseMax(positions[v]);
        }
    return box;
}

/// The message with which a file is refused, all of its clips tried; empty where it is not.
inline std::string refusal(const std::string& bytes, const std::string& file = "document.gltf")
{
    try {
        const Character c = parse_gltf(bytes, file);
        if (c.animations.empty())
            rest_pose(c);
        for (const auto& animation : c.animations)
            sample(c, animation, 30).frame(0);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

} // namespace cinch::test
