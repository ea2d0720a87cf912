// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/fuzz/fuzz_rows.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <map>

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include "cinch/surface.hpp"
#include "experiments/fuzz/fuzz_failure.hpp"
#include "experiments/report/interrupt.hpp"
#include "experiments/report/number.hpp"

namespace cinch {
namespace {

using Json = nlohmann::ordered_json;

struct FuzzPlan {
    std::uint64_t seed, cases, per_cell;
    std::string family, corpus;
    Defect defect;
};

Json to_json(const FuzzPlan& p)
{
    return {{"seed", p.seed},     {"cases", p.cases},   {"cases_per_cell", p.per_cell},
            {"family", p.family}, {"corpus", p.corpus}, {"sabotage", name_of(p.defect)}};
}

FuzzPlan fuzz_plan_of(const Json& from)
{
    FuzzPlan plan{from.at("seed"),   from.at("cases"),  from.at("cases_per_cell"),
                  from.at("family"), from.at("corpus"), Defect::none};
    for (const auto& [name, defect] : defects)
        if (from.at("sabotage") == name)
            plan.defect = defect;
    return plan;
}

std::size_t cell_count(const FuzzPlan& p) { return p.cases / p.per_cell + (p.cases % p.per_cell != 0); }

// How many failed, and of each family the first.
Rows run_cell(const FuzzPlan& plan, std::size_t cell)
{
    const auto start = std::chrono::steady_clock::now();
    const std::uint64_t first = cell * plan.per_cell, count = std::min(plan.per_cell, plan.cases - first);
    std::vector<char> fails(count);
    tbb::parallel_for(tbb::blocked_range<std::uint64_t>(0, count, 8), [&](const auto& range) {
        for (std::uint64_t i = range.begin(); i < range.end() && !interrupted(); ++i)
            fails[i] = !find_fault(draw_case(plan.seed, first + i, plan.family), plan.defect).empty();
    });
    throw_if_interrupted();
    Json firsts = Json::object();
    for (std::uint64_t i = 0; i < count; ++i)
        if (fails[i]) {
            const std::string family = draw_case(plan.seed, first + i, plan.family).family;
            if (!firsts.contains(family))
                firsts[family] = first + i;
        }
    return {{{"cases", count},
             {"violations", std::count(fails.begin(), fails.end(), 1)},
             {"first", firsts},
             {"seconds", std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()}}};
}

struct FuzzTotals {
    std::uint64_t cases = 0, violations = 0;
    double seconds = 0;                         ///< of all cells
    std::map<std::uint64_t, std::string> first; ///< of each family that fails, by number
};

FuzzTotals fuzz_totals(const Merged& all)
{
    FuzzTotals totals;
    std::map<std::string, std::uint64_t> first;
    for (const Rows& cell : all.cells)
        for (const Json& row : cell) {
            totals.cases += row.at("cases").get<std::uint64_t>();
            totals.violations += row.at("violations").get<std::uint64_t>();
            totals.seconds += row.at("seconds").get<double>();
            for (const auto& [family, index] : row.at("first").items())
                first.emplace(family, index.get<std::uint64_t>()); // cells come in the order of cases
        }
    for (const auto& [family, index] : first)
        totals.first.emplace(index, family);
    return totals;
}

} // namespace

std::uint64_t fuzz_cases_per_cell(std::uint64_t cases)
{
    return std::max<std::uint64_t>(4096, cases / 100000 + (cases % 100000 != 0));
}

int print_fuzz(const Merged& all, const OutputOptions& options, const std::string& folder)
{
    FuzzPlan plan = fuzz_plan_of(all.campaign.plan);
    if (plan.corpus.empty() && plan.defect == Defect::none)
        plan.corpus = (std::filesystem::path(folder) / "failures").string();
    const FuzzTotals totals = fuzz_totals(all);
    Provenance from = provenance_of(all.campaign);
    from.seed = plan.seed;
    RecordOutput output(options, from);
    const bool is_complete = totals.cases == plan.cases;
    output.set({0, 0, is_complete, is_complete ? "" : interrupted_after(totals.cases, plan.cases, "cases")});
    for (const auto& [index, family] : totals.first) {
        const FuzzFailure failure = shrink_and_save(draw_case(plan.seed, index, plan.family), plan.defect, plan.corpus);
        output.add(record_of(failure, index));
        if (!options.records_only())
            print(failure, index);
    }
    output.add({{"experiment", "fuzz"},
                {"cases", totals.cases},
                {"violations", totals.violations},
                {"seconds", totals.seconds},
                {"family", plan.family},
                {"shard", 0},
                {"shards", 1}});
    output.finish();
    if (!options.records_only())
        fmt::print(
            "{}{} cases, {} violations\n{} of work, {} cases per second\n{}\n",
            is_complete ? "" : interrupted_after(totals.cases, plan.cases, "cases") + "\n", grouped(totals.cases),
            grouped(totals.violations), duration(totals.seconds),
            grouped(static_cast<std::size_t>(static_cast<double>(totals.cases) / std::max(totals.seconds, 1e-3))),
            describe(from));
    return totals.violations ? 1 : 0;
}

int fuzz_in_cells(const FuzzOptions& options)
{
    if (options.seconds || !options.resume.empty())
        throw InputError("--out is of a number of --cases; it goes without --seconds, and needs no --resume");
    const std::uint64_t cases = options.cases.value_or(100000);
    const FuzzPlan plan{options.seed,   cases,          fuzz_cases_per_cell(cases),
                        options.family, options.corpus, options.defect};
    const tbb::global_control limit(
        tbb::global_control::max_allowed_parallelism,
        static_cast<std::size_t>(options.threads > 0 ? options.threads : tbb::info::default_concurrency()));
    catch_interrupt();
    const CampaignRun run = run_campaign(campaign_of("fuzz", to_json(plan), cell_count(plan)), options.shards,
                                         [&](std::size_t cell) { return run_cell(plan, cell); });
    return end_run(run, options.shards, fuzz_totals(run.all).violations ? 1 : 0,
                   [&] { print_fuzz(run.all, options.output, options.shards.folder); });
}

} // namespace cinch
