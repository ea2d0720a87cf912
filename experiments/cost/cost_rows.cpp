// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/cost/cost_rows.hpp"

#include <cmath>

#include "experiments/records/json_number.hpp"

namespace cinch {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const Range& range) { return {or_null(range.value), or_null(range.low), or_null(range.high)}; }
Range range_of(const Json& x) { return {number_or(x[0], NAN), number_or(x[1], NAN), number_or(x[2], NAN)}; }

} // namespace

Rows rows_of(const std::vector<CostRow>& rows)
{
    Rows out;
    for (const CostRow& r : rows)
        out.push_back({{"kdop", r.kdop},
                       {"method", r.method},
                       {"arithmetic", r.arithmetic},
                       {"guarantee", r.guarantee},
                       {"proven", r.proven},
                       {"ns", to_json(r.ns)},
                       {"ratio_to_double", to_json(r.ratio_to_double)},
                       {"looseness", or_null(r.looseness)},
                       {"below", or_null(r.below)},
                       {"worst_below", or_null(r.worst_below)},
                       {"pareto", static_cast<int>(r.pareto)},
                       {"cpu_share", r.load.cpu_share},
                       {"load", r.load.load},
                       {"of_root", r.of_root}});
    return out;
}

CostRow cost_row_of(const Json& row)
{
    CostRow out{row.at("kdop"),
                row.at("method"),
                row.at("arithmetic"),
                row.at("guarantee"),
                row.at("proven"),
                range_of(row.at("ns")),
                range_of(row.at("ratio_to_double")),
                number_or(row.at("looseness"), NAN),
                number_or(row.at("below"), NAN),
                number_or(row.at("worst_below"), NAN),
                static_cast<Verdict>(row.at("pareto").get<int>()),
                {}};
    out.load = {row.at("cpu_share"), row.at("load")};
    out.of_root = row.at("of_root");
    return out;
}

Rows rows_of(const std::vector<DualGap>& gaps)
{
    Rows out;
    for (const DualGap& gap : gaps)
        out.push_back({{"gap_of", gap.input},
                       {"method", name_of(gap.method)},
                       {"least_n", gap.least_n},
                       {"most_n", gap.most_n},
                       {"bounds", gap.bounds},
                       {"gap", gap.gap},
                       {"frames", gap.frames}});
    return out;
}

bool is_gap(const Json& row) { return row.contains("gap_of"); }

DualGap gap_of(const Json& row)
{
    DualGap gap{row.at("gap_of"),  *named_method(row.at("method").get<std::string>()),
                row.at("least_n"), row.at("most_n"),
                row.at("bounds"),  {},
                row.at("frames")};
    for (std::size_t passes = 0; passes < 5; ++passes)
        gap.gap[passes] = row.at("gap")[passes];
    return gap;
}

} // namespace cinch
