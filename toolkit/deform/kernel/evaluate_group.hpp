// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "toolkit/surface/skin.hpp"

namespace cinch {

/// Eight vertices: x, y, z at rest (3 × 8 values) go through `count` maps with eight weights each (8 × count values); place: 3 × 8.
void evaluate_group(const double* rest, const std::uint32_t* node, const double* weight, std::size_t count, const AffineMap* maps, double* place) noexcept;

} // namespace cinch
