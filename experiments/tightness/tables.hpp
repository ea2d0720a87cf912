// SPDX-License-Identifier: GPL-3.0-or-later
// Internal to tightness/: what people and programs read of runs.
#pragma once

#include "experiments/measure/race.hpp"
#include "experiments/report/record_output.hpp"
#include "experiments/tightness/level_ratios.hpp"

namespace cinch {

/// What was measured: under each motion with every level attributed, then the root alone against simulation nodes. As
/// far as there are frames.
struct TightnessResult {
    std::string input;
    std::vector<std::string> report, missing;
    std::string precision;
    std::size_t leaf = 1;
    std::vector<std::string> methods;
    std::vector<TightnessRun> full, sweep;
    std::size_t runs_wanted = 0, frames_wanted = 0, sweep_wanted = 0; ///< frames of all runs
    bool violated = false;

    Completeness completeness() const;
};

/// Those that this project's own targets are about.
std::vector<Figure> figures_of(const TightnessResult& result);

/// A record for each level of each run and method, then one for each figure.
std::vector<nlohmann::ordered_json> records_of(const TightnessResult& result, const std::vector<Figure>& figures);

void print_tables(const TightnessResult& result, const std::vector<Figure>& figures);

} // namespace cinch
