// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "toolkit/surface/triangle_mesh.hpp"

namespace cinch {

/// ‖v‖ within 5u relative, without overflow on the way: u for each of a division, and after that a product, two sums
/// and a root, which halves what was before it, and a product. Not Eigen's stableNorm, whose order of summation depends
/// on the address of v wherever it is compiled for vectors of more than 16 bytes, and the bits with it.
inline double length(const Vec3& v) { return std::hypot(v[0], v[1], v[2]); }

} // namespace cinch
