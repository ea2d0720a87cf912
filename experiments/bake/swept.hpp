// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "experiments/bake/timed_body.hpp"

namespace cinch {

/// A body's first clip as so many frames, evenly spread, the first and the last included: its input with such a clip.
Input with_frames(const TimedBody& body, std::size_t frames);

/// An input as bodies with clips as functions of time, `timed`, each with the first clip or the one that was asked for;
/// and as so many frames of them.
Inputs with_all_times(InputOptions what, std::size_t frames, std::vector<TimedBody>& timed);

/// Of each frame of `input` the bounds of the interval around it, supports[(f·BVs + bv)·k + d], each for all times of
/// the interval (bake_clip).
std::vector<double> swept_bounds(const TimedBody& body, const Input& input, const Bvh& bvh, int kdop);

} // namespace cinch
