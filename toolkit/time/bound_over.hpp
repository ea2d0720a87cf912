// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "toolkit/time/interval_refit.hpp"

namespace cinch {

/// Bounds of every BV for all times of [a, b], both included: intervals between keys, halved, for the BVs alone that
/// exceed there the greatest bound at any time looked at by more than `tolerance` (see is_near); at most 20 times and
/// 1000 intervals, and 8 more per key, in all.
/// first_s() ≤ a ≤ b ≤ last_s(). supports[bv·k + d] as a Refitter's. Returns in how many intervals a BV was bounded,
/// the mean of all.
double bound_over(IntervalRefitter& refit, const TimedMotion& motion, double a_s, double b_s, double tolerance,
                  std::span<double> supports);

} // namespace cinch
