// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/audit/audit_rows.hpp"

#include <cmath>

#include "experiments/records/json_number.hpp"

namespace cinch {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const Counterexample& c)
{
    Json place = Json::array();
    for (const exact::Enclosure& x : c.place)
        place.push_back({or_null(x.low), or_null(x.high)});
    return {{"time_s", c.time_s},
            {"vertex", c.vertex},
            {"direction", c.direction},
            {"bound", or_null(c.bound)},
            {"centre", {or_null(c.centre[0]), or_null(c.centre[1]), or_null(c.centre[2])}},
            {"place", place},
            {"beyond", or_null(c.beyond)}};
}

Counterexample counterexample_of(const Json& c)
{
    Counterexample out{
        c.at("time_s"), c.at("vertex"), c.at("direction"), number_or(c.at("bound"), HUGE_VAL), {}, {}, {}};
    for (int r = 0; r < 3; ++r) {
        const auto i = static_cast<std::size_t>(r);
        out.centre[r] = number_or(c.at("centre")[i], HUGE_VAL);
        out.place[i] = {number_or(c.at("place")[i][0], -HUGE_VAL), number_or(c.at("place")[i][1], HUGE_VAL)};
    }
    out.beyond = number_or(c.at("beyond"), HUGE_VAL);
    return out;
}

} // namespace

Rows rows_of(const std::vector<AuditedFormula>& formulas, const std::string& clip)
{
    Rows rows;
    for (const AuditedFormula& f : formulas) {
        Json row{{"clip", clip},
                 {"formula", f.formula},
                 {"used_by", f.used_by},
                 {"still", f.still},
                 {"verdict", static_cast<int>(f.verdict)},
                 {"instants", f.instants},
                 {"worst_share", or_null(f.worst_share)},
                 {"mean_ratio", or_null(f.mean_ratio)},
                 {"max_ratio", or_null(f.max_ratio)}};
        if (f.worst)
            row["worst"] = to_json(*f.worst);
        if (f.ns)
            row["ns"] = {f.ns->value, f.ns->low, f.ns->high};
        rows.push_back(std::move(row));
    }
    return rows;
}

AuditedFormula audited_formula_of(const Json& row)
{
    AuditedFormula out{row.at("formula"),
                       row.at("used_by"),
                       row.at("still"),
                       static_cast<AuditVerdict>(row.at("verdict").get<int>()),
                       row.at("instants"),
                       {},
                       number_or(row.at("worst_share"), HUGE_VAL),
                       number_or(row.at("mean_ratio"), HUGE_VAL),
                       number_or(row.at("max_ratio"), HUGE_VAL),
                       {}};
    if (row.contains("worst"))
        out.worst = counterexample_of(row.at("worst"));
    if (row.contains("ns"))
        out.ns = Range(row.at("ns")[0], row.at("ns")[1], row.at("ns")[2]);
    return out;
}

} // namespace cinch
