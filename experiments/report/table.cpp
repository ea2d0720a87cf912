// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/table.hpp"

#include <algorithm>
#include <sstream>

namespace cinch {

std::string table(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows)
{
    std::vector<std::size_t> width;
    for (const std::string& cell : header)
        width.push_back(cell.size());
    for (const auto& row : rows)
        for (std::size_t c = 0; c < row.size(); ++c)
            width[c] = std::max(width[c], row[c].size());
    std::string out;
    auto add = [&](const std::vector<std::string>& row) {
        for (std::size_t c = 0; c < row.size(); ++c)
            out += std::string(c == 0 ? 0 : 1, ' ') + std::string(width[c] - row[c].size(), ' ') + row[c];
        out += '\n';
    };
    add(header);
    for (const auto& row : rows)
        add(row);
    return out;
}

std::string folded(const std::string& text, std::size_t width)
{
    std::string out, word;
    std::size_t column = 0;
    for (std::istringstream words(text); words >> word;) {
        const bool fits = column == 0 || column + 1 + word.size() <= width;
        out += column == 0 ? "" : fits ? " " : "\n";
        column = column == 0 || !fits ? word.size() : column + 1 + word.size();
        out += word;
    }
    return out;
}

} // namespace cinch
