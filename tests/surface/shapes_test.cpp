// SPDX-License-Identifier: GPL-3.0-or-later
#include <map>
#include <set>

#include <catch2/catch.hpp>

#include "tests/support.hpp"
#include "toolkit/surface/shapes.hpp"
#include "toolkit/surface/triangle_mesh.hpp"

using namespace cinch;

namespace {

// Every directed edge once and its reverse once: closed, oriented, manifold; V − E + F = 2 and one piece: genus 0.
void check_closed_genus_0(const TriangleMesh& mesh, std::size_t vertices)
{
    REQUIRE(mesh.vertices.size() == vertices);
    REQUIRE(mesh.triangles.size() == 2 * vertices - 4);
    std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
    std::vector<std::uint32_t> parent(vertices);
    for (std::uint32_t v = 0; v < vertices; ++v)
        parent[v] = v;
    auto root = [&](std::uint32_t v) {
        while (parent[v] != v)
            v = parent[v] = parent[parent[v]];
        return v;
    };
    bool once = true;
    for (const Triangle& t : mesh.triangles)
        for (std::size_t i = 0; i < 3; ++i) {
            once &= edges.emplace(t[i], t[(i + 1) % 3]).second;
            parent[root(t[i])] = root(t[(i + 1) % 3]);
        }
    CHECK(once);
    bool paired = true, connected = true;
    for (const auto& [a, b] : edges)
        paired &= edges.count({b, a}) == 1;
    CHECK(paired);
    for (std::uint32_t v = 0; v < vertices; ++v)
        connected &= root(v) == root(0);
    CHECK(connected);
    CHECK(vertices + mesh.triangles.size() == edges.size() / 2 + 2);
}

} // namespace

TEST_CASE("the shipped surfaces are closed, of genus 0, and have exactly the paper's sizes")
{
    const std::size_t sizes[] = {3500, 30000, 145000};
    for (const std::size_t vertices : test::share_of(sizes))
        check_closed_genus_0(brain(vertices), vertices);
    const TriangleMesh small = santa(2857);
    check_closed_genus_0(small, 2857);
    check_closed_genus_0(subdivide(subdivide(small)), 45682);
    check_closed_genus_0(fish(8000), 8000);
}

TEST_CASE("ring spheres have any number of vertices from 5")
{
    for (std::size_t vertices = 5; vertices < 200; ++vertices)
        check_closed_genus_0(ring_sphere(vertices), vertices);
    CHECK_THROWS(ring_sphere(4));
}

TEST_CASE("centre_and_scale puts the longest half-extent where asked, without overflow")
{
    TriangleMesh mesh{{{1e308, 0, 5}, {-1e308, 1, 5}}, {}};
    centre_and_scale(mesh, 1.2);
    CHECK(mesh.vertices[0].x() == 1.2);
    CHECK(mesh.vertices[1].x() == -1.2);
    CHECK(mesh.vertices[0].z() == 0);
    TriangleMesh point{{{3, 4, 5}}, {}};
    centre_and_scale(point, 1.2);
    CHECK(point.vertices[0] == Vec3(0, 0, 0));
}

TEST_CASE("boxes are closed and face outward, and a sheet is open")
{
    const TriangleMesh cuboid = box({2, 3, 4}, {2, 1, 3});
    CHECK(cuboid.vertices.size() == 3 * 2 * 4); // no lattice point lies inside
    CHECK(signed_volume(cuboid) == Approx(24));
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    for (const Triangle& t : cuboid.triangles)
        for (int c = 0; c < 3; ++c)
            ++edges[{t[c], t[(c + 1) % 3]}];
    for (const auto& [edge, times] : edges) {
        CHECK(times == 1);
        CHECK(edges.count({edge.second, edge.first}) == 1);
    }
    const TriangleMesh sheet = box({1, 2, 0}, {3, 2, 1});
    CHECK(sheet.vertices.size() == 12);
    CHECK(sheet.triangles.size() == 12);
    CHECK(signed_volume(sheet) == 0);
}

TEST_CASE("shapes have names")
{
    const std::vector<std::string> names = shape_names();
    for (const std::string& name : test::share_of(names))
        if (name != "brain-145000")
            CHECK(named_shape(name)->triangles.size() > 0);
    CHECK(named_shape("santa-2857")->vertices.size() == 2857);
    if (test::test_share() >= 1)
        CHECK(named_shape("santa-45682")->vertices.size() == 45682);
    CHECK_FALSE(named_shape("cube"));
}
