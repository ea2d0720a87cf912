// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "toolkit/time/interval_refit.hpp"

namespace cinch {

/// The bounds of one interval of a clip.
struct BakedInterval {
    double first_s = 0, last_s = 0;
    std::vector<double> supports; ///< of all BVs, supports[bv·k + d]
    double intervals = 0;         ///< that it was put together from, mean of the BVs
};

/// How a clip is cut.
struct ClipCuts {
    bool whole = false;      ///< one interval
    double interval_s = 0;   ///< of equal ones; 0: by themselves
    double tolerance = 0.01; ///< of a BV's half diagonal, see bound_over
};

/// A clip cut into intervals: one, equal ones, or such that a cut in two halves would make the character's box smaller
/// by less than a tenth on average; each bounded for all of its times. `bvs`: of the tree. `poll(t)` is called before
/// each is bounded, with the time up to which the clip is done, and may throw.
std::vector<BakedInterval> bake_clip(IntervalRefitter& refit, const TimedMotion& motion, const ClipCuts& cuts,
                                     std::size_t bvs, const std::function<void(double)>& poll);

} // namespace cinch
