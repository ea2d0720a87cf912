// SPDX-License-Identifier: GPL-3.0-or-later
// Internal to collide/: what people read.
#pragma once

#include <nlohmann/json.hpp>

#include "experiments/collide/measure.hpp"
#include "experiments/measure/race.hpp"
#include "experiments/report/results.hpp"

namespace cinch {

/// What was measured on one scene.
struct SceneResult {
    std::string scene;
    std::size_t bodies = 0, vertices = 0, nodes = 0; ///< of each body
    std::vector<Measured> backends;
    std::size_t backends_wanted = 0; ///< more than there are after an interrupt

    bool is_complete() const;
    /// The backend's, if it has been through all frames: others do not compare.
    const Measured* of(const std::string& backend) const;
};

/// Ratios against baselines, with their targets.
std::vector<Figure> figures_of(const std::vector<SceneResult>& results, bool cold);

/// How the default's time grows with bodies, vertices, nodes and contacts.
struct Slope {
    std::string what;
    double exponent;
};
std::vector<Slope> slopes_of(const std::vector<SceneResult>& results);

/// Tables 2 to 4 and Fig. 7 beside the paper's figures, every backend, counts, figures, slopes. `records`: of the same.
void print_tables(const std::vector<SceneResult>& results, const Results& records, bool cold);

} // namespace cinch
