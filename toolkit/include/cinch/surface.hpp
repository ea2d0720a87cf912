// SPDX-License-Identifier: Apache-2.0
#pragma once

/// \file
/// What is deformed: a triangle mesh, and the weights by which simulation nodes move its vertices.

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "cinch/version.hpp"

namespace cinch {

using Vec3 = Eigen::Vector3d;                  ///< a point or a direction
using Triangle = std::array<std::uint32_t, 3>; ///< indices of its vertices

/// Vertices and triangles exactly as a file declares them: nothing is welded, dropped or reordered,
/// so duplicate and degenerate triangles and unreferenced vertices are legal.
struct TriangleMesh {
    std::vector<Vec3> vertices;      ///< finite coordinates, in the file's unit
    std::vector<Triangle> triangles; ///< indices into `vertices`
};

/// x ↦ A x + t, row-major: A is m[r][0..2], t is m[r][3]. Applied to column vectors.
struct AffineMap {
    double m[3][4]; ///< rows of (A | t)
};
/// x ↦ x.
inline constexpr AffineMap identity_map{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

/// A p + t, in doubles: ((a₀x + a₁y) + a₂z) + t.
inline Vec3 apply(const AffineMap& map, const Vec3& p)
{
    Vec3 image;
    for (int r = 0; r < 3; ++r)
        image[r] = ((map.m[r][0] * p[0] + map.m[r][1] * p[1]) + map.m[r][2] * p[2]) + map.m[r][3];
    return image;
}

/// Whether all 12 entries are numbers.
inline bool is_finite(const AffineMap& map)
{
    for (const auto& row : map.m)
        for (const double x : row)
            if (!std::isfinite(x))
                return false;
    return true;
}

/// Weights of every vertex as a file gives them: not normalised. Vertex k owns entries [row[k], row[k+1]).
struct Influences {
    std::uint32_t node_count = 0;         ///< simulation nodes (joints)
    std::vector<std::uint32_t> row = {0}; ///< vertices + 1 entries
    std::vector<std::uint32_t> node;      ///< ascending within a vertex, no node twice
    std::vector<double> weight;           ///< finite, ≥ 0
    double step = 0; ///< between neighbouring numbers where weights are stored as integers, 1/255 or 1/65535, the
                     ///< coarsest; 0: floating point
};

/// Convex weights of every vertex (Eq. 2). Vertex k owns entries [row[k], row[k+1]); they are > 0, multiples of 2^-53,
/// ascending in node, and sum to exactly 1.
struct Weights {
    std::uint32_t node_count = 0;         ///< simulation nodes
    std::vector<std::uint32_t> row = {0}; ///< vertices + 1 entries
    std::vector<std::uint32_t> node;      ///< simulation nodes, vertex by vertex
    std::vector<double> weight;           ///< parallel to `node`

    /// One vertex's. A view.
    struct Row {
        std::span<const std::uint32_t> node; ///< ascending
        std::span<const double> weight;      ///< parallel to `node`
    };
    /// vertex < vertex_count().
    Row of(std::size_t vertex) const
    {
        const std::size_t first = row[vertex], count = row[vertex + 1] - first;
        return {std::span(node).subspan(first, count), std::span(weight).subspan(first, count)};
    }
    /// How many vertices have weights.
    std::size_t vertex_count() const { return row.size() - 1; }
};

/// What normalising a file's weights changed. Dividing by their sum s changes every weight of a vertex by the share
/// |1/s − 1|.
struct WeightReport {
    std::size_t vertices = 0;   ///< all of them
    std::size_t normalised = 0; ///< vertices whose weights it changed by more than sum_rounding
    std::size_t beyond_steps =
        0; ///< of these, whose sum is off by more than storing weights as integers explains: half a step each
    double largest_change = 0; ///< share by which it changed the weights of these vertices at most
    std::size_t without_weight =
        0; ///< vertices whose weights were all 0: bound wholly to the first node they name; not among the others
    double least_sum = 1;    ///< of the weights of one vertex, over all with weights
    double greatest_sum = 1; ///< the same
};

/// How far from 1 the sum of n weights may be that a program normalised in binary32 and stored so, or printed: with u =
/// 2⁻²⁴, the sum that it divided by is off by n − 1 additions, (n − 1) u, each quotient by u more, and a printed or
/// stored one by another u, and the weights sum to 1: (n + 1) u to first order, and (n + 2) u with all higher ones for
/// n < 2²³. (Adding them up here errs by n 2⁻⁵³, less than what is left.)
constexpr double sum_rounding(std::size_t n) { return (static_cast<double>(n) + 2) * 0x1p-24; }

/// Normalises and rounds every vertex's weights to dyadic ones; weights that round to 0 are dropped.
Weights to_dyadic(const Influences& influences, WeightReport* report = nullptr);

/// A surface in rest state with the weights that deform it: weights.vertex_count() == mesh.vertices.size().
struct DeformableSurface {
    TriangleMesh mesh;          ///< at rest
    Weights weights;            ///< of each of its vertices
    std::vector<Vec3> layout{}; ///< where its vertices stand when triangles are grouped, for parts with rest spaces of
                                ///< their own; empty: at rest. No bound depends on it, only how tight they are
    std::vector<Vec3> place{};  ///< of every simulation node at rest; empty where they have none, as joints. As above
};

/// Displacements d_i of some rest vertices. With weights a, a surface's vertices at rest are v⁰ + Σ_i a_i d_i, before
/// its simulation nodes move them.
struct MorphTarget {
    std::vector<std::uint32_t> vertex; ///< ascending; all others stay
    std::vector<Vec3> displacement;    ///< parallel to `vertex`; finite
    std::vector<Vec3> half; ///< parallel too: anywhere within so much of it along each coordinate; empty: exactly there
};

/// Bad input. what() is one line: file, place and reason, ready to print.
class InputError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;

    /// "file: reason".
    static InputError in_file(const std::string& file, const std::string& reason)
    {
        return InputError(file + ": " + reason);
    }
    /// "file:line: reason", lines counted from 1.
    static InputError at_line(const std::string& file, std::size_t line, const std::string& reason)
    {
        return InputError(file + ":" + std::to_string(line) + ": " + reason);
    }
    /// "file: byte N: reason", bytes counted from 0.
    static InputError at_byte(const std::string& file, std::size_t byte, const std::string& reason)
    {
        return InputError(file + ": byte " + std::to_string(byte) + ": " + reason);
    }
};

} // namespace cinch
