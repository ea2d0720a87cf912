// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/scaling/scaling.hpp"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "cinch/surface.hpp"
#include "experiments/input_checksum.hpp"
#include "experiments/report/number.hpp"
#include "experiments/report/or_leave.hpp"
#include "experiments/report/scaling_figures.hpp"
#include "experiments/report/table.hpp"
#include "experiments/scaling/contestants.hpp"

namespace cinch {
namespace {

using Json = nlohmann::ordered_json;

// A cell: a surface with so many simulation nodes.
struct Size {
    InputOptions what;
    const ScalingSize* paper; ///< of Table 1, or none
};

InputOptions input_of(const ScalingOptions& options, std::string name)
{
    InputOptions what;
    what.input = std::move(name);
    what.frames = 1;
    what.seed = options.seed;
    what.partial = options.partial;
    return what;
}

// The paper's sizes; of an input, in its last frame, the paper's numbers of simulation nodes where these can be chosen.
std::vector<Size> sizes_of(const ScalingOptions& options, const std::optional<Input>& input)
{
    std::vector<Size> sizes;
    auto add = [&](const std::string& name, const ScalingSize* paper) {
        for (const std::size_t n : scaling_nodes) {
            sizes.push_back({input_of(options, name), paper});
            sizes.back().what.nodes = n;
        }
    };
    if (!input)
        for (const ScalingSize& size : scaling_sizes)
            add(size.shape, &size);
    else if (input->simulation_nodes_fixed)
        sizes.push_back({input_of(options, options.input), nullptr});
    else
        add(options.input, nullptr);
    return sizes;
}

Json plan_of(const ScalingOptions& options, const std::optional<Input>& input)
{
    Json plan{{"precision", name_of(options.precision)},
              {"passes", options.passes},
              {"seconds", options.seconds},
              {"seed", options.seed}};
    if (input) {
        plan["input"] = options.input;
        plan["fields"] = fields_of(*input);
        plan["report"] = input->report;
        plan["mark"] = partial_mark(input->missing);
        plan["checksum"] = checksum_of(*input);
    }
    return plan;
}

Rows measure(const Size& size, const ScalingOptions& options)
{
    const Input input = or_leave([what = size.what] { return load_input(what); });
    const ContestantTimes times = time_contestants(input, options.precision, options.passes, options.seconds);
    const std::vector<std::string>& names = scaling_contestants();
    const auto place = [&](std::string_view name) {
        return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
    };
    const std::size_t best = place(name_of(Method::best));
    Rows rows;
    for (std::size_t i = 0; i < names.size(); ++i) {
        const Range ns = times.race.of(i), over = times.race.ratio(i, best);
        Json row{{"experiment", "scaling"}};
        if (!size.paper)
            row["input"] = input.name;
        row.update({{"method", names[i]},
                    {"precision", name_of(options.precision)},
                    {"n", input.surface.weights.node_count},
                    {"vertices", input.surface.mesh.vertices.size()},
                    {"ns_per_bound", ns.value},
                    {"ns_per_bound_low", ns.low},
                    {"ns_per_bound_high", ns.high},
                    {"over_default", over.value},
                    {"over_default_low", over.low},
                    {"over_default_high", over.high},
                    {"project_ns", times.project_ns},
                    {"kind", times.kind},
                    {"cpu_share", times.race.cpu_share},
                    {"load", times.race.load},
                    {"frames_done", 1},
                    {"frames", 1}});
        if (size.paper)
            row["paper_us"] = (names[i] == "optimal" ? size.paper->optimal() : size.paper->eq12(size.what.nodes)).value;
        rows.push_back(std::move(row));
    }
    return rows;
}

std::string microseconds(const Traced& us)
{
    const std::string text =
        us.value < 100 ? fmt::format("{:.2f}", us.value) : grouped(static_cast<std::size_t>(us.value + 0.5));
    return us.known() ? text + mark(us.range()) : "-";
}

Load load_of(const Results& results)
{
    Load load;
    for (const Record& r : results.all()) {
        load.cpu_share = std::min(load.cpu_share, r.number("cpu_share"));
        load.load = std::max(load.load, r.number("load"));
    }
    return load;
}

// What was measured, a line each.
void print_lines(const Results& results)
{
    std::vector<std::vector<std::string>> lines;
    for (const Record& r : results.all())
        lines.push_back({grouped(r.fields["vertices"].get<std::size_t>()), std::to_string(r.fields["n"].get<int>()),
                         r.word("method"), microseconds(Results::number(r, "ns_per_bound") / 1e3)});
    fmt::print("{}", table({"vertices", "n", "method", "microseconds"}, lines));
}

// Beside the paper's.
void print_table_1(const ScalingFigures& f)
{
    std::vector<std::vector<std::string>> lines;
    for (const std::string& name : scaling_contestants()) {
        std::vector<std::string> line{name == "unproven" ? "best, unproven" : name};
        for (const ScalingSize& size : scaling_sizes)
            for (const std::size_t n : scaling_nodes)
                line.push_back(microseconds(f.us(name.c_str(), size.vertices, n)));
        line.push_back(fmt::format("{:.2f}", f.exponent(name.c_str(), 30000).value));
        lines.push_back(std::move(line));
    }
    std::vector<std::string> paper{"paper"};
    for (const ScalingSize& size : scaling_sizes)
        for (const std::size_t n : scaling_nodes)
            paper.push_back(fmt::format("{:.0f}", size.eq12(n).value));
    paper.push_back("");
    lines.push_back(paper);
    fmt::print("           3.5K vertices      30K                145K\n{}\n",
               table({"n", "65", "225", "509", "65", "225", "509", "65", "225", "509", "exponent"}, lines));
    const Record& last = f.results.all().back();
    fmt::print("exponent: of n, at 30K vertices. textbook: boxes transformed by their corners\n"
               "(Definition 1 of the paper); -axes: by centre and axes (its section 6). paper:\n"
               "Table 1, its Eq. 12 on a 3.4 GHz Pentium 4; its optimal AABB took 2,000, 17,200\n"
               "and 82,500. default: 'best', here '{}'. One core, all methods in turn.\n"
               "Once per frame all transforms are projected: {} microseconds for 509.\n{}\n\n",
               last.word("kind"), microseconds(Results::number(last, "project_ns") / 1e3),
               describe(load_of(f.results)));
}

void print_results(const Merged& all, const OutputOptions& options, const Provenance& from,
                   const Completeness& completeness)
{
    const Json& plan = all.campaign.plan;
    const bool paper = !plan.contains("input");
    Rows records;
    for (const Rows& cell : all.cells)
        records.insert(records.end(), cell.begin(), cell.end());
    const Results results = results_of(records, Json::object());
    std::vector<Figure> figures;
    if (paper && completeness.complete)
        figures = ScalingFigures{results}.with_targets();

    RecordOutput output(options, from);
    if (!paper)
        output.describe(plan["fields"]);
    output.set(completeness);
    output.add_all(records);
    for (const Figure& figure : figures)
        output.add(record_of(figure, "scaling"));
    output.finish();
    if (options.records_only())
        return;
    print_note(completeness);
    if (paper) {
        fmt::print("Time of one bound of the whole brain (six directions), microseconds, {}\n\n",
                   plan["precision"].get<std::string>());
        if (completeness.complete)
            print_table_1({results});
        else
            print_lines(results);
    } else {
        for (const Json& line : plan["report"])
            fmt::print("{}\n", line.get<std::string>());
        fmt::print("\nTime of one bound of the whole surface (six directions), {}{}\n\n",
                   plan["precision"].get<std::string>(), plan["mark"].get<std::string>());
        print_lines(results);
    }
    print(figures);
    fmt::print("\n{}\n", describe(from));
}

Provenance provenance_of_rows(const Campaign& campaign)
{
    Provenance from = provenance_of(campaign);
    from.seed = campaign.plan.at("seed");
    from.threads = 1;
    return from;
}

} // namespace

int print_scaling(const Merged& all, const OutputOptions& options)
{
    print_results(all, options, provenance_of_rows(all.campaign), {});
    return 0;
}

int scaling(const ScalingOptions& options)
{
    const Provenance here = provenance(1, options.seed);
    RecordOutput(options.output, here); // what cannot be written is said before measuring
    pin_to_one_core();
    catch_interrupt();
    std::optional<Input> input;
    if (!options.input.empty())
        input = or_leave([what = input_of(options, options.input)] { return load_input(what); });
    const std::vector<Size> sizes = sizes_of(options, input);
    const Campaign campaign = campaign_of("scaling", plan_of(options, input), sizes.size());
    input.reset();
    const CampaignRun run =
        run_campaign(campaign, options.shards, [&](std::size_t cell) { return measure(sizes[cell], options); });
    return end_run(run, options.shards, 0, [&] {
        Completeness completeness = run.completeness();
        if (!completeness.complete)
            completeness.note = interrupted_after(run.done, run.wanted, "sizes");
        print_results(run.all, options.output,
                      options.shards.folder.empty() ? here : provenance_of_rows(run.all.campaign), completeness);
    });
}

} // namespace cinch
