// SPDX-License-Identifier: GPL-3.0-or-later
#include <fstream>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/support.hpp"
#include "toolkit/surface/character.hpp"
#include "toolkit/surface/read_mesh.hpp"

using namespace cinch;

TEST_CASE("every reference mesh loads with the counts of its manifest")
{
    const auto folder = test::shared("meshes");
    if (!folder)
        return;
    std::ifstream in(*folder / "manifest.json");
    const auto manifest = nlohmann::json::parse(in);
    std::size_t checked = 0;
    for (const auto& entry : manifest) {
        const std::string name = entry["file"];
        INFO(name);
        const auto path = *folder / name;
        const TriangleMesh mesh = path.extension() == ".glb" ? read_gltf(path).mesh : read_mesh(path).mesh;
        CHECK(mesh.vertices.size() == entry["vertices"]);
        CHECK(mesh.triangles.size() == entry["triangles"]);
        ++checked;
    }
    CHECK(checked >= 23);
}
