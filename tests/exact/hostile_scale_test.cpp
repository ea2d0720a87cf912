// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces and transforms at the ends of the number range, where norms vanish and products overflow.
#include <cmath>

#include <catch2/catch.hpp>

#include "cinch/refit.hpp"
#include "exact/verifier.hpp"
#include "toolkit/bounds/rounding.hpp"

using namespace cinch;

namespace {

// One BV over these vertices; the weights of vertex k are those of row k, over all nodes.
DeformableSurface surface_of(const std::vector<Vec3>& vertices, const std::vector<std::vector<double>>& weights)
{
    DeformableSurface surface;
    surface.mesh.vertices = vertices;
    Influences influences;
    influences.node_count = static_cast<std::uint32_t>(weights[0].size());
    influences.row = {0};
    for (std::uint32_t k = 0; k < vertices.size(); ++k) {
        surface.mesh.triangles.push_back({k, k, k});
        for (std::uint32_t j = 0; j < weights[k].size(); ++j)
            if (weights[k][j] > 0) {
                influences.node.push_back(j);
                influences.weight.push_back(weights[k][j]);
            }
        influences.row.push_back(static_cast<std::uint32_t>(influences.node.size()));
    }
    surface.weights = to_dyadic(influences);
    return surface;
}

// All methods, in both precisions; returns how many supports are infinite.
std::size_t prove(const DeformableSurface& surface, const std::vector<AffineMap>& maps)
{
    const Bvh bvh = build_bvh(surface, 100000);
    const exact::Verifier verifier(surface, bvh);
    std::size_t unbounded = 0;
    for (int k : {6, 26})
        for (Precision precision : {Precision::float32, Precision::float64})
            for (Method method : all_methods.without(Method::vertices)) {
                std::vector<double> s(bvh.bvs.size() * static_cast<std::size_t>(k));
                refit(bvh, surface, maps, {method, k, Rounding::proven, precision, 2}, s);
                const auto verdict = verifier.check(maps, method, k, s);
                INFO(name_of(method) << " in " << name_of(precision) << ", k " << k);
                CHECK(verdict.examples.empty());
                unbounded += static_cast<std::size_t>(std::count(s.begin(), s.end(), infinite));
            }
    return unbounded;
}

AffineMap turned(double scale)
{
    const double c = std::cos(0.7), s = std::sin(0.7);
    return {{{scale * c, -scale * s, 0, 0},
             {scale * s * c, scale * c * c, -scale * s, 0},
             {scale * s * s, scale * c * s, scale * c, 0}}};
}

std::vector<Vec3> ball(std::size_t count, double radius)
{
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < count; ++i) { // a spiral of points all over the sphere
        const double z = 1 - (2 * static_cast<double>(i) + 1) / static_cast<double>(count), r = std::sqrt(1 - z * z),
                     phi = 2.399963 * static_cast<double>(i);
        points.emplace_back(radius * r * std::cos(phi), radius * r * std::sin(phi), radius * z);
    }
    return points;
}

std::vector<std::vector<double>> thirds(std::size_t count)
{
    std::vector<std::vector<double>> weights;
    for (std::size_t k = 0; k < count; ++k)
        weights.push_back({0.2 + 0.1 * static_cast<double>(k % 3), 0.3, 0.5 - 0.1 * static_cast<double>(k % 3)});
    return weights;
}

} // namespace

TEST_CASE("a component too large for the arithmetic is not hidden by a flat surface")
{
    std::vector<Vec3> flat;
    std::vector<std::vector<double>> weights;
    for (int i = 0; i < 8; ++i) {
        flat.emplace_back(-1 + i / 3.5, i % 3 - 1.0, 0);
        weights.push_back(i % 2 ? std::vector<double>{1, 0} : std::vector<double>{0, 1});
    }
    std::vector<AffineMap> maps{identity_map, identity_map};
    maps[1].m[0][3] = 100;
    for (double large : {1e25, 1e40, -1.7e308}) {
        maps[1].m[0][2] = large;
        prove(surface_of(flat, weights), maps);
    }
}

TEST_CASE("rest data too large for float are not hidden by a map that drops them")
{
    std::vector<AffineMap> maps{identity_map, identity_map};
    for (AffineMap& map : maps)
        map.m[1][1] = 0;
    maps[1].m[0][3] = 1000;
    prove(surface_of({{-1, 0, -1}, {1, 0, 1}, {0.5, 1e39, 0}, {-0.5, -1e39, 0}}, {{1, 0}, {1, 0}, {0, 1}, {0, 1}}),
          maps);
}

TEST_CASE("norms do not vanish with the transforms or the surface")
{
    for (double scale : {1.0, 1e-23, 1e-40, 1e-165, 1e-300})
        CHECK(prove(surface_of(ball(200, 1), thirds(200)), {turned(scale), turned(scale), turned(scale)}) == 0);
    CHECK(prove(surface_of(ball(100, 1e-30), thirds(100)), {turned(1), turned(1), turned(1)}) == 0);
    for (double radius : {1e-70, 1e-170, 1e-300}) // nothing in float, where the gradients of the weights overflow
        prove(surface_of(ball(100, radius), thirds(100)), {turned(1), turned(1), turned(1)});
    AffineMap large = turned(1e100);
    prove(surface_of(ball(100, 1e-70), thirds(100)), {large, large, large});
    const double least = 0x1p-1074;
    AffineMap stretch = identity_map;
    stretch.m[0][0] = 1e300;
    AffineMap back = stretch;
    back.m[0][0] = -1e300;
    prove(surface_of({{4 * least, 0, 0}, {-4 * least, 0, 0}}, {{0.6, 0.4}, {0.4, 0.6}}), {stretch, back});
}

TEST_CASE("many nodes whose parts all underflow")
{
    constexpr std::size_t n = 4096;
    std::vector<std::vector<double>> weights(2, std::vector<double>(n));
    std::vector<AffineMap> maps(n, AffineMap{});
    for (std::size_t j = 0; j < n; ++j) {
        const double sign = j % 2 ? 1 : -1;
        weights[0][j] = (1 + sign / 128) / n;
        weights[1][j] = (1 - sign / 128) / n;
        for (auto& row : maps[j].m)
            for (double& x : row)
                x = 0;
        maps[j].m[0][3] = sign * 2.88e-39;
    }
    CHECK(prove(surface_of({{0, 0, 0}, {0, 0, 0}}, weights), maps) == 0);
}

TEST_CASE("flat surfaces in any plane have finite bounds")
{
    for (double z : {0.0, 8.0, 8.1, 1e6}) {
        std::vector<Vec3> flat;
        std::vector<std::vector<double>> weights;
        for (int i = 0; i < 121; ++i) {
            const double x = -1 + i % 11 / 5.0, y = -1 + i / 11 / 5.0;
            flat.emplace_back(x, y, z);
            weights.push_back({(1 + x) * (1 + y) / 4 + 1e-3, (1 - x) * (1 + y) / 4 + 1e-3, (1 + x) * (1 - y) / 4 + 1e-3,
                               (1 - x) * (1 - y) / 4 + 1e-3});
        }
        std::vector<AffineMap> maps(4, identity_map);
        for (std::size_t j = 0; j < 4; ++j)
            maps[j].m[j % 3][3] = 0.1 * static_cast<double>(j);
        INFO(z);
        CHECK(prove(surface_of(flat, weights), maps) == 0);
    }
}
