// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cinch/bvh.hpp"
#include "cinch/io.hpp"
#include "toolkit/time/motion_interval.hpp"

namespace cinch {

/// A small character whose one clip is `character.rest`: a chain of bones with curves of each kind, awkward keys among
/// them, a strip of triangles along it, and every other time morph targets.
struct TimeCase {
    Character character;
    DeformableSurface surface;
    Bvh bvh;
};
TimeCase draw_time_case(std::uint64_t seed);

/// Bounds of a case for all times of its clip: as bound_over() does it, or loose on purpose, by as many intervals in a
/// row as it tries, or by each between two keys.
enum class CutInto { chosen, in_a_row, between_keys };
std::vector<double> bounds_over_clip(const TimeCase& subject, const TimedMotion& motion, const RefitOptions& options,
                                     CutInto by);

} // namespace cinch
