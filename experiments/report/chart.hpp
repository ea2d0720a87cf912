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
    std::vector<double> low, high; ///< of a band around the line; empty: none
};
struct Chart {
    std::string title, x_label, y_label;
    bool log_x = false, log_y = false;
    std::vector<Series> series;
};

/// Throws InputError if gnuplot, which draws the charts, is missing. `option`: what needs it.
void require_gnuplot(const std::string& option);

/// What a picture is stored as.
enum class Picture { svg, pdf, png };

/// By the end of the file's name. Throws InputError for any other.
Picture picture_of(const std::string& file);

/// A chart; at its top the note, if there is one. Throws InputError if gnuplot fails.
std::string drawn(const Chart& chart, Picture as, const std::string& note = {});

/// The points of charts as comma-separated values: chart, series, x, y, and the band where there is one.
std::string data_of(const std::vector<Chart>& charts);

} // namespace cinch
