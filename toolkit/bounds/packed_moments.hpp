// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

namespace cinch {

/// How a BV of the moment bound stands in PackedBvs::value: points, a head, and then its simulation nodes. A lifted
/// vector takes 16 values: what is multiplied with the rows (g/σ is in l)
///   l, G₀₂ | g, G₁₂ | column 0 of G, G₂₂ | column 1 of G, 0.
inline constexpr std::size_t moment_point = 16;
/// Where each of the 15 components of a lifted vector (d, ξ − d, N by columns) stands among these.
inline constexpr std::array<std::size_t, 15> moment_place{0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, 3, 7, 11};

/// The head, by its first value: half of the slack, about points that are moved to its middle (16); for g_s the three
/// rows that its columns are multiplied with, σ Σ_j f_js z_j z_jᵀ/2 and (c, 1) on top of row s (3 × 12); for φ the same
/// of the mean weights, σ Σ_j m_j z_j z_jᵀ/2 (12); greatest |z| along each coordinate, and 1/σ (4).
inline constexpr std::size_t moment_head_slack = 0, moment_head_g = 16, moment_head_phi = 52, moment_head_reach = 64,
                             moment_head = 68;

/// Of a simulation node: f (3), mean | z (3), l | its box's centre (3), r | half (3), 0.
inline constexpr std::size_t moment_mean = 3, moment_z = 4, moment_l = 7, moment_box = 8, moment_r = 11,
                             moment_values = 16;

/// Values of points, whose last one stands twice where their number is odd, and head.
constexpr std::size_t moment_values_before(std::size_t points)
{
    return (points + 1) / 2 * 2 * moment_point + moment_head;
}

} // namespace cinch
