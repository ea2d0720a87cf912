// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/table.hpp"

#include <algorithm>

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

} // namespace cinch
