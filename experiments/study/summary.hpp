// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "experiments/records/row_folder.hpp"
#include "experiments/report/chart.hpp"

namespace cinch {

/// Of several values of one thing.
struct Spread {
    std::size_t count = 0;
    double mean = 0;
    double half_width = 0; ///< of the 95 % confidence interval of the mean, by Student's t; 0 for a single value
    double least = 0, lower = 0, median = 0, upper = 0, greatest = 0; ///< quartiles, between values linearly
};
Spread spread_of(std::vector<double> values);

/// A row for each key of the runs' rows without its seed: means over seeds with their confidence, and quartiles, of the
/// root's ratio, then the means of the others.
std::string study_table(const Merged& all);

/// The root's ratio against simulation nodes, mean over seeds with its confidence as a band, a line for each of the
/// other keys; none where there are not several numbers of simulation nodes.
std::vector<Chart> study_charts(const Merged& all);

} // namespace cinch
