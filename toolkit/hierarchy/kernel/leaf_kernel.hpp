// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace cinch {

/// The rest data of a leaf in a run of floats, with room for `lanes` vertices and triangles (the last vertex repeated
/// to fill them):
///   x, y, z relative to the pivot           3 × lanes floats
///   the three corners of every triangle     3 × lanes bytes, places among the vertices
///   per simulation node, the heaviest first, its index, its greatest weight h, by how much weights differ r ≤ h,
///   nothing    4 words each per simulation node the vertices' weights                 lanes floats each, from a
///   multiple of `lanes` on
struct PackedLeaf {
    std::uint64_t first = 0;          ///< of its run
    std::uint32_t nodes = 0;          ///< simulation nodes
    std::uint32_t first_triangle = 0; ///< in Bvh::triangle
    std::uint32_t triangles = 0, vertices = 0;
    float pivot[4] = {0, 0, 0, 1}; ///< relative to the rest origin, and a 1
    float reach[4] = {0, 0, 0, 0}; ///< at least |x|, |y|, |z| of every vertex, and a 0
};

/// Where the words of a run stand.
struct LeafRun {
    std::size_t lanes, nodes;

    std::size_t corners() const { return 3 * lanes; }
    std::size_t influences() const { return corners() + 3 * lanes / 4; }
    std::size_t weights() const { return (influences() + 4 * nodes + lanes - 1) / lanes * lanes; }
    std::size_t size() const { return weights() + nodes * lanes; }
};

/// A deformed leaf: its vertices relative to a reference point of its own, 3 coordinates × lanes floats; the corners of
/// its triangles, as in its run; then the reference point relative to the body's origin, and two errors. With P the
/// vertex of evaluate_vertex or the exact one, p the vertex and R the reference: |P − (R + p)| ≤ error, and |(P − P′) −
/// (p − p′)| ≤ difference for any two vertices, in every coordinate. +∞ if nothing is known of it.
struct LeafPlace {
    float reference[3], error, difference;
};
constexpr std::size_t leaf_slot_floats(std::size_t lanes) { return lanes * (lanes < 8 ? 6 : 5); } // of 3.75 lanes + 5
inline const std::uint8_t* corners_of(const float* slot, std::size_t lanes)
{
    return reinterpret_cast<const std::uint8_t*>(slot + 3 * lanes);
}
inline LeafPlace& place_of(float* slot, std::size_t lanes)
{
    return *reinterpret_cast<LeafPlace*>(slot + 3 * lanes + 3 * lanes / 4);
}
inline const LeafPlace& place_of(const float* slot, std::size_t lanes)
{
    return *reinterpret_cast<const LeafPlace*>(slot + 3 * lanes + 3 * lanes / 4);
}

struct LeafInput {
    std::size_t lanes = 16; ///< 4, 8 or 16
    std::span<const PackedLeaf> leaves;
    const float* value = nullptr;   ///< of the runs, on cache lines
    const float* records = nullptr; ///< ProjectedMaps<float>
    std::size_t record = 16;        ///< floats of each
    int kdop = 6;
    double vertex_error = 0; ///< ProjectedMaps::vertex_error
};

struct LeafJob {
    std::uint32_t leaf;
    float* slot; ///< on a cache line; null if only the supports are wanted
    float* dop;  ///< see dop.hpp
};

/// Deforms leaves, and bounds them by their vertices. The supports contain the vertices of evaluate_vertex and the
/// exactly deformed ones. The same bits on every target. With z the pivot and y = x − z, Y_j = A_j z + d_j the images
/// of the pivot and R = Y_0 as computed:
///   P = R + Σ_j w_j (A_j y + U_j),  U_j = Y_j − R, as Σ w = 1.
/// What differs between the nodes is small, and so are its errors. u = 2^-24, n nodes, |·| per coordinate:
///   Y_j: A z passes one rounding to float (and one to double, far less), one of the product and two of the sum, d two
///   to float and two of
///     the sum: within γ₅ of N_j = |A_j||z| + |d_j|; U_j then adds u|U_j|. Together Σ w_j 6u N_j ≤ 6u Σ h_j N_j of P,
///     and 6u Σ r_j N_j of a difference of two;
///   Σ w (A y + U): 3 roundings to float, n in the sum, 3 in the product with y, 1 for U_j's own: γ_{n+7} of M = Σ h_j
///   (|A_j| reach + |U_j|).
/// For n ≤ 65536 a factor 1.02 covers higher orders and the n + 5 roundings of N and M themselves. Products and
/// conversions that underflow lose 2^-150 each; 2^-120·(n + 8)(1 + Σ(|z| + reach) + Σ h|A|) is far more, and made of
/// normal numbers.
void evaluate_leaves(const LeafInput& input, std::span<const LeafJob> jobs);

} // namespace cinch
