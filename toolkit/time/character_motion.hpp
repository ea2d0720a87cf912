// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cinch/io.hpp"
#include "toolkit/time/engine.hpp"
#include "toolkit/time/motion_interval.hpp"

namespace cinch {

/// A clip of a character: T_j(t) = G_j(t) B_j, the joint's bone in the world times its inverse bind, every curve as the
/// glTF specification interpolates it between the keys that the file stores. Outside of its keys a curve is constant.
/// Has a copy of what it needs. at() throws InputError where a map overflows. Throws InputError for a fault of the
/// clip. What `engine` renders stays within the limits' `error` too.
TimedMotion character_motion(const Character& character, const Character::Animation& animation,
                             const DeformableSurface& surface, const Engine& engine = {});

} // namespace cinch
