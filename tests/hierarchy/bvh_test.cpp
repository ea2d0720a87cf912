// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include <catch2/catch.hpp>

#include "cinch/bvh.hpp"
#include "tests/support.hpp"
#include "toolkit/surface/shapes.hpp"

using namespace cinch;

namespace {

DeformableSurface rigid(TriangleMesh mesh)
{
    DeformableSurface surface{std::move(mesh), {}};
    surface.weights.node_count = 1;
    for (std::size_t k = 0; k < surface.mesh.vertices.size(); ++k) {
        surface.weights.node.push_back(0);
        surface.weights.weight.push_back(1);
        surface.weights.row.push_back(static_cast<std::uint32_t>(k + 1));
    }
    return surface;
}

} // namespace

TEST_CASE("levels are contiguous, children follow parents, halves are balanced")
{
    const test::Example e = test::example(1000, 30);
    for (std::size_t leaf : {1u, 4u, 16u}) {
        const Bvh bvh = build_bvh(e.surface, leaf);
        REQUIRE(bvh.level.front() == 0);
        REQUIRE(bvh.level.back() == bvh.bvs.size());
        const double triangles = static_cast<double>(e.surface.mesh.triangles.size());
        CHECK(bvh.level.size() - 1 <=
              static_cast<std::size_t>(std::ceil(std::log2(triangles / static_cast<double>(leaf)))) + 1);
        for (std::size_t level = 0; level + 1 < bvh.level.size(); ++level)
            for (std::size_t i = bvh.level[level]; i < bvh.level[level + 1]; ++i) {
                const Bv& bv = bvh.bvs[i];
                CHECK(bv.is_leaf() == (bv.triangle_count <= leaf));
                if (bv.is_leaf())
                    continue;
                CHECK(bv.first_child >= bvh.level[level + 1]);
                CHECK(bv.first_child + 1 < bvh.level[level + 2]);
                const auto left = bvh.bvs[bv.first_child].triangle_count,
                           right = bvh.bvs[bv.first_child + 1].triangle_count;
                CHECK(left + right == bv.triangle_count);
                CHECK((right == left || right == left + 1));
            }
    }
}

TEST_CASE("the split separates along the longest direction")
{
    TriangleMesh strip;
    for (std::uint32_t i = 0; i < 8; ++i) {
        const double x = i * 7 % 8; // shuffled
        strip.vertices.insert(strip.vertices.end(), {{x, 0, 0}, {x + 0.1, 0, 0}, {x, 0.1, 0}});
        strip.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    const Bvh bvh = build_bvh(rigid(strip), 4);
    REQUIRE(bvh.bvs.size() == 3);
    for (std::size_t child : {1u, 2u})
        for (std::uint32_t t = 0; t < 4; ++t) {
            const bool right = strip.vertices[3 * bvh.triangle[bvh.bvs[child].first_triangle + t]].x() >= 4;
            const bool first_right = strip.vertices[3 * bvh.triangle[bvh.bvs[child].first_triangle]].x() >= 4;
            CHECK(right == first_right);
        }
}

TEST_CASE("hard meshes: one triangle, none, all alike, flat, huge, tiny")
{
    const TriangleMesh one{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
    CHECK(build_bvh(rigid(one), 1).bvs.size() == 1);
    CHECK(build_bvh(rigid({}), 1).bvs.empty());
    CHECK_THROWS(build_bvh(rigid(one), 0));

    TriangleMesh alike = one;
    alike.triangles.assign(1000, {0, 1, 2});
    const Bvh bvh = build_bvh(rigid(alike), 1);
    CHECK(bvh.level.size() - 1 == 11); // 2¹⁰ ≥ 1000 leaves
    for (double scale : {1e-300, 1e300, 0.0}) {
        TriangleMesh scaled = ring_sphere(100);
        for (Vec3& v : scaled.vertices)
            v = scale * v;
        const Bvh tree = build_bvh(rigid(scaled), 1);
        CHECK(tree.level.size() - 1 == 9);
        for (const Bv& bv : tree.bvs)
            CHECK((std::isfinite(bv.box.centre.sum()) && std::isfinite(bv.box.half.sum())));
    }
    TriangleMesh flat{{{0, 0, 7}, {1, 0, 7}, {0, 1, 7}}, {{0, 1, 2}}};
    CHECK(build_bvh(rigid(flat), 1).bvs[0].box.half.z() == 0);
}

TEST_CASE("intervals are the extremes over the vertices, 0 where a vertex is not influenced")
{
    TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {{0, 1, 2}, {1, 3, 2}}};
    DeformableSurface surface{mesh, {}};
    surface.weights.node_count = 3;
    surface.weights.row = {0, 2, 4, 6, 7};
    surface.weights.node = {0, 1, 0, 1, 0, 1, 2};
    surface.weights.weight = {0.25, 0.75, 0.5, 0.5, 0.125, 0.875, 1};
    const Bvh bvh = build_bvh(surface, 2);
    const RestBv root = bvh.rest(0);
    CHECK(std::vector<std::uint32_t>(root.node.begin(), root.node.end()) == std::vector<std::uint32_t>{0, 1, 2});
    CHECK(std::vector<double>(root.space.l.begin(), root.space.l.end()) == std::vector<double>{0, 0, 0});
    CHECK(std::vector<double>(root.space.h.begin(), root.space.h.end()) == std::vector<double>{0.5, 0.875, 1});
    CHECK(root.vertex_influences == 2);
    const Bvh fine = build_bvh(surface, 1);
    const Bv& leaf = fine.bvs[fine.triangle[fine.bvs[1].first_triangle] == 0 ? 1 : 2];
    CHECK(leaf.influence_count == 2);
    CHECK(fine.l[leaf.first_influence] == 0.125);
    CHECK(fine.h[leaf.first_influence + 1] == 0.875);
}

TEST_CASE("a node that influences one child wholly and the other not at all has l = 0 above them")
{
    // Siblings that share no vertex, as in meshes of several pieces.
    DeformableSurface surface{
        {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {9, 0, 0}, {10, 0, 0}, {9, 1, 0}}, {{0, 1, 2}, {3, 4, 5}}}, {}};
    surface.weights.node_count = 2;
    surface.weights.row = {0, 1, 2, 3, 4, 5, 6};
    surface.weights.node = {0, 0, 0, 1, 1, 1};
    surface.weights.weight = {1, 1, 1, 1, 1, 1};
    const Bvh bvh = build_bvh(surface, 1);
    const RestBv root = bvh.rest(0);
    CHECK(std::vector<double>(root.space.l.begin(), root.space.l.end()) == std::vector<double>{0, 0});
    CHECK(std::vector<double>(root.space.h.begin(), root.space.h.end()) == std::vector<double>{1, 1});
}
