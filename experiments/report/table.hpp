// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace cinch {

/// Columns of standard output where that is a terminal; else 0.
std::size_t terminal_width();

/// Right-aligned columns under a header, one blank apart. A table that is wider than `width` is cut into tables of some
/// of the columns each, all beginning with the first one; 0: no limit.
std::string table(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows,
                  std::size_t width = terminal_width());

/// Words in lines of at most `width` columns.
std::string folded(const std::string& text, std::size_t width = 80);

} // namespace cinch
