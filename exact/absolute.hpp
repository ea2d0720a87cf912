// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "cinch/surface.hpp"

namespace cinch::exact {

/// What supports relative to an origin say in the coordinates of the vertices: the greatest doubles found that are at
/// most relative[d] + γ_d·origin, d as in axes_of(k). So where these bound a vertex, the relative ones do. +∞ stays;
/// NaN becomes −∞, which bounds nothing. Throws std::invalid_argument for sizes that do not fit.
void absolute_supports(int kdop, std::span<const float> relative, const Vec3& origin, std::span<double> supports);

} // namespace cinch::exact
