// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "experiments/bake/baked_clip.hpp"
#include "experiments/bake/prove.hpp"
#include "experiments/records/row_folder.hpp"

namespace cinch {

/// A clip as it was baked: what the rows of its cell hold.
struct BakedClip {
    std::string name;
    double first_s = 0, last_s = 0;
    std::vector<BakedInterval> intervals; ///< with the supports of the BVs that are written
    std::optional<exact::TimeVerdict> verdict;
    std::string worst; ///< worst_line of the verdict
    std::optional<BakedFigures> figures;
    std::optional<IntervalCost> cost; ///< which is measured once per body
};

/// One row for the clip, and one per interval. Infinite supports are null.
Rows rows_of(const BakedClip& clip);
BakedClip baked_clip_of(const Rows& rows);

/// Of the clips that are there; and the exit status that goes with it: 0 where all is proven, else 1.
exact::TimeVerdict verdict_of_clips(const Merged& all);
int status_of(const exact::TimeVerdict& verdict);

/// A body of the plan of a run.
struct BakedBody {
    std::string name;
    std::vector<std::string> report, missing;
    nlohmann::ordered_json fields;     ///< of every record
    std::vector<std::uint32_t> levels; ///< where they begin, as in Bvh
    std::size_t written = 0;           ///< BVs
    std::size_t clips = 0;             ///< cells
};
nlohmann::ordered_json to_json(const BakedBody& body);
/// The beginning of a plan: its bodies, each with what is said of it, and a checksum of all that moves them.
nlohmann::ordered_json plan_of_bodies(const std::vector<TimedBody>& bodies, const std::vector<BakedBody>& said);
BakedBody baked_body_of(const nlohmann::ordered_json& from);

} // namespace cinch
