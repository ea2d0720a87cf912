// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>

#include "exact/displacements.hpp"
#include "exact/motion_enclosure.hpp"

namespace cinch::exact {

/// Where vertices are at one instant, in real arithmetic: for counterexamples.
class InstantEnclosure {
public:
    /// At exactly this double. At a key where a curve jumps, after it. Surface and targets must stay alive.
    InstantEnclosure(const DeformableSurface& surface, const MotionEnclosure& clip,
                     std::span<const MorphTarget> targets, double t_s);

    std::array<Enclosure, 3> place(std::uint32_t vertex) const;

private:
    const DeformableSurface& surface_;
    Displacements displacements_;
    std::vector<MapEnclosure> maps_;
    std::vector<Enclosure> weights_;
};

/// That no point of the enclosure is in the closed ball; that all of it is.
bool is_outside(const std::array<Enclosure, 3>& place, const Vec3& centre, double radius);
bool is_inside(const std::array<Enclosure, 3>& place, const Vec3& centre, double radius);

/// That every vertex lies in the box of each simulation node that has weight in it, at rest: then the union of these
/// boxes' images contains the surface in every pose, as weights are convex (require_dyadic_weights). Decided exactly;
/// `low` and `high` are of every simulation node.
bool rest_boxes_hold(const DeformableSurface& surface, std::span<const Vec3> low, std::span<const Vec3> high);

} // namespace cinch::exact
