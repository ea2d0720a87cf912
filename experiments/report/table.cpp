// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/table.hpp"

#include <algorithm>
#include <sstream>

#include <sys/ioctl.h>
#include <unistd.h>

namespace cinch {

std::size_t terminal_width()
{
    winsize size{};
    return isatty(STDOUT_FILENO) == 1 && ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}

std::string table(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows,
                  std::size_t width)
{
    std::vector<std::size_t> widest;
    for (const std::string& cell : header)
        widest.push_back(cell.size());
    for (const auto& row : rows)
        for (std::size_t c = 0; c < row.size(); ++c)
            widest[c] = std::max(widest[c], row[c].size());
    std::string out;
    auto add = [&](const std::vector<std::string>& row, std::size_t first, std::size_t last) {
        for (std::size_t c = 0; c < std::min(last, row.size()); c = c == 0 ? first : c + 1)
            out += std::string(c == 0 ? 0 : 1, ' ') + std::string(widest[c] - row[c].size(), ' ') + row[c];
        out += '\n';
    };
    std::size_t first = 1;
    do {
        std::size_t last = first, all = widest.empty() ? 0 : widest[0];
        for (; last < header.size() && (last == first || width == 0 || all + 1 + widest[last] <= width); ++last)
            all += 1 + widest[last];
        out += first == 1 ? "" : "\n";
        add(header, first, last);
        for (const auto& row : rows)
            add(row, first, last);
        first = last;
    } while (first < header.size());
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
