// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/shipped.hpp"

#include <algorithm>

namespace cinch {

namespace fs = std::filesystem;

fs::path shipped_folder(const char* kind)
{
    std::error_code error;
    const fs::path installed =
        fs::read_symlink("/proc/self/exe", error).parent_path().parent_path() / "share/cinch" / kind;
    return !error && fs::is_directory(installed, error) ? installed : fs::path(CINCH_DATA) / kind;
}

std::vector<std::string> shipped_scenes()
{
    std::vector<std::string> names;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(shipped_folder("scenes"), error))
        if (entry.path().extension() == ".json" && entry.path().stem() != "schema")
            names.push_back(entry.path().stem().string());
    std::sort(names.begin(), names.end());
    return names;
}

bool is_scene(const std::string& name)
{
    if (fs::path(name).extension() == ".json")
        return true;
    const auto known = shipped_scenes();
    return std::find(known.begin(), known.end(), name) != known.end();
}

} // namespace cinch
