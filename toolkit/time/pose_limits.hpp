// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cinch/io.hpp"
#include "toolkit/time/motion_interval.hpp"

namespace cinch {

/// How far a bone may be from where the character's file has it, whatever the others do.
struct PoseLimit {
    double angle = 0; ///< of a rotation about any axis through its joint, rad; from π on any rotation
    double move = 0;  ///< of its joint in its parent's frame, in the file's unit
};

/// The pose of the file as a clip of one instant that stands for every pose within the limits, one per bone: vertices
/// of joint j are off by at most `error`_j of its limits.
///
/// In the frame of a bone let x be a point of j's, |x − c| ≤ ρ, δ how far it may be off so far. Its parent sees it at
/// t + M x; with t' and E M, |t' − t| ≤ move and E a rotation by at most `angle`, a point that is off by δ is off by
///   |t' − t| + |E M (x' − x)| + |(E − 1) M x| ≤ move + ‖M‖ δ + 2 sin(angle/2) (|M c| + ‖M‖ ρ).
TimedMotion poses_within(const Character& character, std::span<const PoseLimit> limits,
                         const DeformableSurface& surface);

} // namespace cinch
