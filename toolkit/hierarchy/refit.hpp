// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "toolkit/hierarchy/bvh.hpp"

namespace cinch {

struct RefitOptions {
    Method method = Method::limited;
    int kdop = 6; ///< 6, 14, 18 or 26
    Rounding rounding = Rounding::proven;
};

/// Bounds every BV for one frame: supports[bv·k + d], d as in axes_of(k). `limited`, `eq12` and `convex` cost O(n) per BV and do
/// not touch the vertices; `vertices` evaluates them. In parallel over BVs; the same bits for every thread count.
/// Throws std::invalid_argument for sizes that do not fit and std::runtime_error for a changed floating-point environment.
void refit(const Bvh& bvh, const DeformableSurface& surface, std::span<const AffineMap> maps, const RefitOptions& options,
           std::span<double> supports);

} // namespace cinch
