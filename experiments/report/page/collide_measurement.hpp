// SPDX-License-Identifier: GPL-3.0-or-later
// Internal to page/.
#pragma once

#include <string>

#include "experiments/report/collide_figures.hpp"

namespace cinch {

/// Time of a full evaluation for the vertices that `lazy` does not need, ms; unknown if it does not count them.
Traced avoided_evaluation(const CollideTimes& full, const CollideTimes& lazy);

/// Table 4 and Fig. 7: why the gain is what it is. HTML.
std::string why_gain(const Results& results, const std::string& scene, double paper_full, double paper_total,
                     double paper_gain);

} // namespace cinch
