// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "exact/displacements.hpp"
#include "exact/motion_enclosure.hpp"
#include "exact/vertex_bvs.hpp"

namespace cinch::exact {

/// A vertex outside of a bound at some time.
struct Outside {
    std::size_t bv = 0, direction = 0, vertex = 0;
    double time_s = 0;   ///< exactly this double; NaN where it is in a pose
    double bound = 0;    ///< the support
    double at_least = 0; ///< what the vertex reaches along the direction, rounded down
};

/// What was found about bounds of all BVs over one interval of time.
struct TimeVerdict {
    std::size_t bounds = 0;    ///< BVs × directions
    std::size_t violated = 0;  ///< refuted by a vertex and a time
    std::size_t undecided = 0; ///< neither proven nor refuted after all halvings
    std::size_t pieces = 0;    ///< intervals of time looked at
    std::optional<Outside> worst;

    std::size_t proven() const { return bounds - violated - undecided; }
    void add(const TimeVerdict& other);
};

/// Branch and bound over time on the transforms themselves: whether every vertex of every BV, w·T(t)(y + Σ a_i(t) d_i)
/// in real arithmetic, stays below supports[bv·k + d] at all real t of [a, b]. On a piece of time about m a vertex is
/// enclosed by x(m) + x′(piece)(t − m), both from interval arithmetic, and where the slope has one sign by its ends;
/// pieces that do not decide are halved, for the vertices that they leave open, 48 times at most, and no more than some
/// ten thousand pieces per key. In parallel over vertices. `poll` is called now and then and may throw.
class TimeChecker {
public:
    /// Surface, BVH and clip must stay as they are, and alive. `targets`: those whose weights the clip has.
    TimeChecker(const DeformableSurface& surface, const Bvh& bvh, const MotionEnclosure& clip,
                std::span<const MorphTarget> targets, int kdop, std::function<void()> poll);

    TimeVerdict operator()(double a_s, double b_s, std::span<const double> supports) const;

private:
    const DeformableSurface& surface_;
    const MotionEnclosure& clip_;
    int kdop_;
    std::function<void()> poll_;
    VertexBvs vertices_;
    Displacements displaced_;
};

} // namespace cinch::exact
