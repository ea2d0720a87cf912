// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <bit>
#include <numeric>
#include <set>

#include <catch2/catch.hpp>

#include "tests/collide/random_bodies.hpp"
#include "toolkit/hierarchy/cluster.hpp"
#include "toolkit/hierarchy/leaf_set.hpp"

using namespace cinch;
using namespace cinch::test;

namespace {

constexpr std::size_t limits[] = {1, 4, 8, 16};

std::vector<std::uint32_t> as_they_stand(const TriangleMesh& mesh)
{
    std::vector<std::uint32_t> order(mesh.triangles.size());
    std::iota(order.begin(), order.end(), 0u);
    return order;
}

void check_clusters(const TriangleMesh& mesh, const Clusters& clusters, ClusterSize most)
{
    std::vector<std::uint32_t> all = clusters.triangle;
    std::sort(all.begin(), all.end());
    REQUIRE((all == as_they_stand(mesh)));
    REQUIRE(clusters.first.front() == 0);
    REQUIRE(clusters.first.back() == clusters.triangle.size());
    for (std::size_t c = 0; c < clusters.count(); ++c) {
        REQUIRE(clusters.first[c] < clusters.first[c + 1]);
        std::set<std::uint32_t> vertices;
        for (std::uint32_t i = clusters.first[c]; i < clusters.first[c + 1]; ++i)
            vertices.insert(mesh.triangles[clusters.triangle[i]].begin(), mesh.triangles[clusters.triangle[i]].end());
        REQUIRE(clusters.first[c + 1] - clusters.first[c] <= most.triangles);
        REQUIRE(vertices.size() <= most.vertices);
    }
}

// For every pair of limits; then the tree's leaves and what is packed of them.
void check_mesh(const TriangleMesh& mesh)
{
    const DeformableSurface surface = rigid(mesh);
    std::vector<std::uint32_t> backwards = as_they_stand(mesh);
    std::reverse(backwards.begin(), backwards.end());
    for (const std::size_t triangles : limits)
        for (const std::size_t vertices : {3u, 4u, 8u, 16u}) {
            const ClusterSize most{triangles, vertices};
            INFO(triangles << " triangles, " << vertices << " vertices");
            const Clusters clusters = cluster_triangles(mesh, as_they_stand(mesh), most);
            check_clusters(mesh, clusters, most);
            const Clusters again = cluster_triangles(mesh, as_they_stand(mesh), most);
            REQUIRE((clusters.triangle == again.triangle && clusters.first == again.first));
            check_clusters(mesh, cluster_triangles(mesh, backwards, most), most);
            if (triangles != vertices && !(triangles == 1 && vertices == 3))
                continue;
            const Bvh bvh = build_bvh(surface, most, RestDetail::boxes);
            Clusters leaves;
            std::vector<std::uint32_t> begin;
            for (const Bv& bv : bvh.bvs)
                if (bv.is_leaf())
                    begin.push_back(bv.first_triangle);
            std::sort(begin.begin(), begin.end());
            leaves.triangle = bvh.triangle;
            leaves.first = begin;
            leaves.first.push_back(static_cast<std::uint32_t>(bvh.triangle.size()));
            if (begin.empty())
                leaves.first = {0};
            check_clusters(mesh, leaves, most);
            const std::size_t lanes = std::bit_ceil(std::max<std::size_t>({4, most.triangles, most.vertices}));
            REQUIRE(pack_leaves(bvh, surface, Vec3::Zero(), lanes).leaves.size() == leaves.count());
        }
    CHECK_THROWS_AS(build_bvh(surface, ClusterSize{0, 16}), std::invalid_argument);
    CHECK_THROWS_AS(build_bvh(surface, ClusterSize{16, 2}), std::invalid_argument);
}

TriangleMesh fan(std::uint32_t triangles)
{
    TriangleMesh mesh;
    mesh.vertices.emplace_back(0, 0, 0);
    for (std::uint32_t i = 0; i < triangles; ++i) {
        const double angle = 6.283185307179586 * i / triangles;
        mesh.vertices.emplace_back(std::cos(angle), std::sin(angle), 0.1);
        mesh.triangles.push_back({0, 1 + i, 1 + (i + 1) % triangles});
    }
    return mesh;
}

} // namespace

TEST_CASE("clusters keep to their limits, and every triangle is in one: closed, open and sharp surfaces")
{
    check_mesh(brain(800));
    check_mesh(box({1, 2, 3}, {3, 5, 7}));
    check_mesh(box({1, 1, 0}, {17, 1, 0}));
    check_mesh(chessboard(12));
}

TEST_CASE("clusters keep to their limits where a vertex has ten thousand triangles, in time that is not quadratic")
{
    check_mesh(fan(10000));
    // A hundred times that would take hours if it were.
    const TriangleMesh huge = fan(1000000);
    check_clusters(huge, cluster_triangles(huge, as_they_stand(huge), {16, 16}), {16, 16});
    // Most clusters are full: 14 triangles of a fan have 16 vertices.
    CHECK(cluster_triangles(huge, as_they_stand(huge), {16, 16}).count() < 1000000 / 12);
}

TEST_CASE("clusters keep to their limits without shared vertices, with repeated corners, in one place, and of nothing")
{
    Dice dice(31);
    for (const double size : {1e-9, 0.1, 10.0})
        check_mesh(soup(dice, 700, size));
    TriangleMesh alike; // all centroids are one point, no vertex is shared
    for (std::uint32_t i = 0; i < 500; ++i) {
        const Vec3 p = dice.point(), q = dice.point();
        alike.vertices.insert(alike.vertices.end(), {p, q, -p - q});
        alike.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    check_mesh(alike);
    TriangleMesh again{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {}};
    for (std::uint32_t i = 0; i < 1000; ++i)
        again.triangles.push_back(
            {i % 3, (i / 3) % 4, (i / 7) % 4}); // the same few over and over, many of them segments and points
    check_mesh(again);
    TriangleMesh point{{{3, 3, 3}}, {}};
    point.triangles.assign(100, {0, 0, 0});
    check_mesh(point);
    check_mesh({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}});
    check_mesh({});
    check_mesh({{{0, 0, 0}, {1, 0, 0}}, {}});
    for (const double scale : {1e-300, 1e300, 0.0}) {
        TriangleMesh scaled = ring_sphere(200);
        for (Vec3& v : scaled.vertices)
            v *= scale;
        check_mesh(scaled);
    }
}

TEST_CASE("clusters of a closed surface are few: the triangles of most are as many as fit")
{
    const TriangleMesh mesh = brain(5000);
    const DeformableSurface surface = rigid(mesh);
    const Bvh bvh = build_bvh(surface, ClusterSize{16, 16}, RestDetail::boxes);
    const auto leaves = static_cast<std::size_t>(
        std::count_if(bvh.bvs.begin(), bvh.bvs.end(), [](const Bv& bv) { return bv.is_leaf(); }));
    CHECK(mesh.triangles.size() > 13 * leaves);
    CHECK(build_bvh(surface, ClusterSize{1, 3}, RestDetail::boxes).bvs.size() == 2 * mesh.triangles.size() - 1);
}
