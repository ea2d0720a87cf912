// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace cinch {

/// The rest data of a leaf in a run of floats, with room for `lanes` vertices and triangles (the last vertex repeated to fill them):
///   x, y, z relative to the rest origin     3 × lanes floats
///   the three corners of every triangle     3 × lanes bytes, places among the vertices
///   per simulation node its index, and its greatest weight    2 words each
///   per simulation node the vertices' weights                 lanes floats each, from a multiple of `lanes` on
struct PackedLeaf {
    std::uint64_t first = 0;          ///< of its run
    std::uint32_t nodes = 0;          ///< simulation nodes
    std::uint32_t first_triangle = 0; ///< in Bvh::triangle
    std::uint32_t triangles = 0, vertices = 0;
    float reach[3] = {0, 0, 0};       ///< at least |x|, |y|, |z| of every vertex
};

/// Where the words of a run stand.
struct LeafRun {
    std::size_t lanes, nodes;

    std::size_t corners() const { return 3 * lanes; }
    std::size_t influences() const { return corners() + 3 * lanes / 4; }
    std::size_t weights() const { return (influences() + 2 * nodes + lanes - 1) / lanes * lanes; }
    std::size_t size() const { return weights() + nodes * lanes; }
};

/// A deformed leaf: the corners of its triangles, floats relative to the body's origin: 3 corners × 3 coordinates × lanes; then in the
/// first of another `lanes` floats how far any coordinate is at most from that of evaluate_vertex: +∞ if nothing is known of it.
constexpr std::size_t leaf_slot_floats(std::size_t lanes) { return 10 * lanes; }

struct LeafInput {
    std::size_t lanes = 16; ///< 4, 8 or 16
    std::span<const PackedLeaf> leaves;
    const float* value = nullptr;   ///< of the runs, on cache lines
    const float* records = nullptr; ///< ProjectedMaps<float>
    std::size_t record = 16;        ///< floats of each
    int kdop = 6;
    double vertex_error = 0;        ///< ProjectedMaps::vertex_error
};

struct LeafJob {
    std::uint32_t leaf;
    float* slot; ///< on a cache line
    float* dop;  ///< see dop.hpp
};

/// Deforms leaves, and bounds them by their vertices. The supports contain the vertices of evaluate_vertex and the exactly deformed ones.
/// The same bits on every target. Error of a coordinate, with u = 2^-24, n the leaf's nodes and w ≤ h their weights: a leaf w·A·x of
/// Σ_j w_j (A_j x + d_j), summed over the nodes first, passes 3 roundings to float (and one of a difference in double, far less), n in the
/// sum and 3 in the product with x; d's passes 2 + n. So it is within γ_{n+6} of max_r Σ_j h_j (Σ_s |A_rs| reach_s + |d_r|) =: N.
/// N is computed with n + 6 roundings: for n ≤ 65536 (n + 8)·1.02·u·N covers both. Products and conversions that underflow lose η/2
/// each: 2^-149·(n + 8)(1 + Σ reach + Σ h|A|).
void evaluate_leaves(const LeafInput& input, std::span<const LeafJob> jobs);

} // namespace cinch
