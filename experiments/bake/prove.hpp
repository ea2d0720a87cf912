// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "exact/time_check.hpp"
#include "experiments/bake/baked_clip.hpp"
#include "experiments/bake/timed_body.hpp"

namespace cinch {

/// Proves baked bounds of one of a body's clips.
exact::TimeVerdict prove(const TimedBody& body, const TimedClip& clip, const Bvh& bvh, int kdop,
                         std::span<const BakedInterval> intervals);

/// "N bounds for all times, P proven, V violated", with what is undecided; and where the worst vertex is.
std::string verdict_line(const exact::TimeVerdict& verdict);
std::string worst_line(const exact::TimeVerdict& verdict);

} // namespace cinch
