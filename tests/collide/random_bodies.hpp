// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <random>

#include <Eigen/Geometry>

#include "tests/collide/brute_force.hpp"
#include "toolkit/deform/sample_nodes.hpp"
#include "toolkit/surface/shapes.hpp"

namespace cinch::test {

using Maps = std::vector<AffineMap>; ///< one per simulation node

/// The same numbers everywhere.
struct Dice {
    std::mt19937_64 bits;

    explicit Dice(std::uint64_t seed) : bits(seed) {}
    double unit() { return std::ldexp(static_cast<double>(bits() >> 11), -53); }
    double symmetric() { return 2 * unit() - 1; }
    std::size_t below(std::size_t n) { return bits() % n; }
    Vec3 point() { return {symmetric(), symmetric(), symmetric()}; }
    Eigen::Matrix3d rotation()
    {
        const Vec3 axis = point() + Vec3(0, 0, 1e-3);
        return Eigen::AngleAxisd(3.2 * symmetric(), axis.normalized()).toRotationMatrix();
    }
    template <class T> const T& of(const std::vector<T>& all) { return all[below(all.size())]; }
};

inline AffineMap affine(const Eigen::Matrix3d& a, const Vec3& t)
{
    AffineMap map;
    for (int r = 0; r < 3; ++r) {
        for (int s = 0; s < 3; ++s)
            map.m[r][s] = a(r, s);
        map.m[r][3] = t[r];
    }
    return map;
}
inline AffineMap moved_by(const Vec3& t) { return affine(Eigen::Matrix3d::Identity(), t); }

/// Weights by the kernel around `nodes` sampled simulation nodes; of one node, 1.
inline DeformableSurface soft(TriangleMesh mesh, std::size_t nodes)
{
    DeformableSurface out{std::move(mesh), {}};
    out.weights = kernel_weights(out.mesh, sample_nodes(out.mesh, nodes, 0), 2);
    return out;
}
inline DeformableSurface rigid(TriangleMesh mesh)
{
    DeformableSurface out{std::move(mesh), {}};
    out.weights.node_count = 1;
    for (std::uint32_t k = 0; k < out.mesh.vertices.size(); ++k) {
        out.weights.node.push_back(0);
        out.weights.weight.push_back(1);
        out.weights.row.push_back(k + 1);
    }
    return out;
}
/// Every vertex by up to `most` random simulation nodes, near or not: nothing is smooth.
inline DeformableSurface patchy(Dice& dice, TriangleMesh mesh, std::uint32_t nodes, std::size_t most)
{
    DeformableSurface out{std::move(mesh), {}};
    Influences influences;
    influences.node_count = nodes;
    for (std::size_t k = 0; k < out.mesh.vertices.size(); ++k) {
        std::vector<std::uint32_t> some;
        for (std::size_t i = 1 + dice.below(most); i > 0; --i)
            some.push_back(static_cast<std::uint32_t>(dice.below(nodes)));
        std::sort(some.begin(), some.end());
        some.erase(std::unique(some.begin(), some.end()), some.end());
        for (const std::uint32_t j : some) {
            influences.node.push_back(j);
            influences.weight.push_back(std::exp2(-30 * dice.unit() * dice.unit())); // some hardly count
        }
        influences.row.push_back(static_cast<std::uint32_t>(influences.node.size()));
    }
    out.weights = to_dyadic(influences);
    return out;
}

/// A motion as a whole, and every simulation node `strength` off from it.
inline Maps around(Dice& dice, std::size_t nodes, const Eigen::Matrix3d& a, const Vec3& t, double strength)
{
    Maps maps;
    for (std::size_t j = 0; j < nodes; ++j) {
        Eigen::Matrix3d own = a;
        for (int r = 0; r < 3; ++r)
            for (int s = 0; s < 3; ++s)
                own(r, s) += strength * dice.symmetric();
        maps.push_back(affine(own, t + strength * dice.point()));
    }
    return maps;
}

/// Triangles without shared vertices, of `size` each, centred in a cube of half-edge 1; some of them degenerate.
inline TriangleMesh soup(Dice& dice, std::size_t triangles, double size)
{
    TriangleMesh mesh;
    for (std::uint32_t t = 0; t < triangles; ++t) {
        const Vec3 centre = dice.point();
        for (int c = 0; c < 3; ++c)
            mesh.vertices.push_back(centre + size * dice.point());
        mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
        switch (dice.below(8)) {
        case 0:
            mesh.vertices[3 * t + 1] = mesh.vertices[3 * t];
            break; // a segment
        case 1:
            mesh.vertices[3 * t + 2] = mesh.vertices[3 * t + 1] = mesh.vertices[3 * t];
            break; // a point
        case 2:
            mesh.triangles.back()[2] = 3 * t + 1;
            break; // by its indices
        case 3:
            mesh.vertices[3 * t + 2] = 0.5 * (mesh.vertices[3 * t] + mesh.vertices[3 * t + 1]);
            break;
        default:
            break;
        }
    }
    return mesh;
}

/// A square in the plane z = 0 of 2·cells² triangles on whole numbers.
inline TriangleMesh chessboard(std::uint32_t cells)
{
    TriangleMesh mesh;
    for (std::uint32_t y = 0; y <= cells; ++y)
        for (std::uint32_t x = 0; x <= cells; ++x)
            mesh.vertices.emplace_back(x, y, 0);
    for (std::uint32_t y = 0; y < cells; ++y)
        for (std::uint32_t x = 0; x < cells; ++x) {
            const std::uint32_t v = y * (cells + 1) + x;
            mesh.triangles.push_back({v, v + 1, v + cells + 1});
            mesh.triangles.push_back({v + 1, v + cells + 2, v + cells + 1});
        }
    return mesh;
}

} // namespace cinch::test
