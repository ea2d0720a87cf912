// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "toolkit/surface/triangle_mesh.hpp"

namespace cinch {

using Vec2 = Eigen::Vector2d;

/// Which stage decided how many signs.
struct OrientationCounts {
    std::uint64_t in_double = 0;    ///< filtered double arithmetic
    std::uint64_t in_expansion = 0; ///< sums of doubles that represent the determinant exactly
    std::uint64_t in_integer = 0;   ///< big integers: exponents out of the reach of the other two
};

/// The exact sign, −1, 0 or 1, of det[b − a, c − a, d − a] for any finite coordinates, subnormal or near overflow; 0
/// where one of them is not finite. Positive where a, b, c turn anticlockwise as seen from d. Needs the default
/// floating-point environment (surface/arithmetic.hpp).
int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d,
                OrientationCounts* counts = nullptr) noexcept;

/// The same of det[b − a, c − a]: positive where a, b, c turn anticlockwise, 0 where they are collinear.
int orientation(const Vec2& a, const Vec2& b, const Vec2& c, OrientationCounts* counts = nullptr) noexcept;

} // namespace cinch
