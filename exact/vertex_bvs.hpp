// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cinch/bvh.hpp"

namespace cinch::exact {

/// The vertices that triangles have, and the BVs that contain each of them.
struct VertexBvs {
    std::vector<std::uint32_t> vertex;  ///< ascending
    std::vector<std::uint32_t> row, bv; ///< the i-th vertex's BVs are bv[row[i]] to bv[row[i + 1] − 1]

    VertexBvs(const DeformableSurface& surface, const Bvh& bvh);

    /// Per vertex and direction, at i·k + d, the least support of the BVs that contain it, which decides for all of
    /// them: supports[bv·k + d]. −∞ where one is no number.
    std::vector<double> least(std::span<const double> supports, std::size_t k) const;
};

} // namespace cinch::exact
