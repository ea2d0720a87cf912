// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "experiments/cost/cost_rows.hpp"
#include "experiments/records/json_number.hpp"
#include "experiments/report/interrupt.hpp"
#include "experiments/report/number.hpp"
#include "experiments/report/table.hpp"

namespace cinch {
namespace {

using Json = nlohmann::ordered_json;

std::string range_of(const DualGap& gap)
{
    if (gap.least_n == 1 && gap.most_n > 1000)
        return "all";
    return gap.most_n > 1000 ? fmt::format("> {}", gap.least_n - 1) : fmt::format("{} - {}", gap.least_n, gap.most_n);
}

std::vector<Figure> figures_of(const std::vector<DualGap>& gaps)
{
    std::vector<Figure> figures;
    for (const DualGap& gap : gaps)
        if (gap.method == Method::best && range_of(gap) == "all" &&
            (gap.input == "brain" || gap.input == "santa" || gap.input == "fish")) // the targets are about these
            figures.push_back({fmt::format("{}: mean gap of 'best' after 1 pass, %", gap.input),
                               fmt::format("{:.3f}", gap.gap[1]), "< 1", gap.gap[1] < 1});
    return figures;
}

void print_tables(const Json& plan, std::size_t bvs, const std::vector<CostRow>& rows, const std::vector<DualGap>& gaps,
                  const Load& load)
{
    for (const Json& line : plan.at("report"))
        fmt::print("{}\n", line.get<std::string>());
    fmt::print("one BV of each of {} levels, last frame; one core{}\n", bvs, plan.at("mark").get<std::string>());
    for (std::size_t first = 0; first < rows.size();) {
        const int kdop = rows[first].kdop;
        std::vector<std::vector<std::string>> lines, of_root;
        for (; first < rows.size() && rows[first].kdop == kdop; ++first) {
            const CostRow& r = rows[first];
            const std::string ns = grouped(static_cast<std::size_t>(r.ns.value + 0.5)),
                              opt = r.pareto == Verdict::holds   ? "*"
                                    : r.pareto == Verdict::fails ? ""
                                                                 : "?";
            if (r.of_root)
                of_root.push_back(
                    {r.method, r.arithmetic, ns + mark(r.ns), fmt::format("{:.4f}", r.looseness), r.guarantee, opt});
            else
                lines.push_back({r.method, r.arithmetic, ns,
                                 fmt::format("{:.2f}{}", r.ratio_to_double.value, mark(r.ratio_to_double)),
                                 fmt::format("{:.4f}", r.looseness),
                                 r.below > 0 ? fmt::format("{:.0f} %", 100 * r.below) : "0",
                                 r.worst_below > 0 ? fmt::format("{:.0e}", r.worst_below) : "-", r.guarantee, opt});
        }
        fmt::print("\n{}-DOP\n\n{}\nthe root alone, from one bound to the true box\n\n{}", kdop,
                   table({"method", "arithmetic", "ns", "/ double", "ratio", "below", "worst", "proof", "opt"}, lines),
                   table({"method", "until", "ns", "ratio", "proof", "opt"}, of_root));
    }
    fmt::print("\nns: per BV, all k directions. / double: over plain double of the same method.\n"
               "ratio: bound radius / true radius, mean. below, worst: how often, and by how much of\n"
               "the width at most, a support fell below the exact value of its method (for local,\n"
               "support, linear and best: below the vertices). proof: proven, exact, none, or\n"
               "the error to expect. opt: Pareto-optimal, nothing else is as fast, as tight and as\n"
               "well proven; ? where quartiles of times overlap. interval: directed rounding.\n"
               "rational: the exact value, rounded up. anytime: branch and bound down the tree until so\n"
               "much time is over, or the bound is so near to a vertex, in widths.\n{}\n\n"
               "how far the dual evaluation is from the optimum, per cent of the bound's width\n\n",
               describe(load));
    std::vector<std::vector<std::string>> lines;
    for (const DualGap& gap : gaps) {
        std::vector<std::string> line{gap.input, std::string(name_of(gap.method)), range_of(gap), grouped(gap.bounds)};
        for (const double g : gap.gap)
            line.push_back(fmt::format("{:.3f}", g));
        lines.push_back(line);
    }
    fmt::print("{}\n", table({"input", "method", "n", "bounds", "0 passes", "1", "2", "3", "4"}, lines));
}

Rows records_of(const Json& plan, const std::vector<CostRow>& rows, const std::vector<DualGap>& gaps, const Load& load)
{
    Rows records;
    for (const CostRow& r : rows) {
        records.push_back({{"experiment", "cost"},
                           {"input", plan.at("input")},
                           {"method", r.method},
                           {"arithmetic", r.arithmetic},
                           {"kdop", r.kdop},
                           {"ns_per_bound", r.ns.value},
                           {"ns_per_bound_low", r.ns.low},
                           {"ns_per_bound_high", r.ns.high},
                           {"ratio_to_double", or_null(r.ratio_to_double.value)},
                           {"ratio_to_double_low", or_null(r.ratio_to_double.low)},
                           {"ratio_to_double_high", or_null(r.ratio_to_double.high)},
                           {"settled", (r.of_root ? r.ns : r.ratio_to_double).is_settled()},
                           {"cpu_share", load.cpu_share},
                           {"load", load.load},
                           {"mean_ratio", or_null(r.looseness)},
                           {"below_exact", or_null(r.below)},
                           {"worst_below", or_null(r.worst_below)},
                           {"guarantee", r.guarantee},
                           {"pareto", r.pareto == Verdict::holds}});
        if (r.of_root)
            records.back()["level"] = 0;
    }
    for (const DualGap& gap : gaps)
        for (int passes = 0; passes < 5; ++passes)
            records.push_back({{"experiment", "cost"},
                               {"input", gap.input},
                               {"method", name_of(gap.method)},
                               {"least_n", gap.least_n},
                               {"most_n", gap.most_n},
                               {"passes", passes},
                               {"gap_percent", gap.gap[passes]},
                               {"bounds", gap.bounds},
                               {"frames_done", gap.frames},
                               {"frames", gap.frames}});
    for (const Figure& f : figures_of(gaps))
        records.push_back(record_of(f, "cost"));
    return records;
}

} // namespace

Provenance provenance_of_cost(const Campaign& campaign)
{
    Provenance from = provenance_of(campaign);
    from.seed = campaign.plan.at("seed");
    from.threads = 1;
    return from;
}

void print_cost(const Merged& all, const OutputOptions& options, const Provenance& from, const Completeness& of_cells)
{
    const Json& plan = all.campaign.plan;
    std::vector<CostRow> rows;
    std::vector<DualGap> gaps;
    std::size_t bvs = 0, measured = 0;
    Load load;
    for (const Rows& cell : all.cells) {
        for (const Json& row : cell) {
            if (is_gap(row)) {
                gaps.push_back(gap_of(row));
                continue;
            }
            rows.push_back(cost_row_of(row));
            bvs = row.value("bvs", bvs);
            load.cpu_share = std::min(load.cpu_share, rows.back().load.cpu_share);
            load.load = std::max(load.load, rows.back().load.load);
        }
        measured += !cell.empty() && !is_gap(cell.front());
    }
    Completeness completeness = of_cells; // whole k-DOPs and inputs are kept
    if (const std::size_t wanted = plan.at("kdops").size(); !completeness.complete)
        completeness.note = interrupted_after(measured, wanted, wanted == 1 ? "k-DOP" : "k-DOPs");
    RecordOutput output(options, from);
    output.describe(plan.at("fields"));
    output.set(completeness);
    output.add_all(records_of(plan, rows, gaps, load));
    output.finish();
    if (options.records_only())
        return;
    print_note(completeness);
    print_tables(plan, bvs, rows, gaps, load);
    print(figures_of(gaps));
    fmt::print("\n{}\n", describe(from));
}

int print_cost(const Merged& all, const OutputOptions& options)
{
    print_cost(all, options, provenance_of_cost(all.campaign), {});
    return 0;
}

} // namespace cinch
