// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>

#include <catch2/catch.hpp>

#include "experiments/baselines/spatial_hash.hpp"
#include "tests/collide/random_bodies.hpp"

using namespace cinch;
using namespace cinch::test;

namespace {

// All pairs of triangles of two bodies by the exact predicate alone, which takes what is not finite to meet everything.
Pairs every_pair(const std::vector<TriangleMesh>& meshes)
{
    Pairs all;
    auto points = [&](std::size_t b, std::uint32_t t) {
        const Triangle& c = meshes[b].triangles[t];
        return TrianglePoints{meshes[b].vertices[c[0]], meshes[b].vertices[c[1]], meshes[b].vertices[c[2]]};
    };
    for (std::uint32_t a = 0; a < meshes.size(); ++a)
        for (std::uint32_t b = a + 1; b < meshes.size(); ++b)
            for (std::uint32_t i = 0; i < meshes[a].triangles.size(); ++i)
                for (std::uint32_t j = 0; j < meshes[b].triangles.size(); ++j)
                    if (intersect(points(a, i), points(b, j)))
                        all.push_back({a, i, b, j});
    return sorted(all);
}

// Returns how many there are.
std::size_t check(SpatialHash& hash, const std::vector<TriangleMesh>& meshes)
{
    std::vector<SpatialHash::Body> bodies;
    for (const TriangleMesh& mesh : meshes)
        bodies.push_back({&mesh, mesh.vertices});
    hash.load(bodies);
    Pairs found;
    hash.find(found);
    found = sorted(found);
    const Pairs truth = every_pair(meshes);
    INFO(difference(truth, found));
    CHECK((found == truth));
    return truth.size();
}

TriangleMesh moved(TriangleMesh mesh, const Eigen::Matrix3d& a, const Vec3& t)
{
    for (Vec3& v : mesh.vertices)
        v = a * v + t;
    return mesh;
}

} // namespace

TEST_CASE("spatial hashing finds the pairs of brute force: bodies, crowds, soups of all sizes")
{
    Dice dice(81);
    SpatialHash hash; // the same for all: nothing of before is left
    std::size_t pairs = 0;
    for (int round = 0; round < 12; ++round) {
        std::vector<TriangleMesh> meshes;
        for (std::size_t b = 0; b < 2 + dice.below(4); ++b)
            meshes.push_back(moved(dice.below(2) ? brain(60) : soup(dice, 120, std::exp2(-6 + 8 * dice.unit())),
                                   dice.rotation(), 0.5 * dice.point()));
        if (round % 3 == 0)
            meshes.push_back({});
        pairs += check(hash, meshes);
    }
    CHECK(pairs > 2000);
}

TEST_CASE("spatial hashing: giants among dwarfs, far away, tiny and huge, on the borders of cells")
{
    Dice dice(82);
    SpatialHash hash;
    std::size_t pairs = 0;
    for (const double scale : {1e-310, 1e-150, 1e-9, 1e9, 1e150, 1e300})
        for (const double far : {0.0, 1e5, 1e15}) {
            const Vec3 away = far < 1e10 || scale < 1e200 ? Vec3(scale * far * Vec3(1, -0.5, 0.25)) : Vec3(0, 0, 0);
            std::vector<TriangleMesh> meshes{brain(50), fish(50), soup(dice, 60, 3e-3)};
            meshes[2].vertices.insert(meshes[2].vertices.end(),
                                      {{-900, -800, 0.1}, {1000, -900, 0.2}, {10, 900, -0.1}});
            const auto n = static_cast<std::uint32_t>(meshes[2].vertices.size());
            meshes[2].triangles.push_back({n - 3, n - 2, n - 1});
            for (TriangleMesh& mesh : meshes)
                mesh = moved(mesh, scale * dice.rotation(), away);
            pairs += check(hash, meshes);
        }
    for (const Vec3& t : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(6, 6, 0), Vec3(0.5, 0.5, 0), Vec3(6 + 0x1p-50, 0, 0)})
        pairs += check(hash, {chessboard(6), moved(chessboard(6), Eigen::Matrix3d::Identity(), t),
                              moved(box({4, 4, 4}, {4, 4, 4}), Eigen::Matrix3d::Identity(), {2, 2, 2})});
    CHECK(pairs > 2000);
}

TEST_CASE("spatial hashing: what is not finite meets everything, whichever of its coordinates it is")
{
    SpatialHash hash;
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                             -std::numeric_limits<double>::infinity()})
        for (const std::size_t vertex : {0u, 1u, 2u, 17u, 29u})
            for (const int axis : {0, 1, 2}) {
                std::vector<TriangleMesh> meshes{ring_sphere(30),
                                                 moved(ring_sphere(20), Eigen::Matrix3d::Identity(), {1.5, 0.2, 0}),
                                                 moved(ring_sphere(20), Eigen::Matrix3d::Identity(), {0, 9, 0})};
                meshes[0].vertices[vertex][axis] = bad;
                meshes[2].vertices[vertex % 20][axis] = bad;
                CHECK(check(hash, meshes) > 100);
            }
    const TriangleMesh mesh = ring_sphere(20);
    const SpatialHash::Body too_few{&mesh, std::span(mesh.vertices).first(3)};
    CHECK_THROWS_AS(hash.load({&too_few, 1}), std::invalid_argument);
    Pairs none;
    CHECK_THROWS_AS(hash.find(none), std::logic_error); // not what is left of the last load
    CHECK_THROWS_AS(SpatialHash().find(none), std::logic_error);
    CHECK(none.empty());
}
