// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "cinch/refit.hpp"
#include "experiments/input.hpp"
#include "experiments/measure/race.hpp"

namespace cinch {

/// What `cinch scaling` times, in the order of its table: the textbook's Eq. 12, every method, the default without its
/// error terms ("unproven"), the optimal AABB.
const std::vector<std::string>& scaling_contestants();

struct ContestantTimes {
    RaceTimes race;        ///< by contestant
    double project_ns = 0; ///< of projecting all transforms, once per frame
    std::string kind;      ///< what the default chose for the surface
};

/// One bound of the whole surface (six directions) in the input's last frame, by all in turn, about so many seconds.
ContestantTimes time_contestants(const Input& input, Precision precision, int passes, double seconds);

} // namespace cinch
