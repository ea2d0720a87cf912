// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

#include "experiments/records/row_folder.hpp"
#include "experiments/report/interrupt.hpp"
#include "experiments/report/record_output.hpp"

namespace cinch {

/// Where the rows of a run go, and which of them it computes. Options of every command that runs in cells.
struct ShardOptions {
    std::string folder; ///< --out; empty: rows are kept in memory alone
    std::string shard;  ///< --shard; empty: all
};

/// A campaign of this program.
Campaign campaign_of(std::string command, nlohmann::ordered_json plan, std::size_t cells);

/// Where merged rows come from, as records say it: no machine, as rows are the same on all.
Provenance provenance_of(const Campaign& campaign);

/// Thrown by what computes a cell where an interrupt left a part of it that is worth printing. It is not kept.
struct CutShort : Interrupted {
    Rows rows;
};

/// What a run computed or found in its folder. It ends before all that it wanted only by an interrupt.
struct CampaignRun {
    Merged all; ///< cells that are not there have no rows
    Shard shard;
    std::size_t done = 0, wanted = 0; ///< cells of the shard

    bool is_whole() const { return done == wanted; }
    /// Of what it prints, and "" or why it is not whole.
    Completeness completeness() const;
};

/// Computes the cells that are not in the folder yet, in their order, with progress. Throws Interrupted if there is no
/// cell at the end, nor a part of one.
CampaignRun run_campaign(const Campaign& campaign, const ShardOptions& options,
                         const std::function<Rows(std::size_t cell)>& compute);

/// The end of a run: where it was one shard of several, a line that says how far it came, instead of `print`. Returns
/// the exit status: `verdict` if that is not 0, else 130 after an interrupt.
int end_run(const CampaignRun& run, const ShardOptions& options, int verdict, const std::function<void()>& print);

} // namespace cinch
