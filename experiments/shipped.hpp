// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

namespace cinch {

/// Folder of what comes with the program, "scenes" or "cases": beside an installed program, or in the source that it
/// was built from.
std::filesystem::path shipped_folder(const char* kind);

} // namespace cinch
