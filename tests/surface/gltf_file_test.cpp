// SPDX-License-Identifier: GPL-3.0-or-later
// Files, buffers, accessors and key frames as the specification allows them, and what is said of those that it does
// not.
#include <cmath>
#include <random>

#include <catch2/catch.hpp>

#include "tests/surface/gltf_example.hpp"
#include "toolkit/surface/character.hpp"
#include "toolkit/surface/read_mesh.hpp"

using namespace cinch;
using namespace cinch::test;

namespace {

std::string binary_file(const std::string& text, const std::string& chunk)
{
    auto word = [](std::size_t x) {
        std::string out;
        for (int i = 0; i < 4; ++i)
            out += static_cast<char>(x >> 8 * i & 255);
        return out;
    };
    std::string body = word((text.size() + 3) / 4 * 4) + "JSON" + text + std::string((4 - text.size() % 4) % 4, ' ');
    if (!chunk.empty())
        body += word((chunk.size() + 3) / 4 * 4) + std::string("BIN\0", 4) + chunk +
                std::string((4 - chunk.size() % 4) % 4, '\0');
    return "glTF" + word(2) + word(12 + body.size()) + body;
}

} // namespace

TEST_CASE("a buffer's file is found under any name")
{
    for (const auto& [uri, name] : {std::pair("a+b.bin", "a+b.bin"),
                                    {"a%2Bb.bin", "a+b.bin"},
                                    {"a b.bin", "a b.bin"},
                                    {"a%20b.bin", "a b.bin"},
                                    {"100%.bin", "100%.bin"},
                                    {"%zz%4.bin", "%zz%4.bin"},
                                    {"a%20b%25.bin", "a b%.bin"},
                                    {"as%20it%20stands.bin", "as%20it%20stands.bin"},
                                    {"./a&b=c;d.bin", "a&b=c;d.bin"},
                                    {"%C3%A4.bin", "\xC3\xA4.bin"},
                                    {"\xC3\xA4.bin", "\xC3\xA4.bin"}}) {
        INFO(uri);
        Document d = triangle();
        d.text();
        const TemporaryFolder folder;
        d.root["buffers"][0]["uri"] = uri;
        for (std::string other : {"a b.bin", "a+b.bin", "a%2Bb.bin"}) // none of which is taken for it
            folder.write(other, "short");
        folder.write(name, d.bytes);
        CHECK(read_gltf(folder.write("file.gltf", d.root.dump())).mesh.vertices.size() == 3);
    }
    Document d = triangle();
    d.text();
    d.root["buffers"][0]["uri"] = "gone.bin";
    CHECK_THAT(refusal(d.root.dump()), Catch::Contains("buffers[0] cannot be read: gone.bin: no such file"));
    d.root["buffers"][0]["uri"] = "https://example.org/a.bin";
    CHECK_THAT(refusal(d.root.dump()), Catch::Contains("buffers[0] lies elsewhere, at https://example.org/a.bin"));
    d.root["buffers"][0].erase("uri");
    CHECK_THAT(refusal(d.root.dump()), Catch::Contains("buffers[0] has no data"));
    CHECK(refusal(binary_file(d.root.dump(), d.bytes)) == "");
    CHECK_THAT(refusal(binary_file(d.root.dump(), d.bytes.substr(8))),
               Catch::Contains("buffers[0] declares") && Catch::Contains("but there are"));
    CHECK_THAT(refusal(binary_file(d.root.dump(), "")), Catch::Contains("buffers[0] has no data"));
    d.root["buffers"][0]["uri"] = "data:application/octet-stream;base64,AAAA*AAA";
    CHECK_THAT(refusal(d.root.dump()), Catch::Contains("no base64 at character 41"));
    d.root["buffers"][0]["uri"] = "data:application/octet-stream;base64";
    CHECK_THAT(refusal(d.root.dump()), Catch::Contains("without a comma"));
}

TEST_CASE("data URIs are decoded, whatever their padding")
{
    for (std::size_t extra = 0; extra < 3; ++extra)
        for (const bool padded : {true, false}) {
            Document d = triangle();
            d.bytes += std::string(extra, 'x');
            d.text();
            std::string uri = d.root["buffers"][0]["uri"];
            while (!padded && uri.back() == '=')
                uri.pop_back();
            d.root["buffers"][0]["uri"] = uri;
            CHECK(refusal(d.root.dump()) == "");
            CHECK(parse_gltf(d.root.dump(), "d.gltf").mesh.vertices[1] == Vec3(1, 0, 0));
        }
}

