// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>

#include "cinch/io.hpp"
#include "exact/displacements.hpp"
#include "exact/time_check.hpp"
#include "exact/vertex_bvs.hpp"
#include "toolkit/time/pose_limits.hpp"

namespace cinch::exact {

/// Whether every vertex of every BV, in real arithmetic, stays below supports[bv·k + d] in every pose within the limits
/// of the bones: the bone's transform to its parent x ↦ t + M x may be any x ↦ t' + E M x, |t' − t| ≤ move, E a
/// rotation by at most `angle`. Each vertex by itself, with its own weights and intervals with directed rounding.
/// Between its place in the file's pose and in another one lie poses in which one bone after another, from the joint
/// upward, is moved; each step moves the vertex by
///   |(t' − t) + (E − 1) M x| ≤ move + 2 sin(angle/2) |M x|
/// in the frame of the bone's parent, x where the file's pose of the bones below has it, and in the world by that times
/// the stretches of the bones above. Shares no formula with the toolkit but the length of that chord.
class PoseChecker {
public:
    /// Everything must stay as it is, and alive. `limits`: one per bone. `any_weights`: of all morph targets, instead
    /// of what the file says.
    PoseChecker(const DeformableSurface& surface, const Bvh& bvh, const Character& character,
                std::span<const PoseLimit> limits, std::optional<Enclosure> any_weights, int kdop,
                std::function<void()> poll);

    /// Refuted are bounds that a vertex passes in a pose that turns and moves the bones above it toward there, each
    /// shown to lie within its limit; `pieces` counts those, and times are NaN.
    TimeVerdict operator()(std::span<const double> supports) const;

private:
    struct Open;
    std::vector<Open> not_proven(const std::vector<double>& least) const;
    Character posed_toward(const Open& open) const;

    const DeformableSurface& surface_;
    const Character& character_;
    std::span<const PoseLimit> limits_;
    std::optional<Enclosure> any_weights_;
    int kdop_;
    std::function<void()> poll_;
    VertexBvs vertices_;
    Displacements displaced_;
};

} // namespace cinch::exact
