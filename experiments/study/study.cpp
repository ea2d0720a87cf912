// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/study/study.hpp"

#include <filesystem>
#include <iostream>
#include <iterator>

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include "experiments/report/interrupt.hpp"
#include "experiments/study/measure_cell.hpp"
#include "experiments/study/summary.hpp"
#include "toolkit/surface/checksum.hpp"
#include "toolkit/surface/read_mesh.hpp"

namespace cinch {
namespace {

// With the bytes of its files: another file under the same name is another plan.
nlohmann::ordered_json plan_of(const Plan& plan)
{
    nlohmann::ordered_json out = to_json(plan), sums = nlohmann::ordered_json::object();
    for (const std::string& input : plan.inputs)
        if (std::filesystem::is_regular_file(input))
            sums[input] = checksum(read_bytes(input));
    out["checksums"] = sums;
    return out;
}

} // namespace

void print_study(const Merged& all, const OutputOptions& options, const Completeness& completeness)
{
    RecordOutput output(options, provenance_of(all.campaign));
    std::size_t rows = 0, cells = 0;
    for (const Rows& cell : all.cells) {
        rows += cell.size();
        cells += !cell.empty();
    }
    output.set(completeness);
    for (const Rows& cell : all.cells)
        output.add_all(cell);
    for (const Chart& chart : study_charts(all))
        output.add_chart(chart);
    output.finish();
    if (options.records_only())
        return;
    print_note(completeness);
    fmt::print("{}\nroot: radius of the bound over the true one at the root, mean over frames; mean over seeds with\n"
               "its 95 % confidence (+-), and quartiles over seeds. all, max: of all BVs. width: along the axes.\n\n"
               "{} rows of {} cells; cinch {} ({}), {}\n",
               study_table(all), rows, cells, all.campaign.version, all.campaign.commit, all.campaign.compiler);
}

int study(const StudyOptions& options)
{
    const std::string text =
        options.plan == "-" ? std::string(std::istreambuf_iterator<char>(std::cin), {}) : read_bytes(options.plan);
    const Plan plan = parse_plan(text, options.plan == "-" ? "standard input" : options.plan);
    return study(plan, options.shards, options.threads, options.output);
}

int study(const Plan& plan, const ShardOptions& shards, int wanted_threads, const OutputOptions& output)
{
    const int threads = wanted_threads > 0 ? wanted_threads : tbb::info::default_concurrency();
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    catch_interrupt();
    const CampaignRun run = run_campaign(campaign_of("study", plan_of(plan), cell_count(plan)), shards,
                                         [&](std::size_t cell) { return measure_cell(plan, cell_of(plan, cell)); });
    return end_run(run, shards, 0, [&] { print_study(run.all, output, run.completeness()); });
}

} // namespace cinch
