// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

namespace cinch {

/// A folder of its own for files between two programs, gone at the end with all that is in it.
struct ScratchFolder {
    ScratchFolder(); ///< Throws InputError where none can be made.
    ~ScratchFolder();
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;

    std::filesystem::path path;
};

} // namespace cinch
