// SPDX-License-Identifier: GPL-3.0-or-later
// What Draco and meshoptimizer packed is read as what it was.
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>

#include <draco/compression/decode.h>
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <meshoptimizer.h>
#include <unistd.h>

#include "cinch/simulate.hpp"
#include "tests/surface/gltf_example.hpp"
#include "toolkit/surface/text_scan.hpp"

using namespace cinch;
using cinch::test::Document;
using cinch::test::json;

namespace {

constexpr int vertices = 200;
using Bytes = std::vector<unsigned char>;

// A strip that two joints bend, as lists of numbers.
struct Strip {
    std::vector<float> position, weight;
    std::vector<std::uint8_t> joint;
    std::vector<std::uint16_t> index;
    std::vector<std::uint8_t> byte_weight;
};
Strip strip()
{
    Strip s;
    for (int i = 0; i < vertices; ++i) {
        s.position.insert(s.position.end(), {static_cast<float>(i % 2), 0.1f * static_cast<float>(i),
                                             std::sin(0.3f * static_cast<float>(i))});
        s.joint.insert(s.joint.end(), {0, 1, 0, 0});
        const int w = i * 255 / (vertices - 1);
        s.weight.insert(s.weight.end(), {static_cast<float>(255 - w) / 256, static_cast<float>(w) / 256, 0, 0});
        s.byte_weight.insert(s.byte_weight.end(),
                             {static_cast<std::uint8_t>(255 - w), static_cast<std::uint8_t>(w), 0, 0});
        if (i + 2 < vertices)
            for (const int corner : {i, i + 1 + i % 2, i + 2 - i % 2})
                s.index.push_back(static_cast<std::uint16_t>(corner));
    }
    return s;
}

Document document(const Strip& s, bool bytes)
{
    Document d;
    d.root["nodes"] = {{{"mesh", 0}, {"skin", 0}}, {{"translation", {0, 1, 0}}}, json::object()};
    d.root["scenes"] = {{{"nodes", {0, 1, 2}}}};
    const int position = d.floats(s.position, "VEC3", 3), joint = d.accessor(s.joint, "VEC4", 5121, 4),
              weight = bytes ? d.accessor(s.byte_weight, "VEC4", 5121, 4, true) : d.floats(s.weight, "VEC4", 4),
              index = d.accessor(s.index, "SCALAR", 5123, 1);
    d.root["skins"] = {{{"joints", {2, 1}}}};
    d.root["meshes"] = {{{"primitives",
                          {{{"attributes", {{"POSITION", position}, {"JOINTS_0", joint}, {"WEIGHTS_0", weight}}},
                            {"indices", index}}}}}};
    return d;
}

// The bytes of an accessor's view replaced by packed ones, as gltfpack does.
void pack(Document& d, int accessor, std::size_t count, std::size_t stride, const char* mode, const Bytes& packed,
          const char* filter = nullptr, const char* extension = "EXT_meshopt_compression")
{
    const int view = d.view(packed);
    json of = d.root["bufferViews"][static_cast<std::size_t>(view)];
    of.update({{"count", count}, {"byteStride", stride}, {"mode", mode}});
    if (filter)
        of["filter"] = filter;
    json& old = d.root["bufferViews"][static_cast<std::size_t>(accessor)]; // one view for each accessor here
    old["byteStride"] = stride;
    old["extensions"] = {{extension, of}};
    d.root["extensionsRequired"] = d.root["extensionsUsed"] = {extension};
}

template <class T> Bytes packed_vertices(const std::vector<T>& values, std::size_t count)
{
    const std::size_t stride = values.size() * sizeof(T) / count;
    Bytes out(meshopt_encodeVertexBufferBound(count, stride));
    out.resize(meshopt_encodeVertexBuffer(out.data(), out.size(), values.data(), count, stride));
    return out;
}

Character read(Document& d, const Decompression* decoders = &decompression())
{
    return parse_gltf(d.text(), "document.gltf", Coverage::whole, Morphs::missing, decoders);
}

// Places with weights, of every triangle; the order of vertices may differ.
std::vector<std::vector<double>> triangles(const Character& c)
{
    std::vector<std::vector<double>> out;
    for (const Triangle& t : c.mesh.triangles) {
        std::vector<std::vector<double>> corners;
        for (const std::uint32_t v : t) {
            corners.push_back({c.mesh.vertices[v][0], c.mesh.vertices[v][1], c.mesh.vertices[v][2]});
            for (std::size_t i = c.influences.row[v]; i < c.influences.row[v + 1]; ++i) {
                corners.back().push_back(c.influences.node[i]);
                corners.back().push_back(c.influences.weight[i]);
            }
        }
        std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
        out.emplace_back();
        for (const auto& corner : corners)
            out.back().insert(out.back().end(), corner.begin(), corner.end());
    }
    std::sort(out.begin(), out.end());
    return out;
}

Bytes draco_of(const Strip& s, bool bytes, int position_bits, std::map<std::string, int>& ids)
{
    draco::TriangleSoupMeshBuilder builder;
    builder.Start(static_cast<int>(s.index.size() / 3));
    const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32),
              joint = builder.AddAttribute(draco::GeometryAttribute::GENERIC, 4, draco::DT_UINT8),
              weight = builder.AddAttribute(draco::GeometryAttribute::GENERIC, 4,
                                            bytes ? draco::DT_UINT8 : draco::DT_FLOAT32, bytes);
    for (std::size_t t = 0; t < s.index.size() / 3; ++t) {
        const auto* i = &s.index[3 * t];
        const draco::FaceIndex face(static_cast<std::uint32_t>(t));
        auto set = [&](int attribute, const auto& values, std::size_t n) {
            builder.SetAttributeValuesForFace(attribute, face, &values[n * i[0]], &values[n * i[1]], &values[n * i[2]]);
        };
        set(position, s.position, 3);
        set(joint, s.joint, 4);
        bytes ? set(weight, s.byte_weight, 4) : set(weight, s.weight, 4);
    }
    const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
    for (const auto& [name, id] : {std::pair("POSITION", position), {"JOINTS_0", joint}, {"WEIGHTS_0", weight}})
        ids[name] = static_cast<int>(mesh->attribute(id)->unique_id());
    draco::Encoder encoder;
    if (position_bits)
        encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, position_bits);
    draco::EncoderBuffer buffer;
    REQUIRE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
    return {buffer.data(), buffer.data() + buffer.size()};
}

