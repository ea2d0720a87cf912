// SPDX-License-Identifier: GPL-3.0-or-later
// Internal to exact/.
#pragma once

#include <string>
#include <vector>

#include "cinch/bvh.hpp"

namespace cinch::exact {

/// Every vertex's weights are positive multiples of 2^-53 that sum to exactly 1. Throws std::invalid_argument.
void require_dyadic_weights(const DeformableSurface& surface);

/// Rest vertices are finite, triangles have vertices that exist, and the BVs form a tree whose leaves hold every
/// triangle once. Throws std::invalid_argument.
void require_tree(const DeformableSurface& surface, const Bvh& bvh);

/// The vertices of one BV's triangles, each once, ascending.
std::vector<std::uint32_t> vertices_of(const DeformableSurface& surface, const Bvh& bvh, std::size_t bv);

/// Empty if the rest box contains the vertices, every influencing simulation node is listed and every weight lies in
/// its interval (0 for nodes that do not influence a vertex), all exactly; otherwise what is wrong.
std::string rest_data_fault(const DeformableSurface& surface, const Bvh& bvh, std::size_t bv,
                            std::span<const std::uint32_t> vertices);

} // namespace cinch::exact
