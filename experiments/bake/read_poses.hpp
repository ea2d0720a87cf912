// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "cinch/io.hpp"
#include "toolkit/time/pose_limits.hpp"

namespace cinch {

/// Limits of a character's bones from a JSON file, and the poses in their middle, in which it puts the bones. Throws
/// InputError, which names file and field.
///
///   {"bones": {"Head": {"degrees": 40},
///              "Knee": {"axis": [1, 0, 0], "degrees": [0, 130]},
///              "Hips": {"degrees": 180, "move": 0.5}},
///    "others": {"degrees": 5}}
///
/// degrees: from the file's pose about any axis, or from one angle to another about an axis in the bone's own frame.
/// move: of the joint, in the file's unit. Bones that are not named have the limits of "others", or none at all.
std::vector<PoseLimit> read_poses(const std::string& file, Character& character);

} // namespace cinch
