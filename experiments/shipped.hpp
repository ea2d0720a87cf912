// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace cinch {

/// Folder of what comes with the program, "scenes" or "cases": beside an installed program, or in the source that it
/// was built from.
std::filesystem::path shipped_folder(const char* kind);

/// Names of the scenes that come with the program.
std::vector<std::string> shipped_scenes();
/// One of them, or a .json file.
bool is_scene(const std::string& name_or_file);

} // namespace cinch
