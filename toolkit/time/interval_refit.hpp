// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cinch/refit.hpp"
#include "toolkit/hierarchy/morph_boxes.hpp"
#include "toolkit/time/motion_interval.hpp"

namespace cinch {

/// Bounds every BV of a surface for all times of an interval: two refits, at the end of the interval and of its bend
/// (a third at its beginning, where that is not the end of the last one), and a pass over the influences.
///
/// With F_a, F_b the bounds at both ends and s ≥ −(D²/8) γ·v″(t) for every vertex v and all t, every γ·v(t) lies below
/// the parabola (1 − τ)F_a + τF_b + 4τ(1 − τ)s, whose greatest value is the bound: max(F_a, F_b) where the chord is
/// steep, else (F_a + F_b)/2 + s + (F_b − F_a)²/(16 s). s: the support of the bend over the BV plus a remainder, or
/// the bump, whichever is less; and from the path's length (F_a + F_b + L)/2 and min(F_a, F_b) + L. What morph
/// targets add to F_a, F_b and the bend are supports of their own (MorphBoxes). No BV reaches farther than its
/// children.
class IntervalRefitter {
public:
    /// Surface and BVH must stay as they are, and alive. Throws std::invalid_argument for a k that is none.
    /// `targets`: those whose weights a motion has.
    IntervalRefitter(const Bvh& bvh, const DeformableSurface& surface, const RefitOptions& options,
                     std::span<const MorphTarget> targets = {});

    /// supports[bv·k + d] as a Refitter's: at every real t of the interval, and of every vertex in exact arithmetic and
    /// as evaluate_vertex computes it from maps that are as near to the exact ones as `first` and `last` are.
    void operator()(const MotionInterval& motion, std::span<double> supports);

    /// At one instant, of these maps and weights of morph targets, where there are some.
    void at(std::span<const AffineMap> maps, std::span<const double> weights, std::span<double> supports);

    /// Those of the last interval's ends, in its own arithmetic: bounds at these times.
    std::span<const double> at_first() const { return first_; }
    std::span<const double> at_last() const { return last_; }
    /// Supports of a BV.
    std::size_t kdop() const { return static_cast<std::size_t>(kdop_); }

private:
    const Bvh& bvh_;
    int kdop_;
    Refitter refit_;
    MorphBoxes morphs_;
    std::vector<AffineMap> last_maps_;
    std::vector<double> last_weights_;
    std::vector<double> first_, last_, bend_;
};

/// Cuts each BV's supports off where none of its children reaches.
void merge_children(const Bvh& bvh, std::size_t k, std::span<double> supports);

/// The greatest value of the parabola above, with what the path's length L says; rounded up. Infinite where an input is
/// or is no number.
double greatest_between(double first, double last, double bump, double path);

} // namespace cinch
