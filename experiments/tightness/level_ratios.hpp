// SPDX-License-Identifier: GPL-3.0-or-later
// Internal to tightness/: what is measured, and its form in a row.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "cinch/bvh.hpp"
#include "exact/verifier.hpp"

namespace cinch {

/// Sums over the BVs of one level.
struct LevelRatio {
    std::size_t bvs = 0, measured = 0;
    double sum = 0, max = 0;
    exact::Loss loss; ///< in units of the true radius; rounding counts as corner

    double mean() const;
};

/// By method, each by level.
using LevelRatios = std::map<std::string, std::vector<LevelRatio>>;

/// Of one frame and method; with a verdict also what is lost where.
std::vector<LevelRatio> level_ratios(const Bvh& bvh, std::span<const double> truth, std::span<const double> supports,
                                     const exact::FrameVerdict* verdict);

void add(const LevelRatios& more, LevelRatios& sum);

nlohmann::ordered_json to_json(const LevelRatios& ratios);
LevelRatios level_ratios_of(const nlohmann::ordered_json& json);

/// One motion and number of simulation nodes.
struct TightnessRun {
    std::string motion;
    std::size_t nodes = 0;
    std::size_t frames_done = 0, frames = 0;
    bool attributed = false; ///< to what is lost where
    LevelRatios levels;      ///< of the frames done

    bool is_complete() const { return frames_done == frames; }
};

} // namespace cinch
