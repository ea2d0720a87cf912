// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "cinch/bounds.hpp"
#include "cinch/surface.hpp"
#include "toolkit/bounds/weight_space.hpp"

namespace cinch {

/// The 2·axes.size() supports of one deformed vertex. With Rounding::proven they contain both the exactly deformed and
/// the computed vertex; with Rounding::plain they are the computed vertex's coordinates. +∞ where anything is not
/// finite.
void bound_vertex(const Vec3& rest, Weights::Row row, std::span<const AffineMap> maps, Rounding rounding,
                  std::span<const Axis> axes, std::span<double> supports) noexcept;

} // namespace cinch
