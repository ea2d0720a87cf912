// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "toolkit/surface/skin.hpp"

namespace cinch {

/// A scripted motion of space for surfaces centred at the origin with a longest half-extent of 1.2, applied in this
/// order: twist about z by 1.2·twist·z; bend about y with φ = 0.9·bend·x; pull by 0.8·pull·exp(−4·|p − (1.2, 0,
/// 0)|²)·(0.6, 0.8, 0.3); rotation by `rotate` radians about (1, 1, 0.5).
struct Motion {
    double twist = 0, bend = 0, pull = 0, rotate = 0;
};

/// strong: amplitudes 1, no rotation. mild: amplitudes 0.3, rotation 0.7. Or one ingredient at amplitude 1.
std::optional<Motion> named_motion(std::string_view name);
inline constexpr std::string_view motion_names = "strong, mild, twist, bend, pull, rotate";

/// Value and Jacobian of the motion at p as the affine map x ↦ J (x − p) + value: the T_j of a simulation node at p.
AffineMap linearise(const Motion& motion, const Vec3& p);

/// `frames` ≥ 1 frames growing linearly from rest to the full motion in the last; a single frame has the full motion.
/// Time runs from 0 to 1 s.
Clip scripted_clip(const Motion& motion, std::span<const Vec3> nodes, std::size_t frames);

} // namespace cinch
