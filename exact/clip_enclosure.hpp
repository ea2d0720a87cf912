// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>

#include "cinch/io.hpp"
#include "exact/motion_enclosure.hpp"

namespace cinch::exact {

/// Of a bone's transform to its parent, as the file has it.
MapEnclosure bone_enclosure(const Bone& bone);

/// A character's clip as the glTF 2.0 specification defines it from the stored numbers, in real arithmetic: T_j(t) and
/// T_j′(t), enclosed by intervals with directed rounding; the angles between keys are MPFI's. Shares no formula with
/// the toolkit: spherical interpolation is that of the specification, sin((1 − s)φ) q₀ + sin(sφ) q₁ over sin φ of unit
/// quaternions, and what is said of an interval of time comes from interval arithmetic alone.
class ClipEnclosure final : public MotionEnclosure {
public:
    /// `any_weights`: of all morph targets at all times, instead of what file and clip say.
    ClipEnclosure(const Character& character, const Character::Animation& animation,
                  std::optional<Enclosure> any_weights = {});
    ~ClipEnclosure() override;

    /// Unbounded where a quaternion may be 0.
    void at(double a_s, double b_s, double piece_a_s, double piece_b_s, std::vector<MapEnclosure>& maps,
            std::vector<MapEnclosure>& slopes) const override;
    void weights_at(double a_s, double b_s, double piece_a_s, double piece_b_s, std::vector<Enclosure>& weights,
                    std::vector<Enclosure>& slopes) const override;
    bool has_any_weights() const override;
    /// Of joints and weights.
    const std::vector<double>& keys() const override;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

} // namespace cinch::exact
