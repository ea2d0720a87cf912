// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "experiments/report/results.hpp"

namespace cinch {

/// What records of `cinch collide` say of one backend on one scene, per frame, ms: whoever shows a figure of it, on a
/// terminal or a page, has it from here. All unknown if the backend has not been through all frames.
struct CollideTimes {
    Traced evaluate, refit, query, total; ///< refit: the evaluation of vertices included
    Traced gain;                          ///< over the full update with one triangle per leaf (refit-1)
    Traced vertices;                      ///< evaluated on demand, mean
    Traced all_vertices;                  ///< of all bodies

    bool known() const { return total.known() && total.value > 0; }
};
CollideTimes collide_times(const Results& results, const std::string& scene, const char* backend, bool cold = false);

/// "santa-ring-3", from its number in Table 2.
std::string ring_scene(int number);
/// The number in Table 2, 1 to 8; 0 for other scenes.
int ring_of(const std::string& scene);
/// The row of Table 3, which has one for two scenes: they differ in simulation nodes only.
std::string row_of_table_3(int ring);

} // namespace cinch
