// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>

#include <fmt/format.h>

#include "experiments/report/page/charts.hpp"
#include "experiments/report/page/sections.hpp"

namespace cinch {
namespace {

using html::cell;
using html::figure;
using html::head_cell;

constexpr int kdop = 6;

Traced number(const Results& results, const std::string& method, const char* arithmetic, const char* field)
{
    return results.number({{"experiment", "cost"}, {"method", method}, {"arithmetic", arithmetic}, {"kdop", kdop}},
                          field);
}

std::string methods(const Results& results)
{
    std::vector<std::string> rows;
    for (const char* method : {"convex", "eq12", "limited", "local", "support", "linear", "best"}) {
        if (!number(results, method, "double kernel", "ns_per_bound").known())
            continue;
        rows.push_back(html::row({html::text_cell(method, "l"),
                                  cell(number(results, method, "double kernel, proven", "mean_ratio")),
                                  cell(number(results, method, "double kernel", "ns_per_bound")),
                                  cell(number(results, method, "double kernel, proven", "ns_per_bound")),
                                  cell(number(results, method, "float kernel, proven", "ns_per_bound")),
                                  cell(number(results, method, "float kernel, proven", "mean_ratio"))}));
    }
    if (rows.empty())
        return "";
    return html::table(
        "What tightness costs: looseness (bound radius over true radius, mean over one BV of each level) and ns per BV "
        "for six directions, by SIMD on one core.",
        {html::row({head_cell("method"), head_cell("looseness"), head_cell("double"), head_cell("double, proven"),
                    head_cell("float, proven"), head_cell("looseness in float")})},
        {html::block(rows)});
}

std::string arithmetics(const Results& results)
{
    constexpr std::array names{"double",     "double, proven", "double kernel, proven", "float kernel, proven",
                               "interval",   "double-double",  "int128 grid",           "MPFR 128",
                               "lazy exact", "rational"};
    const Traced plain = number(results, "eq12", "double", "ns_per_bound");
    std::vector<std::string> rows;
    for (const char* name : names) {
        const Traced ns = number(results, "eq12", name, "ns_per_bound");
        if (!ns.known())
            continue;
        const auto found =
            results.where({{"experiment", "cost"}, {"method", "eq12"}, {"arithmetic", name}, {"kdop", kdop}});
        const Traced below = number(results, "eq12", name, "below_exact");
        rows.push_back(html::row({html::text_cell(name, "l"), cell(ns), cell(ns / plain),
                                  cell(below, below.value > 0 ? fmt::format("{:.0f} %", 100 * below.value) : "0"),
                                  html::text_cell(found.front()->word("guarantee"), "l")}));
    }
    if (rows.empty())
        return "";
    return html::table("What a guarantee costs: Eq. 12 in every arithmetic. Below: bounds that lie below the exact "
                       "optimum, so that a vertex may stick out.",
                       {html::row({head_cell("arithmetic"), head_cell("ns per BV"), head_cell("/ plain double"),
                                   head_cell("below"), head_cell("guarantee")})},
                       {html::block(rows)});
}

} // namespace

Section cost_section(const Results& results)
{
    Section section{"cost", "Accuracy and cost", methods(results) + arithmetics(results), {}};
    if (!section.body.empty()) {
        const Traced below = number(results, "eq12", "double", "below_exact"),
                     proven_below = number(results, "eq12", "double, proven", "below_exact"),
                     price = number(results, "eq12", "double, proven", "ns_per_bound") /
                             number(results, "eq12", "double", "ns_per_bound");
        const Traced gives_away = number(results, "eq12", "double kernel, proven", "mean_ratio") - Traced{1, {}},
                     best_gives_away = number(results, "best", "double kernel, proven", "mean_ratio") - Traced{1, {}},
                     times = number(results, "best", "double kernel, proven", "ns_per_bound") /
                             number(results, "eq12", "double kernel, proven", "ns_per_bound");
        if (best_gives_away.known())
            section.body = html::paragraph(fmt::format("The default, also linear in the simulation nodes, gives away "
                                                       "{} times less of the radius than Eq. 12, in {} times its time.",
                                                       figure(gives_away / best_gives_away), figure(times))) +
                           section.body;
        if (below.known() && proven_below.known())
            section.body = html::paragraph(fmt::format(
                               "In plain double arithmetic {} of Eq. 12’s bounds lie below their exact value; with the "
                               "error term of the proof {} do, for {} times the time. Exact rationals take {} times.",
                               html::percent(below),
                               proven_below.value > 0 ? html::percent(proven_below) : figure(proven_below, "none"),
                               figure(price), figure(number(results, "eq12", "rational", "ratio_to_double")))) +
                           section.body;
    }
    for (const auto& charts : {cost_charts(results), simulation_charts(results)})
        for (const html::ChartFigure& chart : charts)
            section.body += html::chart(chart);
    return section;
}

} // namespace cinch
