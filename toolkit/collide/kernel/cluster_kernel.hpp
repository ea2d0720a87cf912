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
    float shift_error = 0;         ///< by how much any of them is off at most
};

/// Triangle i of a and j of b of a pair of the list: they intersect, or are too close to call in float.
struct TriangleHit {
    std::uint32_t pair;
    std::uint8_t i, j;
    bool doubtful;
};

/// Appends what may intersect to `out`, by pair, i, j; whatever is left out certainly does not. Counts the pairs of
/// triangles whose boxes overlap. Everything holds for the vertices of evaluate_vertex. The same on every target.
///
/// All is relative to a's reference point, where coordinates are small. u = 2^-24; s bounds how far a coordinate of one
/// leaf is off against the other's, κ those of two vertices of the same leaf (LeafPlace). For a determinant of three
/// differences of points, x, y, z as computed and X, Y, Z in truth with |X − x|∞ ≤ g_x and so on:
///   |det(X, Y, Z) − det(x, y, z)| ≤ √3 (g_x ‖Y‖‖Z‖ + ‖x‖ g_y ‖Z‖) + g_z |x × y|₁,
/// and (x × y)·z by fused multiply-adds is off by 27u|x|∞|y|∞|z|∞: 3u a component of x × y, then γ₃ of terms ≤
/// 2|x|∞|y|∞|z|∞. Boxes grown by s, the sum rounded up by at most 3u(|x| + s), overlap: they are apart by 2.5 s at most
/// along any axis, as s ≥ 2u|x| there (b's share of it), so both triangles lie in a box of diagonal D ≤ d_a + d_b + 5s,
/// d their own. Here x and y are edges, of the same triangle for the side of a point to its plane, else of one each; z
/// goes from the one triangle to the other. So with g = s + uD, h = κ + 12u d:
///   margin g|x × y|₁ + √3 (h_x (d_y + √3 h_y) + d_x h_y)(D + √3 g).
/// Rounding needs 27u + 2√3u for the differences' and, g ≤ D/2, 5u for that of x × y in the first term, of d_x d_y D;
/// there is 2√3·12u. Times 1 + 2^-16 for the rounding of the margin itself and of D.
///
/// Where that holds. Above: D < 2^41, or no lane is decided (D is not a number or infinite where anything before it
/// was). With edges of at most D and z of at most D(1 + 2^-22) every product, sum and partial sum of a determinant is
/// below 6D³(1 + 2^-20) < 2^126: none overflows, so none is infinite or inf − inf. The margin may overflow to infinity:
/// then its lane is not decided either. Below: η = 2^-149; a product or fma that underflows loses η/2, sums and
/// differences nothing. In x × y that is η a component, √3 η D of the determinant; its own products and sums lose 2η
/// more. In the margin: squares of d begin at 2^-120, so that d ≥ 2^-60, D, g ≥ 2^-83 and h ≥ 2^-81 are normal numbers;
/// d_x h_y and the sum it goes to lose η together, √3 η of the bracket, to which 2^-120 is added: more than √3 η for it
/// and √3 η for x × y, and it takes in that z may be 2^41 where the edges are tiny. What is left, 2η of the determinant
/// and 2η of the margin's last products, is far less than the 2^-120 that is added last.
void test_clusters(const ClusterInput& input, std::span<const ClusterPair> pairs, std::uint32_t first_pair,
                   std::vector<TriangleHit>& out, std::uint64_t& triangle_tests);

} // namespace cinch
