// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "experiments/report/provenance.hpp"

namespace cinch {

/// What the measuring commands print besides their table.
struct OutputOptions {
    bool json = false, csv = false; ///< records on standard output and nothing else
    std::string plot;               ///< SVG file to draw; empty: none
};

/// Records (JSON objects with the same fields) as JSON Lines, the provenance in each, or as CSV with a header.
void print_records(const std::vector<nlohmann::ordered_json>& records, const OutputOptions& options, const Provenance& from);

/// A line of a chart.
struct Series {
    std::string name;
    std::vector<double> x, y;
    bool points_only = false;
};
struct Chart {
    std::string title, x_label, y_label;
    bool log_x = false, log_y = false;
    std::vector<Series> series;
};
/// To be called before measuring: throws InputError if gnuplot is missing or the file cannot be written. Nothing for an empty name.
void require_plottable(const std::string& file);
/// Draws charts below each other as one SVG file, by gnuplot. Throws InputError where that fails.
void plot(const std::vector<Chart>& charts, const std::string& file);

} // namespace cinch
