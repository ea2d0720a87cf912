// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace cinch {

/// A figure that the paper prints: D. Steinemann, M. Otaduy, M. Gross, Tight and efficient surface bounds in meshless
/// animation. Times are of its 3.4 GHz Pentium 4.
struct PaperFigure {
    std::string_view place; ///< "Table 1"
    std::string_view row, column;
    double value;
    std::string_view unit; ///< empty: a ratio or a count
};

/// Throws std::out_of_range if the paper has none there.
const PaperFigure& paper_figure(std::string_view place, std::string_view row, std::string_view column);

} // namespace cinch
