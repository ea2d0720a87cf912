// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/scratch_folder.hpp"

#include <cstdlib>

#include "cinch/surface.hpp"

namespace cinch {

ScratchFolder::ScratchFolder()
{
    std::string name = (std::filesystem::temp_directory_path() / "cinch-XXXXXX").string();
    if (!mkdtemp(name.data()))
        throw InputError("no temporary folder can be made; is the disk full?");
    path = name;
}

ScratchFolder::~ScratchFolder()
{
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
}

} // namespace cinch
