// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

namespace cinch {

/// guard_input() for a mesh or character, and for the files that a .gltf names: its buffers and images.
void guard_surface(const std::filesystem::path& file);

} // namespace cinch
