// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace cinch {

/// Eight vertices: x, y, z at rest (3 × 8 values) go through `count` of the maps (12 values each, row by row) with
/// eight weights each (8 × count values); place: 3 × 8. The same bits on every target. In double: the operations of
/// evaluate_vertex, in their order.
void evaluate_group(const double* rest, const std::uint32_t* node, const double* weight, std::size_t count,
                    const double* maps, double* place) noexcept;
void evaluate_group(const float* rest, const std::uint32_t* node, const float* weight, std::size_t count,
                    const float* maps, float* place) noexcept;

} // namespace cinch
