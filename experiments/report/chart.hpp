// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace cinch {

/// A line of a chart.
struct Series {
    std::string name;
    std::vector<double> x, y; ///< points that are not finite are left out
    bool points_only = false;
};
struct Chart {
    std::string title, x_label, y_label;
    bool log_x = false, log_y = false;
    std::vector<Series> series;
};

/// Throws InputError if gnuplot, which draws the charts, is missing. `option`: what needs it.
void require_gnuplot(const std::string& option);

/// Charts below each other as one SVG document; at its top the note, if there is one. Throws InputError if gnuplot
/// fails.
std::string svg(const std::vector<Chart>& charts, const std::string& note = {});

} // namespace cinch
