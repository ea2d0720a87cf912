// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/cost/cost.hpp"

#include <algorithm>
#include <cmath>

#include <tbb/global_control.h>

#include "experiments/cost/cost_rows.hpp"
#include "experiments/input_checksum.hpp"
#include "experiments/measure/race.hpp"
#include "experiments/report/interrupt.hpp"
#include "experiments/report/or_leave.hpp"
#include "toolkit/hierarchy/box_radius.hpp"

namespace cinch {
namespace {

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

std::vector<CostRow> measure(const CostSample& sample, int kdop, double seconds,
                             const std::vector<CostContestant>& runners)
{
    const auto k = static_cast<std::size_t>(kdop);
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
                    plain < runners.size() ? times.ratio(i, plain) : Range(NAN),
                    0,
                    NAN,
                    NAN,
                    Verdict::unknown,
                    times};
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

// Of a BV of each level, and of the root: the time goes to both in halves.
std::vector<CostRow> measure(const CostSample& sample, int kdop, const CostOptions& options)
{
    std::vector<CostContestant> runners = scalar_contestants(sample, kdop);
    for (CostContestant& kernel : kernel_contestants(sample, kdop))
        runners.push_back(std::move(kernel));
    std::vector<CostRow> rows = measure(sample, kdop, options.seconds / 2, runners);
    const CostSample root{sample.surface, sample.bvh, sample.maps, {0}};
    for (CostRow& row : measure(root, kdop, options.seconds / 2, anytime_contestants(root, kdop, options.anytime))) {
        row.of_root = true;
        rows.push_back(row);
    }
    return rows;
}

nlohmann::ordered_json plan_of(const CostOptions& options, const Input& input, const std::vector<std::string>& others)
{
    return {{"input", input.name},
            {"fields", fields_of(input)},
            {"report", input.report},
            {"mark", partial_mark(input.missing)},
            {"checksum", checksum_of(input)},
            {"seed", options.input.seed},
            {"others", others},
            {"kdops", options.kdops},
            {"seconds", options.seconds},
            {"budgets_ns", options.anytime.budgets_ns},
            {"tolerances", options.anytime.tolerances},
            {"leaf", options.leaf}};
}

} // namespace

int cost(const CostOptions& options)
{
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    const Provenance from = provenance(1, options.input.seed);
    RecordOutput(options.output, from); // what cannot be written is said before measuring
    const Input input = load_input(options.input);
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
    pin_to_one_core();
    // A cell: the gaps of an input, or the contestants of a k-DOP.
    const std::size_t inputs = 1 + others.size();
    const Campaign campaign = campaign_of("cost", plan_of(options, input, others), inputs + options.kdops.size());
    const CampaignRun run = run_campaign(campaign, options.shards, [&](std::size_t cell) {
        Rows rows;
        if (cell == 0) {
            rows = rows_of(dual_gaps(input, options.leaf));
        } else if (cell < inputs) {
            InputOptions what;
            what.input = others[cell - 1];
            rows = rows_of(dual_gaps(or_leave([what] { return load_input(what); }), options.leaf));
        } else {
            rows = rows_of(measure(sample, options.kdops[cell - inputs], options));
            rows.front()["bvs"] = sample.bvs.size();
        }
        return rows;
    });
    return end_run(run, options.shards, 0, [&] {
        print_cost(run.all, options.output, options.shards.folder.empty() ? from : provenance_of_cost(campaign),
                   run.completeness());
    });
}

} // namespace cinch
