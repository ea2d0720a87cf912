// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "experiments/bake/baked_clip.hpp"
#include "experiments/bake/timed_body.hpp"

namespace cinch {

/// Of a body's first clip: key segments in turn, beside refits at their ends, on this thread alone.
IntervalCost interval_cost(const TimedBody& body, const Bvh& bvh, const RefitOptions& options);

/// The figures that bounds over time should reach, over all clips. `cost`: of an interval, with how many BVs.
std::vector<Figure> time_targets(const std::vector<BakedFigures>& clips, const IntervalCost& cost, std::size_t bvs);

} // namespace cinch
