// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "experiments/bake/baked_clip.hpp"
#include "experiments/bake/timed_body.hpp"
#include "experiments/measure/race.hpp"

namespace cinch {

/// What bounding one interval of a body's first clip costs, in refits: key segments in turn, beside refits at their
/// ends, on this thread alone.
Range refits_per_interval(const TimedBody& body, const Bvh& bvh, const RefitOptions& options);

/// The figures that bounds over time should reach, over all clips. `cost`: of an interval, with how many BVs.
std::vector<Figure> time_targets(const std::vector<BakedFigures>& clips, const Range& cost, std::size_t bvs);

} // namespace cinch
