// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "toolkit/time/interval_refit.hpp"

namespace cinch {

/// What a bound over time cost.
struct TimeCost {
    std::size_t intervals = 0; ///< bounded one by one
    std::size_t refits = 0;
};

/// Bounds of every BV for all times of [a, b], both included: intervals between keys, halved where one exceeds the
/// greatest bound at any time looked at by more than `tolerance` of the BV's greatest half extent, at most 20 times and
/// 1000 intervals, and 8 more per key, in all.
/// first_s() ≤ a ≤ b ≤ last_s(). `supports` as of IntervalRefitter.
TimeCost bound_over(IntervalRefitter& refit, const TimedMotion& motion, double a_s, double b_s, double tolerance,
                    std::span<double> supports);

} // namespace cinch
