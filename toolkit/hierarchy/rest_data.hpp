// SPDX-License-Identifier: Apache-2.0
// Internal to hierarchy/: the steps of build_bvh after the tree stands. Each reads what the ones before it set.
#pragma once

#include "cinch/bvh.hpp"

namespace cinch {

/// Rest boxes, influences with their weight intervals, and local boxes, merged from the leaves upward.
void set_boxes(const DeformableSurface& surface, Bvh& bvh);
/// Oriented boxes along the principal axes of the vertices.
void orient_boxes(const DeformableSurface& surface, Bvh& bvh);
/// Radii of the local balls, pivots and weight models.
void fit_weight_models(const DeformableSurface& surface, Bvh& bvh);
/// Up to 16 to 64 extreme points per BV, and their slack.
void choose_points(const DeformableSurface& surface, Bvh& bvh, bool leaves);

} // namespace cinch
