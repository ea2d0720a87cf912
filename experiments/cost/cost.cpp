// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/cost/cost.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <tbb/global_control.h>

#include "experiments/measure/box_radius.hpp"
#include "experiments/measure/race.hpp"
#include "experiments/report/interrupt.hpp"
#include "experiments/report/number.hpp"
#include "experiments/report/or_leave.hpp"
#include "experiments/report/progress.hpp"
#include "experiments/report/table.hpp"

namespace cinch {
namespace {

struct CostRow {
    int kdop;
    std::string method, arithmetic, guarantee;
    bool proven;
    Range ns, ratio_to_double; ///< per BV
    double looseness;
    double below, worst_below; ///< share of the supports below the exact value, and by how much at most, in widths;
                               ///< NaN: none known
    Verdict pareto = Verdict::unknown; ///< inconclusive where it rests on times whose quartiles overlap
};

// Faster, tighter and proven, or as good in each and better in one: then the other need not be considered.
Verdict dominates(const CostRow& a, const CostRow& b)
{
    if (a.looseness > b.looseness * (1 + 1e-12) || a.proven < b.proven)
        return Verdict::fails;
    const bool is_better = a.looseness < b.looseness * (1 - 1e-12) || a.proven > b.proven;
    if (a.ns.high < b.ns.low || (is_better && a.ns.value == b.ns.value))
        return Verdict::holds;
    return a.ns.low > b.ns.high ? Verdict::fails : Verdict::inconclusive;
}

// Of a row: nothing else dominates it.
Verdict pareto(const std::vector<CostRow>& rows, const CostRow& row)
{
    std::vector<Verdict> all{Verdict::holds};
    for (const CostRow& other : rows)
        if (&other != &row) {
            const Verdict is = dominates(other, row);
            all.push_back(is == Verdict::holds ? Verdict::fails : is == Verdict::fails ? Verdict::holds : is);
        }
    return all_of(all);
}

std::vector<CostRow> measure(const CostSample& sample, int kdop, double seconds, Load& load)
{
    const auto k = static_cast<std::size_t>(kdop);
    std::vector<CostContestant> runners = scalar_contestants(sample, kdop);
    for (CostContestant& kernel : kernel_contestants(sample, kdop))
        runners.push_back(std::move(kernel));
    // The exact value of a method over the BV's own box is that of its rational form; of the others the support of the
    // vertices.
    std::vector<double> truth(sample.bvh.bvs.size() * k), vertices;
    refit(sample.bvh, sample.surface, sample.maps, {Method::vertices, kdop, Rounding::plain}, truth);
    for (std::size_t bv : sample.bvs)
        vertices.insert(vertices.end(), truth.begin() + static_cast<std::ptrdiff_t>(bv * k),
                        truth.begin() + static_cast<std::ptrdiff_t>((bv + 1) * k));

    std::vector<std::vector<double>> supports;
    std::vector<std::function<void()>> calls;
    for (const CostContestant& c : runners) {
        throw_if_interrupted();
        supports.emplace_back(sample.bvs.size() * k);
        c.bound(supports.back());
    }
    for (std::size_t i = 0; i < runners.size(); ++i)
        calls.emplace_back([&, i] { runners[i].bound(supports[i]); });
    const RaceTimes times = race(calls, seconds);
    load.cpu_share = std::min(load.cpu_share, times.cpu_share);
    load.load = std::max(load.load, times.load);

    auto find = [&](const std::string& method, const char* arithmetic) {
        return static_cast<std::size_t>(
            std::find_if(runners.begin(), runners.end(),
                         [&](const CostContestant& c) { return c.method == method && c.arithmetic == arithmetic; }) -
            runners.begin());
    };
    std::vector<CostRow> rows;
    for (std::size_t i = 0; i < runners.size(); ++i) {
        const CostContestant& c = runners[i];
        const std::size_t exact = find(c.method, "rational"),
                          plain = std::min(find(c.method, "double"), find(c.method, "double kernel"));
        CostRow row{kdop,
                    c.method,
                    c.arithmetic,
                    c.guarantee,
                    c.proven,
                    times.of(i) / Range(static_cast<double>(sample.bvs.size())),
                    times.ratio(i, plain),
                    0,
                    NAN,
                    NAN};
        std::size_t below = 0, measured = 0;
        double worst = 0;
        for (std::size_t b = 0; b < sample.bvs.size(); ++b) {
            const double whole = box_radius(std::span(vertices).subspan(b * k, k)),
                         ratio = box_radius(std::span(supports[i]).subspan(b * k, k)) / whole;
            if (whole > 0 && std::isfinite(ratio)) {
                row.looseness += ratio;
                ++measured;
            }
            for (std::size_t d = b * k; d < (b + 1) * k; ++d) {
                const double value = exact < runners.size() ? supports[exact][d] : vertices[d],
                             width = vertices[d] + vertices[d ^ 1];
                // The rational value is the least double above the exact one: below it is below the exact value, by a
                // step or more.
                if (exact < runners.size() ? supports[i][d] < value
                                           : supports[i][d] < value - 1e-14 * std::abs(value)) {
                    ++below;
                    if (width > 0)
                        worst = std::max(worst, (value - supports[i][d]) / width);
                }
            }
        }
        row.looseness /= static_cast<double>(measured);
        row.below = static_cast<double>(below) / static_cast<double>(supports[i].size());
        row.worst_below = worst;
        rows.push_back(row);
    }
    for (CostRow& row : rows)
        row.pareto = pareto(rows, row);
    return rows;
}

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

void print_tables(const Input& input, const CostSample& sample, const std::vector<CostRow>& rows,
                  const std::vector<DualGap>& gaps, const Load& load)
{
    for (const std::string& line : input.report)
        fmt::print("{}\n", line);
    fmt::print("one BV of each of {} levels, last frame; one core{}\n", sample.bvs.size(), partial_mark(input.missing));
    for (std::size_t first = 0; first < rows.size();) {
        const int kdop = rows[first].kdop;
        std::vector<std::vector<std::string>> lines;
        for (; first < rows.size() && rows[first].kdop == kdop; ++first) {
            const CostRow& r = rows[first];
            lines.push_back({r.method, r.arithmetic, grouped(static_cast<std::size_t>(r.ns.value + 0.5)),
                             fmt::format("{:.2f}{}", r.ratio_to_double.value, mark(r.ratio_to_double)),
                             fmt::format("{:.4f}", r.looseness),
                             r.below > 0 ? fmt::format("{:.0f} %", 100 * r.below) : "0",
                             r.worst_below > 0 ? fmt::format("{:.0e}", r.worst_below) : "-", r.guarantee,
                             r.pareto == Verdict::holds   ? "*"
                             : r.pareto == Verdict::fails ? ""
                                                          : "?"});
        }
        fmt::print("\n{}-DOP\n\n{}", kdop,
                   table({"method", "arithmetic", "ns", "/ double", "ratio", "below", "worst", "proof", "opt"}, lines));
    }
    fmt::print("\nns: per BV, all k directions. / double: over plain double of the same method.\n"
               "ratio: bound radius / true radius, mean. below, worst: how often, and by how much of\n"
               "the width at most, a support fell below the exact value of its method (for local,\n"
               "support, linear and best: below the vertices). proof: proven, exact, none, or\n"
               "the error to expect. opt: Pareto-optimal, nothing else is as fast, as tight and as\n"
               "well proven; ? where quartiles of times overlap. interval: directed rounding.\n"
               "rational: the exact value, rounded up.\n{}\n\n"
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

} // namespace

int cost(const CostOptions& options)
{
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    const Provenance from = provenance(1, options.input.seed);
    RecordOutput output(options.output, from);
    const Input input = load_input(options.input);
    output.describe(fields_of(input));
    std::vector<std::string> others; // of which the gap is measured too
    if (options.all_scenes)
        for (const char* shape : {"brain", "santa", "fish"})
            if (input.name != shape)
                others.emplace_back(shape);
    const Bvh bvh = build_bvh(input.surface, options.leaf);
    const Clip::Frame last = input.clip.frame(input.clip.frame_count() - 1);
    CostSample sample{input.surface, bvh, last, {}};
    for (std::size_t l = 0; l + 1 < bvh.level.size(); ++l)
        sample.bvs.push_back((bvh.level[l] + bvh.level[l + 1]) / 2);
    catch_interrupt();
    std::vector<DualGap> gaps;
    std::vector<CostRow> rows;
    Load load;
    std::size_t done = 0;
    const std::size_t wanted = 1 + others.size() + options.kdops.size();
    try {
        Progress progress("measuring gaps and k-DOPs", wanted);
        auto step = [&](auto&& made, auto& all) {
            for (auto& row : made)
                all.push_back(std::move(row));
            progress.done(++done);
        };
        step(dual_gaps(input, options.leaf), gaps);
        for (const std::string& shape : others) {
            throw_if_interrupted();
            InputOptions what;
            what.input = shape;
            step(dual_gaps(or_leave([what] { return load_input(what); }), options.leaf), gaps);
        }
        pin_to_one_core();
        for (const int kdop : options.kdops)
            step(measure(sample, kdop, options.seconds, load), rows);
    } catch (const Interrupted&) { // whole k-DOPs and inputs are kept
    }
    const std::size_t measured = done - std::min(done, 1 + others.size());
    const Completeness completeness{1, 1, done == wanted,
                                    done == wanted ? ""
                                                   : interrupted_after(measured, options.kdops.size(),
                                                                       options.kdops.size() == 1 ? "k-DOP" : "k-DOPs")};
    std::vector<nlohmann::ordered_json> records;
    auto number = [](double x) { return std::isfinite(x) ? nlohmann::ordered_json(x) : nlohmann::ordered_json(); };
    for (const CostRow& r : rows)
        records.push_back({{"experiment", "cost"},
                           {"input", input.name},
                           {"method", r.method},
                           {"arithmetic", r.arithmetic},
                           {"kdop", r.kdop},
                           {"ns_per_bound", r.ns.value},
                           {"ns_per_bound_low", r.ns.low},
                           {"ns_per_bound_high", r.ns.high},
                           {"ratio_to_double", r.ratio_to_double.value},
                           {"ratio_to_double_low", r.ratio_to_double.low},
                           {"ratio_to_double_high", r.ratio_to_double.high},
                           {"settled", r.ratio_to_double.is_settled()},
                           {"cpu_share", load.cpu_share},
                           {"load", load.load},
                           {"mean_ratio", number(r.looseness)},
                           {"below_exact", number(r.below)},
                           {"worst_below", number(r.worst_below)},
                           {"guarantee", r.guarantee},
                           {"pareto", r.pareto == Verdict::holds}});
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
    output.set(completeness);
    output.add_all(records);
    output.finish();
    if (!options.output.records_only()) {
        print_note(completeness);
        print_tables(input, sample, rows, gaps, load);
        print(figures_of(gaps));
        fmt::print("\n{}\n", describe(from));
    }
    if (!completeness.complete) {
        std::fflush(stdout);
        fmt::print(stderr, "cinch: {}\n", completeness.note);
        return 130;
    }
    return 0;
}

} // namespace cinch