// The document with its primitive packed; accessors keep counts and types alone.
Document draco_document(const Strip& s, bool bytes, int position_bits)
{
    Document d = document(s, bytes);
    std::map<std::string, int> ids;
    const Bytes packed = draco_of(s, bytes, position_bits, ids);
    Document out;
    out.root = d.root;
    out.root["bufferViews"] = json::array();
    const int view = out.view(packed);
    for (json& accessor : out.root["accessors"])
        accessor.erase("bufferView");
    draco::DecoderBuffer again;
    again.Init(reinterpret_cast<const char*>(packed.data()), packed.size());
    const auto mesh = draco::Decoder().DecodeMeshFromBuffer(&again);
    for (std::size_t i = 0; i < 3; ++i)
        out.root["accessors"][i]["count"] = mesh.value()->num_points();
    out.root["meshes"][0]["primitives"][0]["extensions"] = {
        {"KHR_draco_mesh_compression", {{"bufferView", view}, {"attributes", ids}}}};
    out.root["extensionsRequired"] = out.root["extensionsUsed"] = {"KHR_draco_mesh_compression"};
    return out;
}

std::string refusal(Document& d, const Decompression* decoders = &decompression())
{
    try {
        read(d, decoders);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

} // namespace

TEST_CASE("what meshoptimizer packed is read as what it was")
{
    const Strip s = strip();
    Document plain = document(s, true);
    const Character expected = read(plain);
    for (const char* extension : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
        for (const bool sequence : {false, true}) {
            Document d = document(s, true);
            pack(d, 0, vertices, 12, "ATTRIBUTES", packed_vertices(s.position, vertices), nullptr, extension);
            pack(d, 1, vertices, 4, "ATTRIBUTES", packed_vertices(s.joint, vertices), nullptr, extension);
            pack(d, 2, vertices, 4, "ATTRIBUTES", packed_vertices(s.byte_weight, vertices), "NONE", extension);
            std::vector<unsigned> index(s.index.begin(), s.index.end());
            Bytes packed(10 * index.size() + 100);
            packed.resize(sequence
                              ? meshopt_encodeIndexSequence(packed.data(), packed.size(), index.data(), index.size())
                              : meshopt_encodeIndexBuffer(packed.data(), packed.size(), index.data(), index.size()));
            pack(d, 3, index.size(), 2, sequence ? "INDICES" : "TRIANGLES", packed, nullptr, extension);
            const Character c = read(d);
            CHECK(c.mesh.vertices == expected.mesh.vertices);
            CHECK(triangles(c) == triangles(expected)); // the codec may begin a triangle at another corner
            CHECK(c.influences.step == expected.influences.step);
            CHECK_THAT(refusal(d, nullptr), Catch::Contains("is compressed with " + std::string(extension)));
        }
}

TEST_CASE("meshoptimizer's filters")
{
    const Strip s = strip();
    Document d = document(s, true);
    std::vector<float> even = s.position;
    even.resize(12 * ((vertices + 3) / 4));
    std::vector<std::uint32_t> filtered(even.size());
    meshopt_encodeFilterExp(filtered.data(), vertices, 12, 15, even.data());
    filtered.resize(s.position.size());
    pack(d, 0, vertices, 12, "ATTRIBUTES", packed_vertices(filtered, vertices), "EXPONENTIAL");
    const Character c = read(d);
    REQUIRE(c.mesh.vertices.size() == vertices);
    for (std::size_t i = 0; i < vertices; ++i)
        for (int r = 0; r < 3; ++r)
            CHECK(std::abs(c.mesh.vertices[i][r] - s.position[3 * i + static_cast<std::size_t>(r)]) < 20 * 0x1p-14);
    // A rotation's keys: quaternions.
    std::vector<float> turns;
    for (int k = 0; k < 5; ++k) {
        const float a = 0.2f * static_cast<float>(k);
        turns.insert(turns.end(), {std::sin(a), 0, 0, std::cos(a)});
    }
    Document animated = document(s, true);
    std::vector<std::int16_t> quaternions(4 * 8);
    std::vector<float> padded = turns;
    padded.resize(4 * 8, 0.5f);
    meshopt_encodeFilterQuat(quaternions.data(), 5, 8, 16, padded.data());
    quaternions.resize(4 * 5);
    const int times = animated.floats({0, 1, 2, 3, 4}, "SCALAR", 1),
              output = animated.accessor(quaternions, "VEC4", 5122, 4, true);
    animated.root["animations"] = {{{"name", "turn"},
                                    {"samplers", {{{"input", times}, {"output", output}}}},
                                    {"channels", {{{"sampler", 0}, {"target", {{"node", 1}, {"path", "rotation"}}}}}}}};
    pack(animated, output, 5, 8, "ATTRIBUTES", packed_vertices(quaternions, 5), "QUATERNION");
    const Character turned = read(animated);
    REQUIRE(turned.animations.at(0).curves.size() == 1);
    for (std::size_t k = 0; k < 5; ++k)
        for (std::size_t i = 0; i < 4; ++i)
            CHECK(std::abs(turned.animations[0].curves[0].value.at(k)[i] - turns[4 * k + i]) < 0x1p-12);
}

TEST_CASE("what Draco packed is read as what it was")
{
    const Strip s = strip();
    for (const bool bytes : {false, true}) {
        Document plain = document(s, bytes);
        Document packed = draco_document(s, bytes, 0);
        const Character expected = read(plain), c = read(packed);
        CHECK(triangles(c) == triangles(expected));
        CHECK(c.mesh.vertices.size() == expected.mesh.vertices.size());
        CHECK(c.influences.step == expected.influences.step);
        CHECK_THAT(refusal(packed, nullptr), Catch::Contains("is compressed with KHR_draco_mesh_compression"));
    }
    Document quantised = draco_document(s, true, 14);
    Document plain = document(s, true);
    const Character c = read(quantised), expected = read(plain);
    CHECK(c.mesh.triangles.size() == expected.mesh.triangles.size());
    double longest = 0;
    for (const Vec3& v : c.mesh.vertices)
        longest = std::max(longest, v[1]);
    CHECK(std::abs(longest - 0.1 * (vertices - 1)) < 20 * 0x1p-13);
}

TEST_CASE("a scene whose body is packed is the one whose body is not, with decoders")
{
    const Strip s = strip();
    const auto folder = std::filesystem::temp_directory_path() / ("cinch-packed-" + std::to_string(getpid()));
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "plain.gltf") << document(s, false).text();
    std::ofstream(folder / "packed.gltf") << draco_document(s, false, 0).text();
    auto simulation = [&](const std::string& file, const Decompression* decoders) {
        const json scene = {{"duration", 1},
                            {"effects", json::array()},
                            {"bodies", {{{"name", "strip"}, {"surface", file}, {"nodes", 12}}}}};
        return SceneSimulation(scene.dump(), "scene.json", folder, decoders);
    };
    const SceneSimulation plain = simulation("plain.gltf", nullptr),
                          packed = simulation("packed.gltf", &decompression());
    auto triangles_of = [](const SceneSimulation& of) { // their order and that of vertices may differ
        const TriangleMesh& mesh = of.surface(0)->mesh;
        std::vector<std::vector<std::vector<double>>> all;
        for (const Triangle& t : mesh.triangles) {
            all.emplace_back();
            for (const std::uint32_t v : t)
                all.back().push_back({mesh.vertices[v][0], mesh.vertices[v][1], mesh.vertices[v][2]});
            std::sort(all.back().begin(), all.back().end());
        }
        std::sort(all.begin(), all.end());
        return all;
    };
    CHECK(triangles_of(plain).size() == vertices - 2);
    CHECK(triangles_of(plain) == triangles_of(packed));
    CHECK_THROWS_WITH(simulation("packed.gltf", nullptr), Catch::Contains("is compressed"));
    std::filesystem::remove_all(folder);
}

TEST_CASE("packed data that is damaged is refused, and never read past its end")
{
    const Strip s = strip();
    const Document draco = draco_document(s, true, 0);
    Document meshopt = document(s, true);
    pack(meshopt, 0, vertices, 12, "ATTRIBUTES", packed_vertices(s.position, vertices));
    std::size_t refused = 0, rounds = 400;
    std::uint32_t random = 1;
    for (const Document& whole : {draco, meshopt})
        for (std::size_t round = 0; round < rounds; ++round) {
            Document d = whole;
            for (int change = 0; change < 3; ++change) {
                random = random * 1664525u + 1013904223u;
                d.bytes[random % d.bytes.size()] = static_cast<char>(random >> 24);
            }
            refused += !refusal(d).empty(); // what remains is another mesh
        }
    CHECK(refused > rounds / 4);
    auto changed = [&](const std::function<void(json&)>& change) {
        Document d = meshopt;
        change(d.root["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]);
        return refusal(d);
    };
    CHECK_THAT(changed([](json& of) { of["count"] = 1u << 30; }), Catch::Contains("declares 1073741824 elements"));
    CHECK_THAT(changed([](json& of) { of["byteStride"] = 6; }), Catch::Contains("cannot be decoded"));
    CHECK_THAT(changed([](json& of) { of["byteLength"] = 1u << 20; }), Catch::Contains("reaches past its buffer"));
    CHECK_THAT(changed([](json& of) { of["mode"] = "ELSE"; }), Catch::Contains("unknown mode ELSE"));
    CHECK_THAT(changed([](json& of) { of["filter"] = "ELSE"; }), Catch::Contains("filter ELSE"));
    CHECK_THAT(changed([](json& of) { of["count"] = 20; }), Catch::Contains("cannot be decoded"));
    Document strip_mode = draco;
    strip_mode.root["meshes"][0]["primitives"][0]["mode"] = 5;
    CHECK_THAT(refusal(strip_mode), Catch::Contains("no list of triangles"));
    Document other_count = draco;
    other_count.root["accessors"][0]["count"] = 7;
    CHECK_THAT(refusal(other_count), Catch::Contains("another number of POSITION"));
    Document no_attribute = draco;
    no_attribute
        .root["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]["attributes"]["POSITION"] = 77;
    CHECK_THAT(refusal(no_attribute), Catch::Contains("no attribute 77"));
}
