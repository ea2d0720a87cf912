// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstdint>

namespace cinch {

/// Two triangles that intersect: indices of bodies, body_a < body_b, and of triangles of their meshes.
struct TrianglePair {
    std::uint32_t body_a, triangle_a, body_b, triangle_b;
    auto operator<=>(const TrianglePair&) const = default;
};

} // namespace cinch
