// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/study/study.hpp"

#include <fstream>
#include <iostream>
#include <iterator>

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include "experiments/report/interrupt.hpp"
#include "experiments/study/measure_cell.hpp"
#include "experiments/study/summary.hpp"
#include "toolkit/surface/read_mesh.hpp"

namespace cinch {

void print_study(const Merged& all, const OutputOptions& options)
{
    RecordOutput output(options, provenance_of(all.campaign));
    std::size_t rows = 0;
    for (const Rows& cell : all.cells)
        rows += cell.size();
    output.set({all.cells.size(), all.cells.size(), true, ""});
    for (const Rows& cell : all.cells)
        output.add_all(cell);
    output.finish();
    if (options.records_only())
        return;
    fmt::print("{}\nroot: radius of the bound over the true one at the root, mean over frames; mean over seeds with\n"
               "its 95 % confidence (+-), and quartiles over seeds. all, max: of all BVs. width: along the axes.\n\n"
               "{} rows of {} cells; cinch {} ({}), {}\n",
               study_table(all), rows, all.cells.size(), all.campaign.version, all.campaign.commit,
               all.campaign.compiler);
}

int study(const StudyOptions& options)
{
    const std::string text =
        options.plan == "-" ? std::string(std::istreambuf_iterator<char>(std::cin), {}) : read_bytes(options.plan);
    const Plan plan = parse_plan(text, options.plan == "-" ? "standard input" : options.plan);
    const int threads = options.threads > 0 ? options.threads : tbb::info::default_concurrency();
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    catch_interrupt();
    const auto all = run_campaign(campaign_of("study", to_json(plan), cell_count(plan)), options.shards,
                                  [&](std::size_t cell) { return measure_cell(plan, cell_of(plan, cell)); });
    if (all)
        print_study(*all, options.output);
    return 0;
}

} // namespace cinch
