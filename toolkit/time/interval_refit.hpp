// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "toolkit/hierarchy/bounder.hpp"
#include "toolkit/hierarchy/morph_boxes.hpp"
#include "toolkit/time/motion_interval.hpp"
#include "toolkit/time/motion_span.hpp"

namespace cinch {

/// BVs of a tree, ascending, each with all that are below it.
using BvList = std::span<const std::uint32_t>;

/// Bounds at one time, and what they are of.
struct InstantBounds {
    std::vector<AffineMap> maps;
    std::vector<double> weights;  ///< of morph targets, where there are some
    std::vector<double> supports; ///< k per BV of a list
};

/// Bounds BVs of a surface for all times of an interval: a refit at either end, one of the bend where that is worth
/// it, and a pass over the influences.
///
/// With F_a, F_b the bounds at both ends and s ≥ −(D²/8) γ·v″(t) for every vertex v and all t, every γ·v(t) lies below
/// the parabola (1 − τ)F_a + τF_b + 4τ(1 − τ)s, whose greatest value is the bound: max(F_a, F_b) where the chord is
/// steep, else (F_a + F_b)/2 + s + (F_b − F_a)²/(16 s). s: the bump of the norms; or the support of the bend over the
/// BV plus a remainder, whichever is less; and from the path's length (F_a + F_b + L)/2 and min(F_a, F_b) + L. What
/// morph targets add to F_a, F_b and the bend are supports of their own (MorphBoxes). No BV reaches farther than its
/// children.
class IntervalRefitter {
public:
    /// Surface and BVH must stay as they are, and alive. Throws std::invalid_argument for a k that is none.
    /// `targets`: those whose weights a motion has.
    IntervalRefitter(const Bvh& bvh, const DeformableSurface& surface, const RefitOptions& options,
                     std::span<const MorphTarget> targets = {});

    /// At one time, of these maps and weights of morph targets, where there are some.
    InstantBounds at(BvList bvs, std::vector<AffineMap> maps, std::vector<double> weights);

    /// supports[n·k + d] of the n-th BV listed: at every real t of the interval, and of every vertex in exact
    /// arithmetic and as evaluate_vertex computes it from maps that are as near to the exact ones as the ends' are.
    /// `first` and `last`: at its ends, of the same BVs. The bend is left out where without it the bound exceeds theirs
    /// by at most `enough` of the half diagonal.
    void operator()(BvList bvs, const MotionInterval& motion, const InstantBounds& first, const InstantBounds& last,
                    double enough, std::span<double> supports);

    /// The same over intervals in a row, from the bounds at both ends of all: no refit in between, no bend.
    void operator()(BvList bvs, const MotionSpan& motion, const InstantBounds& first, const InstantBounds& last,
                    std::span<double> supports);

    BvList all() const { return all_; } ///< BVs of the tree
    std::size_t kdop() const { return static_cast<std::size_t>(kdop_); }
    const Bvh& bvh() const { return bvh_; }

private:
    void refit(BvList bvs, std::span<const AffineMap> maps, std::span<double> supports);
    void merge_children(BvList bvs, std::span<double> supports);
    double evaluation(std::uint32_t bv, bool morphs) const;
    void require(BvList bvs, const InstantBounds& first, const InstantBounds& last, std::span<double> supports) const;

    const Bvh& bvh_;
    int kdop_;
    Bounder bounder_;
    MorphBoxes morphs_;
    std::vector<std::uint32_t> all_, place_; // of each BV in the list at hand
    std::vector<double> norm_;               // of the axes, rounded up
};

/// Whether a BV's supports over an interval, k of them, exceed those at instants by so little that the half diagonal of
/// its box grows by at most `share`, and so little along every other direction.
bool is_near(std::span<const double> supports, std::span<const double> instants, double share);

/// The greatest value of the parabola above, with what the path's length L says; rounded up. Infinite where an input is
/// or is no number.
double greatest_between(double first, double last, double bump, double path);

} // namespace cinch
