// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "experiments/report/page/html.hpp"

namespace cinch {

/// Charts of the records of one command, in the order of the records; none where there is nothing to draw. Colours,
/// axes and units are the same in a command's --plot, its --report and the page of `cinch reproduce`.
std::vector<html::ChartFigure> scaling_charts(const Results& results); ///< time against simulation nodes, by method
std::vector<html::ChartFigure>
level_charts(const Results& results); ///< tightness: mean and greatest ratio by BVH level
std::vector<html::ChartFigure>
sweep_charts(const Results& results); ///< tightness: ratio of the root against simulation nodes
std::vector<html::ChartFigure> loss_charts(const Results& results);       ///< tightness: what is lost by level, and why
std::vector<html::ChartFigure> cost_charts(const Results& results);       ///< looseness against time, by arithmetic
std::vector<html::ChartFigure> simulation_charts(const Results& results); ///< cost --simulation: error against time
std::vector<html::ChartFigure>
collide_charts(const Results& results); ///< time against pairs, by backend, a chart per scene
std::vector<html::ChartFigure> verify_charts(const Results& results); ///< ratio by BVH level

/// All of them.
std::vector<html::ChartFigure> charts_of(const Results& results);

} // namespace cinch
