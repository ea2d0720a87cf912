// SPDX-License-Identifier: GPL-3.0-or-later
// Internal to page/: the times of one backend on one scene.
#pragma once

#include <string>

#include "experiments/report/results.hpp"

namespace cinch {

/// Per frame, in ms. All unknown if the backend did not run on the scene.
struct CollideTimes {
    Traced evaluate, refit, query, total; ///< refit: the evaluation of vertices included
    Traced vertices;                      ///< evaluated on demand, mean
    Traced all_vertices;                  ///< of all bodies

    bool known() const { return total.known() && total.value > 0; }
};
CollideTimes collide_times(const Results& results, const std::string& scene, const char* backend);

/// Time of a full evaluation for the vertices that `lazy` does not need, ms; unknown if it does not count them.
Traced avoided_evaluation(const CollideTimes& full, const CollideTimes& lazy);

/// "santa-ring-3", from its number in Table 2.
std::string ring_scene(int number);

/// Table 4 and Fig. 7: why the gain is what it is. HTML.
std::string why_gain(const Results& results, const std::string& scene, double paper_full, double paper_total,
                     double paper_gain);

} // namespace cinch
