// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace cinch {

/// Right-aligned columns under a header, one blank apart.
std::string table(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows);

/// Words in lines of at most `width` columns.
std::string folded(const std::string& text, std::size_t width = 80);

} // namespace cinch