TEST_CASE("accessors without a buffer view are zeros")
{
    Document d = triangle();
    d.animate("a", "translation", "LINEAR", {0, 1}, {0, 0, 0, 0, 0, 0}, 3);
    for (const std::size_t accessor : {0u, 1u, 6u}) { // positions, joints, translations
        INFO(accessor);
        Document zeros = d, none = d;
        json& view = zeros.root["bufferViews"][zeros.root["accessors"][accessor]["bufferView"].get<std::size_t>()];
        for (std::size_t i = 0; i < view["byteLength"].get<std::size_t>(); ++i)
            zeros.bytes[view["byteOffset"].get<std::size_t>() + i] = '\0';
        none.root["accessors"][accessor].erase("bufferView");
        const Character a = zeros.parse(), b = none.parse();
        CHECK(a.mesh.vertices == b.mesh.vertices);
        CHECK(a.influences.node == b.influences.node);
        CHECK(box_at(a, a.animations[0], 0.5).high == box_at(b, b.animations[0], 0.5).high);
        // With elements substituted they are the elements, and zeros.
        const bool joints = accessor == 1;
        const int at = d.view<std::uint16_t>({1}),
                  value = joints ? d.view<std::uint8_t>({1, 0, 0, 0}) : d.view<float>({7, 8, 9});
        Document some = d;
        some.root["accessors"][accessor].erase("bufferView");
        some.root["accessors"][accessor]["sparse"] = {{"count", 1},
                                                      {"indices", {{"bufferView", at}, {"componentType", 5123}}},
                                                      {"values", {{"bufferView", value}}}};
        const Character c = some.parse();
        if (accessor == 0)
            CHECK(std::find(c.mesh.vertices.begin(), c.mesh.vertices.end(), Vec3(7, 8, 9)) != c.mesh.vertices.end());
        if (accessor == 6)
            CHECK(c.animations[0].curves[0].value[1][2] == 9);
        CHECK(refusal(some.text()) == "");
    }
    d.root["accessors"][1].erase("bufferView");
    d.root["accessors"][1]["count"] = 4000000000u;
    CHECK_THAT(refusal(d.text()), Catch::Contains("more than the file's buffers have bytes"));
}

TEST_CASE("quantised positions are read as they are stored")
{
    for (const bool normalized : {true, false}) {
        Document d = triangle();
        d.root["extensionsRequired"] = {"KHR_mesh_quantization"};
        const int view =
            d.view<std::int16_t>({0, 0, 0, 0, 32767, 0, 0, 0, 0, 32767, 0, 0, 0, 0, 0, 0}); // padded to 8 bytes each
        d.root["bufferViews"][static_cast<std::size_t>(view)]["byteStride"] = 8;
        d.root["accessors"][0] = {
            {"bufferView", view}, {"componentType", 5122}, {"type", "VEC3"}, {"count", 4}, {"normalized", normalized}};
        CHECK(d.parse().mesh.vertices[1] == Vec3(normalized ? 1 : 32767, 0, 0));
    }
}

TEST_CASE("of keys at one time the later one wins, from that time on")
{
    Document d = triangle();
    d.animate("twice", "translation", "LINEAR", {0, 1, 1, 2}, {0, 0, 0, 4, 0, 0, 10, 0, 0, 12, 0, 0}, 3);
    d.animate("sound", "translation", "LINEAR", {0, 2}, {0, 0, 0, 4, 0, 0}, 3);
    d.animate("back", "translation", "LINEAR", {0, 2, 1}, {0, 0, 0, 4, 0, 0, 5, 0, 0}, 3);
    const Character c = d.parse();
    const Clip twice = sample(c, c.animations[0], 2);
    REQUIRE(twice.frame_count() == 5);
    const double wanted[] = {0, 2, 10, 11, 12};
    for (std::size_t f = 0; f < 5; ++f)
        CHECK(twice.frame(f)[1].m[0][3] == wanted[f]);
    REQUIRE(c.animations[0].notes.size() == 1);
    CHECK(c.animations[0].notes[0] == "clip 'twice': 1 key has the time of the one before; the later one wins");
    CHECK(c.animations[1].notes.empty()); // others are none of its business
    CHECK(sample(c, c.animations[1], 2).frame_count() == 5);
    CHECK_THROWS_WITH(sample(c, c.animations[2], 2),
                      Catch::Contains("clip 'back', animations[2].channels[0] (translation of nodes[1] 'moving'): key "
                                      "times do not ascend, key 2"));

    std::mt19937 random(
        3); // at the ends, in threes, in steps and splines: the value at a key's time is that of the last key there
    for (int i = 0; i < 200; ++i) {
        Document many = triangle();
        std::vector<float> times, values;
        for (std::size_t k = 0; k < 1 + random() % 6; ++k) {
            times.push_back(times.empty() ? 0 : times.back() + static_cast<float>(random() % 2));
            const bool cubic = i % 3 == 2;
            for (int part = 0; part < (cubic ? 3 : 1); ++part)
                values.insert(values.end(), {part == 1 || !cubic ? static_cast<float>(k) : 0.0f, 0, 0});
        }
        many.animate("a", "translation", i % 3 == 0 ? "LINEAR" : i % 3 == 1 ? "STEP" : "CUBICSPLINE", times, values, 3);
        const Character m = many.parse();
        const Clip clip = sample(m, m.animations[0], 1);
        for (std::size_t f = 0; f < clip.frame_count(); ++f) {
            const auto last =
                std::upper_bound(times.begin(), times.end(), static_cast<float>(clip.time_s(f))) - times.begin() - 1;
            CHECK(clip.frame(f)[1].m[0][3] == Approx(static_cast<double>(last)));
        }
    }
}

