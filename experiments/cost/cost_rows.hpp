// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "experiments/cost/cost.hpp"
#include "experiments/measure/race.hpp"
#include "experiments/records/run_campaign.hpp"

namespace cinch {

/// A method in an arithmetic on the sample.
struct CostRow {
    int kdop;
    std::string method, arithmetic, guarantee;
    bool proven;
    Range ns, ratio_to_double; ///< per BV
    double looseness;
    double below, worst_below; ///< share of the supports below the exact value, and by how much at most, in widths;
                               ///< NaN: none known
    Verdict pareto = Verdict::unknown; ///< inconclusive where it rests on times whose quartiles overlap
    Load load;
    bool of_root = false; ///< of the root alone, from one bound to the true box
};

/// The rows of a cell, and back: those of a k-DOP, or the gaps of an input.
Rows rows_of(const std::vector<CostRow>& rows);
Rows rows_of(const std::vector<DualGap>& gaps);
bool is_gap(const nlohmann::ordered_json& row);
CostRow cost_row_of(const nlohmann::ordered_json& row);
DualGap gap_of(const nlohmann::ordered_json& row);

/// What `cost` prints of rows, whoever measured them.
void print_cost(const Merged& all, const OutputOptions& options, const Provenance& from,
                const Completeness& completeness);
Provenance provenance_of_cost(const Campaign& campaign);

} // namespace cinch
