// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "experiments/bake/bake.hpp"
#include "experiments/measure/race.hpp"
#include "toolkit/time/bake_clip.hpp"

namespace cinch {

/// toolkit/time/bake_clip.hpp, until it is interrupted.
std::vector<BakedInterval> bake_clip(IntervalRefitter& refit, const TimedMotion& motion, const BakeOptions& options,
                                     std::size_t supports);

/// What a baked clip gives away, and what sampled bounds miss.
struct BakedFigures {
    double time_mean = 1, time_max = 1; ///< radius of a BV's bound over an interval / that of the hull of its bounds at
                                        ///< instants of it, all BVs and intervals
    double root = 1, leaves = 1;        ///< radius over the whole clip / that of the truth: root, mean of the leaves
    double missed_30fps = 0, missed_keys = 0; ///< how far the surface leaves the union of true boxes at 30 frames per
                                              ///< second and at key times, of its half diagonal
    double missed_by_us = 0;                  ///< the same of the root's bounds: 0
    std::size_t key_segments = 0;
    double intervals = 0; ///< that a BV was bounded in, mean of the BVs
    double length_s = 0;
};
BakedFigures figures_of(const DeformableSurface& surface, const Bvh& bvh, std::span<const MorphTarget> targets,
                        IntervalRefitter& refit, const TimedMotion& motion, const BakeOptions& options,
                        const std::vector<BakedInterval>& baked);

/// What bounding one interval costs, in refits: where every BV's bend is bounded, and by norms alone.
struct IntervalCost {
    Range bend = std::nan(""), norms = std::nan("");
};

/// Of a level and those above it; the level of a BV, given where levels begin (Bvh::level).
std::size_t bvs_down_to(const Bvh& bvh, int level);
std::size_t level_of(std::span<const std::uint32_t> levels, std::size_t bv);

/// A NumPy archive: per clip NAME/times, n × 2 seconds, NAME/bounds, n × BVs × 2 × 3 (k = 6: least and greatest
/// corners) or n × BVs × k supports; and the level of every BV.
void write_npz(const std::string& file, std::span<const std::uint32_t> levels, std::size_t bvs, int kdop,
               const std::vector<std::pair<std::string, std::vector<BakedInterval>>>& clips);
/// A USD layer: a prim per clip with the character's box as time samples of "extent", in seconds; each sample holds the
/// intervals on both sides of it, so that any interpolation between two holds the one between them.
void write_usd(const std::string& file, const std::vector<std::pair<std::string, std::vector<BakedInterval>>>& clips);

} // namespace cinch
