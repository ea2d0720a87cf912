// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "experiments/report/number.hpp"
#include "experiments/report/page/charts.hpp"
#include "experiments/report/page/sections.hpp"

namespace cinch {
namespace {

using html::cell;
using html::escaped;
using html::figure;
using html::head_cell;

/// Last records of `cinch verify`: what was proven of all bounds.
std::vector<const Record*> totals(const Results& results)
{
    std::vector<const Record*> found;
    for (const Record* r : results.where({{"experiment", "verify"}}))
        if (r->fields.contains("bounds"))
            found.push_back(r);
    return found;
}

std::string count(const Traced& x)
{
    return figure(x, x.known() && x.value >= 0 && x.value < 1e15 ? grouped(static_cast<std::size_t>(x.value))
                                                                 : html::digits(x.value));
}

// "3", or "2 of 3" where not all were proven.
std::string frames_of(const Record& r)
{
    const Traced wanted = Results::number(r, "frames"), done = Results::number(r, "frames_done");
    return done.known() && done.value != wanted.value
               ? cell(done, fmt::format("{:.0f} of {:.0f}", done.value, wanted.value))
               : cell(wanted);
}

std::string runs(const Results& results)
{
    std::vector<std::string> rows;
    for (const Record* r : totals(results)) {
        auto number = [&](const char* field) { return Results::number(*r, field); };
        const std::string update = r->word("update");
        rows.push_back(html::row(
            {html::text_cell(r->word("input"), "l"),
             html::text_cell(update.empty() ? "all BVs, by the method" : "after a query, " + update, "l"),
             html::text_cell(r->word("method"), "l"), html::text_cell(r->word("precision"), "l"), frames_of(*r),
             html::raw_cell(count(number("bounds")), "n"), html::raw_cell(count(number("proven")), "n"),
             html::raw_cell(count(number("violated")), "n"), cell(number("seconds"))}));
    }
    if (rows.empty())
        return "";
    return html::table(
        "Every bound of every BV, direction and frame against the exactly deformed vertices, in exact arithmetic.",
        {html::row({head_cell("input"), head_cell("which"), head_cell("method"), head_cell("precision"),
                    head_cell("frames"), head_cell("bounds"), head_cell("proven"), head_cell("violated"),
                    head_cell("seconds")})},
        {html::block(rows)});
}

struct CornerSums {
    Traced cases{0, {}}, rows{0, {}}, hold{0, {}}, exact{0, {}}; ///< exact: Eq. 12 is the true maximum
};

CornerSums corner_sums(const Results& results)
{
    CornerSums sums;
    for (const Record* r : results.where({{"experiment", "corners"}})) {
        const auto rows = r->fields.find("rows");
        if (rows == r->fields.end() || !rows->is_array())
            continue;
        auto add = [&](Traced& sum, double x) { sum = sum + Traced{x, {r->at}}; };
        add(sums.cases, 1);
        for (const auto& row : *rows) {
            if (!row.is_object() || !row.contains("exact_max") || !row["exact_max"].is_string())
                continue;
            add(sums.rows, 1);
            add(sums.hold, row.contains("bound_holds") && row["bound_holds"] == true);
            add(sums.exact, row.contains("eq12") && row["eq12"] == row["exact_max"]);
        }
    }
    return sums;
}

std::string corners(const Results& results)
{
    std::vector<std::string> rows;
    for (const Record* r : results.where({{"experiment", "corners"}})) {
        const std::string counted_corners = r->word("vertex_count");
        const bool feasible = r->fields.contains("feasible") && r->fields.at("feasible") == true;
        const Traced n = Results::number(*r, "n");
        rows.push_back(html::row(
            {html::text_cell(r->word("file"), "l"), cell(n), html::text_cell(feasible ? "yes" : "no", "l"),
             html::raw_cell(figure({0, {r->at}}, counted_corners.empty() ? "not counted" : counted_corners), "n"),
             html::raw_cell(n.known() ? figure(n * (n - Traced{1, {}})) : "–", "n")}));
    }
    if (rows.empty())
        return "";
    const CornerSums sums = corner_sums(results);
    return "<h3>True corners</h3>\n" +
           html::paragraph(fmt::format("Of {} maxima over the exact corners of {} weight spaces the toolkit’s bound "
                                       "holds for {}; Eq. 12 is the exact maximum for {}, and above it for the others.",
                                       figure(sums.rows), figure(sums.cases), figure(sums.hold), figure(sums.exact))) +
           html::table("Corners of the limited convex weight space, counted exactly, beside the n(n − 1) that the "
                       "paper chooses from. Not feasible: no weights within the intervals sum to 1, so there are none.",
                       {html::row({head_cell("case"), head_cell("n"), head_cell("feasible"), head_cell("corners"),
                                   head_cell("n(n − 1)")})},
                       {html::block(rows)});
}

} // namespace

Section proof_section(const Results& results)
{
    Section section{"proof", "Proof: every bound, in exact arithmetic", runs(results) + corners(results), {}};
    if (section.body.empty())
        return section;
    Traced bounds{0, {}}, proven{0, {}};
    bool refits = false, lazy = false;
    for (const Record* r : totals(results)) {
        (r->word("update").empty() ? refits : lazy) = true;
        bounds = bounds + Results::number(*r, "bounds");
        proven = proven + Results::number(*r, "proven");
    }
    const bool any = bounds.known() && bounds.value > 0;
    section.claims.push_back({"The bounds are conservative: no vertex is ever outside.",
                              "Appendix A",
                              {{"conservative", !any                           ? Verdict::unknown
                                                : bounds.value == proven.value ? Verdict::holds
                                                                               : Verdict::fails}},
                              any ? fmt::format("{} of {} bounds of this program are proven in exact arithmetic, {}.",
                                                count(proven), count(bounds),
                                                refits && lazy ? "of refits and of those that collision detection reads"
                                                : lazy         ? "of those that collision detection reads"
                                                               : "of refits")
                                  : ""});
    const CornerSums sums = corner_sums(results);
    if (sums.rows.value > 0)
        section.claims.push_back(
            {"Eq. 12 is the extreme corner of the limited convex weight space.",
             "Section 5.2",
             {{"eq12-exact", sums.exact.value == sums.rows.value ? Verdict::holds : Verdict::fails}},
             fmt::format(
                 "It is the exact maximum in {} of {} reference cases. In the others it is above: more than two "
                 "weights lie off their minimum at the true corner, which Eq. 12’s one maximal weight does not "
                 "reach. By weak duality it is a bound in all.",
                 figure(sums.exact), figure(sums.rows))});
    for (const html::ChartFigure& chart : verify_charts(results))
        section.body += html::chart(chart);
    return section;
}

} // namespace cinch
