// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace cinch {

/// Supports of one BV as queries read them: floats relative to an origin, rounded up, first along the k/2 axes, then
/// against them. Each side has at least one pad and a multiple of 4 floats, so that opposite supports stand dop_side(k)
/// apart:
///   k = 6: [x y z · | −x −y −z ·], 32 bytes.
constexpr std::size_t dop_side(int kdop) { return static_cast<std::size_t>(kdop) / 2 / 4 * 4 + 4; }
constexpr std::size_t dop_floats(int kdop) { return 2 * dop_side(kdop); }

} // namespace cinch
