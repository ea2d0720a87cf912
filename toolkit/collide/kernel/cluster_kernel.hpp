// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace cinch {

/// Two deformed leaves of two bodies.
struct ClusterPair {
    const float *slot_a, *slot_b; ///< see leaf_slot_floats
    const float *dop_a, *dop_b;   ///< see dop.hpp
    std::uint32_t triangles_a, triangles_b;
};

struct ClusterInput {
    std::size_t lanes = 16, side = 4;
    float shift[4] = {0, 0, 0, 0}; ///< of b's body's origin from a's, and a 0
    float shift_error = 0;      ///< by how much any of them is off at most
};

/// Triangle i of a and j of b of a pair of the list: they intersect, or are too close to call in float.
struct TriangleHit {
    std::uint32_t pair;
    std::uint8_t i, j;
    bool doubtful;
};

/// Appends what may intersect to `out`, by pair, i, j; whatever is left out certainly does not. Counts the pairs of triangles whose boxes
/// overlap. Everything holds for the vertices of evaluate_vertex. The same on every target.
///
/// All is relative to a's reference point, where coordinates are small. u = 2^-24; s bounds how far a coordinate of one leaf is off against
/// the other's, κ those of two vertices of the same leaf (LeafPlace). For a determinant of three differences of points, x, y, z as computed
/// and X, Y, Z in truth with |X − x|∞ ≤ g_x and so on:
///   |det(X, Y, Z) − det(x, y, z)| ≤ √3 (g_x ‖Y‖‖Z‖ + ‖x‖ g_y ‖Z‖) + g_z |x × y|₁,
/// and (x × y)·z by fused multiply-adds is off by 27u|x|∞|y|∞|z|∞: 3u a component of x × y, then γ₃ of terms ≤ 2|x|∞|y|∞|z|∞.
/// Two triangles whose boxes overlap lie in a box of diagonal D ≤ d_a + d_b + 2s, d their own. Here x and y are edges, of the same triangle
/// for the side of a point to its plane, else of one each; z goes from the one triangle to the other. So with g = s + uD, h = κ + 12u d:
///   margin g|x × y|₁ + √3 (h_x (d_y + √3 h_y) + d_x h_y)(D + √3 g).
/// Rounding needs 27u + 2√3u for the differences' and, g ≤ D/2, 5u for that of x × y in the first term, of d_x d_y D; there is 2√3·12u.
/// Times 1 + 2^-16 for the rounding of the margin itself and of D, plus 2^-120 for underflow.
void test_clusters(const ClusterInput& input, std::span<const ClusterPair> pairs, std::uint32_t first_pair, std::vector<TriangleHit>& out, std::uint64_t& triangle_tests);

} // namespace cinch
