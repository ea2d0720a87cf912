// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cinch/io.hpp"
#include "toolkit/time/motion_interval.hpp"

namespace cinch {

/// What an engine takes for the bound of a whole character: a box, or a ball. In the unit of the file.
struct EngineBound {
    Vec3 low, high;             ///< of the box, or of the box around the ball
    std::optional<double> ball; ///< its radius
    Vec3 centre() const { return 0.5 * low + 0.5 * high; }

    static EngineBound around(const Vec3& centre, double radius)
    {
        return {centre - Vec3::Constant(radius), centre + Vec3::Constant(radius), radius};
    }
};

/// A character as engines have it: vertices at rest, weights, transforms of joints.
struct EngineCharacter {
    const DeformableSurface& surface;
    const TimedMotion& motion;            ///< of the clip
    std::vector<AffineMap> file_pose;     ///< T_j of the pose of the file; of others than characters that of time 0
    std::vector<Vec3> pivot;              ///< of every joint at rest; empty for others than characters
    std::size_t root = 0;                 ///< the joint above all others
    std::span<const MorphTarget> targets; ///< of the file

    /// Where vertices are in a pose, morph targets left out; and at a time of the clip, with them.
    std::vector<Vec3> places(std::span<const AffineMap> maps) const;
    std::vector<Vec3> places_at(double t_s) const;
};

/// A formula made ready for a character and a clip.
struct ReadyFormula {
    bool still = false; ///< one bound for the whole clip
    /// True where, in real arithmetic, convexity alone makes it hold in every pose without morph targets.
    bool holds_by_convexity = false;
    std::function<EngineBound(std::span<const AffineMap> maps)> at;
};

/// A formula that an engine uses, written from its documentation.
struct EngineFormula {
    std::string name, used_by, says;
    /// Nothing where the formula needs what the character does not have.
    std::function<std::optional<ReadyFormula>(const EngineCharacter&)> make;
};
const std::vector<EngineFormula>& engine_formulas();

// One file each.
std::optional<ReadyFormula> rest_box(const EngineCharacter& of);
std::optional<ReadyFormula> rest_sphere(const EngineCharacter& of);
std::optional<ReadyFormula> joint_boxes(const EngineCharacter& of);
std::optional<ReadyFormula> joint_boxes_float(const EngineCharacter& of);
std::optional<ReadyFormula> joint_spheres(const EngineCharacter& of);
std::optional<ReadyFormula> joint_pivots(const EngineCharacter& of);
std::optional<ReadyFormula> root_box(const EngineCharacter& of);
std::optional<ReadyFormula> union_at_keys(const EngineCharacter& of);
std::optional<ReadyFormula> union_at_30_fps(const EngineCharacter& of);
std::optional<ReadyFormula> joint_boxes_at_keys(const EngineCharacter& of);
std::optional<ReadyFormula> morph_average(const EngineCharacter& of);

/// The box of points, and that of boxes.
EngineBound box_of(std::span<const Vec3> points);
EngineBound merged(const EngineBound& a, const EngineBound& b);
/// A box that holds nothing.
EngineBound no_box();

} // namespace cinch
