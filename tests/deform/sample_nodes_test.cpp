// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include <catch2/catch.hpp>

#include "toolkit/deform/sample_nodes.hpp"
#include "toolkit/surface/shapes.hpp"

using namespace cinch;

TEST_CASE("nodes are farthest-point samples inside the volume, repeatable, and cover it")
{
    const TriangleMesh sphere = ring_sphere(2000);
    const SimulationNodes nodes = sample_nodes(sphere, 100, 0), again = sample_nodes(sphere, 100, 0),
                          other = sample_nodes(sphere, 100, 1);
    REQUIRE(nodes.position.size() == 100);
    CHECK(nodes.position == again.position);
    CHECK(nodes.position != other.position);
    double closest = 2;
    std::size_t inner = 0;
    for (std::size_t i = 0; i < 100; ++i) {
        CHECK(nodes.position[i].norm() <= 1 + 1e-12);
        inner += nodes.position[i].norm() < 0.7;
        for (std::size_t j = 0; j < i; ++j)
            closest = std::min(closest, (nodes.position[i] - nodes.position[j]).norm());
    }
    CHECK(inner >= 10);                    // the volume, not only the surface
    CHECK(closest >= nodes.fill_distance); // greedy: every node was at least as far from the others as any point is now
    for (const Vec3& v : sphere.vertices) {
        double nearest = 2;
        for (const Vec3& p : nodes.position)
            nearest = std::min(nearest, (p - v).norm());
        REQUIRE(nearest <= nodes.fill_distance);
    }
}

TEST_CASE("kernel weights: every vertex is reached, weights fall with distance")
{
    const TriangleMesh sphere = ring_sphere(2000);
    const SimulationNodes nodes = sample_nodes(sphere, 100, 0);
    std::size_t alone = 7;
    const Weights weights = kernel_weights(sphere, nodes, 2, &alone);
    CHECK(alone == 0);
    const double per_vertex = static_cast<double>(weights.node.size()) / 2000;
    CHECK(per_vertex > 6);
    CHECK(per_vertex < 20);
    for (std::size_t k = 0; k < 2000; ++k) {
        const auto row = weights.of(k);
        for (std::size_t i = 0; i < row.node.size(); ++i)
            for (std::size_t j = 0; j < i; ++j)
                if ((nodes.position[row.node[i]] - sphere.vertices[k]).norm() <
                    (nodes.position[row.node[j]] - sphere.vertices[k]).norm())
                    REQUIRE(row.weight[i] >= row.weight[j]);
    }
    const Weights lonely = kernel_weights(sphere, nodes, 0.01, &alone);
    CHECK(alone > 1900);
    CHECK(lonely.weight.size() >= 2000);
}

TEST_CASE("meshes whose squared distances overflow still get distinct points of theirs")
{
    TriangleMesh huge = ring_sphere(60);
    for (Vec3& v : huge.vertices)
        v *= 1e200;
    const SimulationNodes nodes = sample_nodes(huge, 8, 0);
    REQUIRE(nodes.position.size() == 8);
    for (std::size_t i = 0; i < 8; ++i) {
        CHECK(std::find(huge.vertices.begin(), huge.vertices.end(), nodes.position[i]) != huge.vertices.end());
        CHECK(std::find(nodes.position.begin(), nodes.position.begin() + static_cast<std::ptrdiff_t>(i),
                        nodes.position[i]) == nodes.position.begin() + static_cast<std::ptrdiff_t>(i));
    }
}

TEST_CASE("flat, tiny and degenerate meshes still get nodes")
{
    const TriangleMesh flat{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {{0, 1, 2}, {2, 1, 3}}};
    CHECK(sample_nodes(flat, 10, 0).position.size() == 4); // no more distinct places
    const TriangleMesh point{{{1, 2, 3}, {1, 2, 3}}, {{0, 1, 0}}};
    const SimulationNodes one = sample_nodes(point, 5, 0);
    REQUIRE(one.position.size() == 1);
    CHECK(one.fill_distance == 0);
    CHECK(kernel_weights(point, one, 2).weight == std::vector<double>{1, 1});
    CHECK_THROWS(sample_nodes(TriangleMesh{}, 5, 0));
}
