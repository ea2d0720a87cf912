// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/shipped.hpp"

namespace cinch {

namespace fs = std::filesystem;

fs::path shipped_folder(const char* kind)
{
    std::error_code error;
    const fs::path installed =
        fs::read_symlink("/proc/self/exe", error).parent_path().parent_path() / "share/cinch" / kind;
    return !error && fs::is_directory(installed, error) ? installed : fs::path(CINCH_DATA) / kind;
}

} // namespace cinch
