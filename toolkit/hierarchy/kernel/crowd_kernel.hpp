// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "toolkit/surface/skin.hpp"

namespace cinch {

/// One box of a crowd: groups of eight simulation nodes, the last one repeated where they are fewer.
struct CrowdBox {
    std::uint32_t first_group, groups;
};

/// What the kernel reads. A group is eight simulation nodes of a box: their numbers in `node`, and in `rest` 48 floats:
/// the centres' x of the eight, y and z, then the half extents.
struct CrowdInput {
    std::size_t nodes = 0; ///< of the surface
    std::span<const CrowdBox> boxes;
    const std::uint32_t* node = nullptr;
    const float* rest = nullptr;
    const std::uint32_t* run = nullptr; ///< of each group the first of eight numbers in a row, or no_run
    float least = 0;                    ///< what underflow may cost
    bool proven = true;                 ///< else nothing is added for rounding
};
constexpr std::uint32_t no_run = ~std::uint32_t{0};

/// Places for the maps of one body.
std::size_t crowd_scratch(std::size_t nodes);

/// The boxes of one body, out[6b]: greatest x, y, z, then least x, y, z. False, and nothing is said, where an entry of
/// its maps is beyond 2^40, or none.
bool bound_body(const CrowdInput& input, std::span<const AffineMap> maps, float* scratch, float* out);

} // namespace cinch
