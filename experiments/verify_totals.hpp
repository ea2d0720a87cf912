// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <vector>

#include "exact/explain.hpp"
#include "exact/verifier.hpp"
#include "experiments/report/record_output.hpp"
#include "experiments/volumes.hpp"

namespace cinch {

/// Sums over the BVs of one level and all frames so far.
struct LevelTotals {
    std::size_t bvs = 0; ///< in the level
    double nodes = 0;    ///< sum of n over these
    std::size_t proven = 0, violated = 0;
    std::size_t measured = 0; ///< BVs × frames with a true radius > 0 and finite bounds
    double ratio_sum = 0, ratio_max = 0;
    exact::Loss loss; ///< sum over the measured, in units of their true radius
};

/// limited ≤ eq12 ≤ convex, compared on the doubles themselves, for every BV, direction and frame.
struct LadderTotals {
    std::size_t compared = 0, broken = 0;
    std::size_t defaults = 0, above = 0,
                clearly = 0; ///< of `best`: bounds compared with Eq. 12, those above it, and by over 1 % of its width

    bool holds() const { return broken == 0 && clearly == 0; }
};

struct VerifyTotals {
    std::size_t frames = 0, frames_wanted = 0; ///< of every body
    std::size_t at_once = 1;                   ///< bodies that make a frame together
    std::size_t bounds = 0, proven = 0, violated = 0, decided_by_filter = 0;
    std::size_t infinite = 0;        ///< of the proven ones
    std::size_t unbounded_nodes = 0; ///< transforms too large for the arithmetic, over all frames
    double seconds = 0;
    std::size_t packed_bytes = 0, rest_bytes = 0; ///< what the kernels stream; all rest data, as the verifier reads it
    std::vector<LevelTotals> levels;              ///< of the bodies that have a frame proven
    LadderTotals ladder;
    std::vector<VolumeTotals> volumes; ///< per level; empty if not asked for
    struct RootLoss {
        int direction;
        double bound;
        exact::ExactLoss loss;
    };
    std::vector<RootLoss> root; ///< exact attribution of the root's bounds in the last frame, for JSON
    struct Example {
        std::size_t frame;
        std::size_t level;
        exact::Violation violation;
    };
    std::vector<Example> examples; ///< the first violations
};

/// Adds a frame's verdict on the BVs of which `counted` says so; all of them if it is empty.
void add(const Bvh& bvh, const exact::FrameVerdict& frame, int kdop, std::span<const char> counted,
         VerifyTotals& totals);
/// Makes room for the tree's levels, and counts their BVs.
void add_levels(const Bvh& bvh, VerifyTotals& totals);
/// Sums of the levels.
void finish(VerifyTotals& totals);
/// What its records and tables are of.
inline Completeness completeness_of(const VerifyTotals& totals)
{
    return completeness_in_frames(totals.frames / totals.at_once, totals.frames_wanted / totals.at_once);
}

} // namespace cinch