TEST_CASE("faults of a clip matter where it is wanted")
{
    Document d = triangle();
    d.animate("good", "translation", "LINEAR", {0, 1}, {0, 1, 0, 4, 1, 0}, 3);
    d.animate("bad", "translation", "LINEAR", {0, 1}, {0, 1, 0, 4, 1, 0}, 3);
    for (const auto& [what, reason] :
         {std::pair<std::function<void(json&)>, const char*>(
              [](json& a) { a["samplers"][0]["interpolation"] = "BEZIER"; }, "unknown interpolation 'BEZIER'"),
          {[](json& a) { a["samplers"][0]["input"] = 99; }, "accessors[99] does not exist"},
          {[](json& a) { a["channels"][0]["sampler"] = 3; },
           "animations[1].samplers has 1 elements, not one of index 3"},
          {[](json& a) { a.erase("samplers"); }, "animations[1] 'bad' has no 'samplers'"},
          {[](json& a) { a["channels"] = 1; }, "animations[1].channels is number, expected an array"},
          {[](json& a) { a["channels"][0].erase("target"); }, "has no 'target'"},
          {[](json& a) { a["channels"].push_back(a["channels"][0]); }, "is animated twice"}}) {
        INFO(reason);
        Document broken = d;
        what(broken.root["animations"][1]);
        const Character c = broken.parse();
        CHECK(sample(c, c.animations.at(0), 1).frame_count() == 2);
        CHECK_THROWS_WITH(sample(c, c.animations.at(1), 1),
                          Catch::StartsWith("document.gltf: ") && Catch::Contains(reason));
    }
}

TEST_CASE("what is wrong with a file is said in one line, whole, with its place")
{
    for (const auto& [text, reason] :
         {std::pair(std::string("{"), "is not valid JSON: parse error at line 1, column 2"),
          {"[]", "its JSON is no object"},
          {"{\"asset\":{\"version\":\"2.0\"},\"skins\":[{\"joints\":[1e999]}]}", "is not valid JSON: number overflow"},
          {"{}", "has no asset.version"},
          {"{\"asset\":{\"version\":\"1.0\"}}", "needs glTF 1.0; 2.0 is supported"},
          {"{\"asset\":{\"version\":\"2.0\",\"minVersion\":\"2.1\"}}", "needs glTF 2.1; 2.0 is supported"},
          {"{\"asset\":{\"version\":\"2.0\"},\"skins\":[{}]}", "draws no mesh that a skin deforms"},
          {"{\"asset\":{\"version\":\"2.0\"},\"skins\":{}}", "skins is object, expected an array"},
          {"{\"asset\":{\"version\":\"2.0\"},\"skins\":[{}],\"meshes\":[{}],\"nodes\":[{\"mesh\":0,\"skin\":0}]}",
           "skins[0] has no 'joints'"},
          {"{\"asset\":{\"version\":\"2.0\"},\"skins\":[{}],\"nodes\":[{\"mesh\":-1,\"skin\":0.5}]}",
           "nodes[0].skin is 0.5, expected an integer from 0"},
          {std::string("glTF\2\0\0\0\14\0\0\0", 12), "ends within its header"},
          {std::string("glTF\1\0\0\0\24\0\0\0\0\0\0\0JSON", 20), "is version 1 of binary glTF"},
          {std::string("glTF\2\0\0\0\377\0\0\0\0\0\0\0JSON", 20), "is cut off: it declares 255 bytes and has 20"},
          {std::string("glTF\2\0\0\0\24\0\0\0\1\0\0\0JSON", 20), "has a chunk of 1 bytes at byte 12; 0 are left"}}) {
        INFO(text);
        CHECK_THAT(refusal(text, "f.gltf"), Catch::StartsWith("f.gltf: ") && Catch::Contains(reason));
    }
    // Cut anywhere, and with any byte changed: one line, and more than the file's name.
    Document d = triangle();
    d.animate("a", "translation", "LINEAR", {0, 1}, {0, 1, 0, 4, 1, 0}, 3);
    const std::string text = d.text();
    std::mt19937 random(4);
    for (std::size_t i = 0; i < share_of(4000); ++i) {
        std::string damaged = text;
        if (i % 2)
            damaged.resize(random() % text.size());
        else
            damaged[random() % text.size()] = static_cast<char>(random());
        const std::string message = refusal(damaged, "f.gltf");
        INFO(message);
        CHECK(message.find_first_of("\n\r\t") == std::string::npos);
        if (!message.empty())
            CHECK((message.starts_with("f.gltf: ") && message.size() > 20));
        else
            CHECK(i % 2 == 0); // what is cut is never whole
    }
}
