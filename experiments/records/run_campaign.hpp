// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "experiments/records/row_folder.hpp"
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

/// Computes the cells that are not in the folder yet, in their order, with progress, and gives all rows where this run
/// was to compute all of them; nothing, and a line on standard output, where it was one shard of several. After an
/// interrupt throws Interrupted; finished cells are kept in the folder, and standard error says how to go on.
std::optional<Merged> run_campaign(const Campaign& campaign, const ShardOptions& options,
                                   const std::function<Rows(std::size_t cell)>& compute);

} // namespace cinch
