// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "experiments/input.hpp"

namespace cinch {

/// Simulates a scene and keeps `frames` of its frames, the rest pose not among them, and the last one included. Throws
/// InputError; options that do not apply to scenes are not looked at.
Inputs load_scene(const InputOptions& options);

} // namespace cinch
