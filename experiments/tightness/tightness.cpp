// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/tightness/tightness.hpp"

#include <algorithm>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include "experiments/input_checksum.hpp"
#include "experiments/report/interrupt.hpp"
#include "experiments/report/or_leave.hpp"
#include "experiments/study/lists.hpp"
#include "experiments/study/study.hpp"
#include "experiments/tightness/tables.hpp"

namespace cinch {
namespace {

using Json = nlohmann::ordered_json;

const std::vector<Methods> usual = [] {
    const Methods all = all_methods.without(Method::convex | Method::corners | Method::vertices);
    return std::vector<Methods>(all.begin(), all.end());
}();

// What refits and verifies an input; owns all that it reads, as a call that is left behind goes on.
struct Prepared {
    Prepared(const InputOptions& what, const TightnessOptions& options, std::size_t leaf, bool attribute)
        : input(load_input(what)), bvh(build_bvh(input.surface, leaf)),
          vertices(bvh, input.surface, {Method::vertices, 6, Rounding::plain})
    {
        if (attribute)
            verifier.emplace(input.surface, bvh, throw_if_interrupted);
        for (const Methods methods : options.methods) {
            throw_if_interrupted();
            refits.emplace_back(bvh, input.surface,
                                RefitOptions{methods, 6, Rounding::proven, options.precision, options.passes});
        }
    }
    Input input;
    Bvh bvh;
    Refitter vertices;
    std::optional<exact::Verifier> verifier;
    std::vector<Refitter> refits;
};

// The cells of a measurement: frame by frame of every run, first each motion, attributed, then the sweep, of its first
// motion.
class Cells {
public:
    Cells(const TightnessOptions& options, std::vector<std::string> motions, std::size_t frames)
        : options_(options), motions_(std::move(motions)), frames_(frames)
    {
    }

    std::size_t count() const { return (motions_.size() + options_.nodes.size()) * frames_; }

    Rows operator()(std::size_t cell)
    {
        const std::size_t run = cell / frames_, frame = cell % frames_;
        const bool attribute = run < motions_.size();
        if (!prepared_ || run_ != run)
            prepare(run, attribute);
        const Input& input = prepared_->input;
        const Clip::Frame maps = input.clip.frame(frame);
        std::vector<double> truth(prepared_->bvh.bvs.size() * 6), supports(truth);
        prepared_->vertices(maps, truth);
        LevelRatios ratios;
        bool violated = false;
        for (std::size_t m = 0; m < options_.methods.size(); ++m) {
            throw_if_interrupted();
            prepared_->refits[m](maps, supports);
            std::optional<exact::FrameVerdict> verdict;
            if (attribute) {
                verdict = prepared_->verifier->check(maps, options_.methods[m], 6, supports);
                violated |= !verdict->examples.empty();
            }
            ratios[name_of(options_.methods[m])] =
                level_ratios(prepared_->bvh, truth, supports, verdict ? &*verdict : nullptr);
        }
        return {{{"run", run},
                 {"motion", input.clip.name},
                 {"n", input.surface.weights.node_count},
                 {"frame", frame},
                 {"violated", violated},
                 {"levels", to_json(ratios)}}};
    }

private:
    void prepare(std::size_t run, bool attribute)
    {
        InputOptions what = options_.input;
        what.motion = motions_[attribute ? run : 0];
        if (!attribute)
            what.nodes = options_.nodes[run - motions_.size()];
        // What counts in the sweep is the upper levels.
        const std::size_t leaf = attribute ? options_.leaf : std::max<std::size_t>(options_.leaf, 16);
        prepared_.reset();
        prepared_ = or_leave([what, options = options_, leaf, attribute] {
            return std::make_unique<Prepared>(what, options, leaf, attribute);
        });
        if (prepared_->input.clip.frame_count() != frames_)
            throw InputError(fmt::format("motion '{}' has {} frames, the first one {}", what.motion,
                                         prepared_->input.clip.frame_count(), frames_));
        run_ = run;
    }

    const TightnessOptions& options_;
    std::vector<std::string> motions_;
    std::size_t frames_;
    std::unique_ptr<Prepared> prepared_;
    std::size_t run_ = 0;
};

Json plan_of(const Input& first, const TightnessOptions& options, const std::vector<std::string>& motions)
{
    Json methods = Json::array();
    for (const Methods m : options.methods)
        methods.push_back(name_of(m));
    return {{"input", first.name},
            {"motions", motions},
            {"nodes", options.nodes},
            {"frames", first.clip.frame_count()},
            {"seed", options.input.seed},
            {"support", options.input.support},
            {"checksum", checksum_of(first)},
            {"methods", methods},
            {"precision", name_of(options.precision)},
            {"passes", options.passes},
            {"leaf", options.leaf},
            {"report", first.report},
            {"missing", first.missing},
            {"fields", fields_of(first)}};
}

// With the lists as they stand.
Plan plan_of(const TightnessOptions& options)
{
    Plan plan;
    if (!options.lists.inputs.empty())
        plan.inputs = options.lists.inputs;
    if (!options.lists.nodes.empty())
        plan.nodes = parse_list(options.lists.nodes, "--nodes");
    if (!options.lists.seeds.empty())
        plan.seeds = parse_list(options.lists.seeds, "--seed");
    if (!options.lists.motions.empty())
        plan.motions = options.lists.motions;
    plan.clips = {options.input.clip};
    plan.methods = options.methods;
    plan.precisions = {options.precision};
    plan.frames = options.input.frames;
    plan.fps = options.input.fps;
    plan.support = options.input.support;
    plan.partial = options.input.partial;
    plan.passes = static_cast<std::uint64_t>(options.passes);
    plan.leaf = options.leaf;
    plan.detail = Detail::levels;
    for (const std::uint64_t nodes : plan.nodes)
        if (nodes > 100000 || (nodes == 0 && !options.lists.nodes.empty()))
            throw InputError(fmt::format("--nodes: expected 1 to 100000 simulation nodes, found {}", nodes));
    return plan;
}

void refuse_what_no_study_has(const TightnessOptions& options)
{
    auto refuse = [](bool is_given, const char* name) {
        if (is_given)
            throw InputError(fmt::format("{} goes with one INPUT, one number of --nodes and one --seed", name));
    };
    refuse(!options.nodes.empty(), "--sweep");
    refuse(!options.input.weights.empty(), "--weights");
    refuse(!options.input.transforms.empty(), "--transforms");
    refuse(!options.input.body.empty(), "--body");
    refuse(!options.output.report.empty(), "--report");
}

TightnessResult result_of(const Merged& all)
{
    const Json& plan = all.campaign.plan;
    const std::size_t motions = plan.at("motions").size(), runs = motions + plan.at("nodes").size(),
                      frames = plan.at("frames");
    TightnessResult result{plan.at("input"),
                           plan.at("report"),
                           plan.at("missing"),
                           plan.at("precision"),
                           plan.at("leaf"),
                           plan.at("methods"),
                           {},
                           {},
                           runs,
                           runs * frames,
                           runs - motions,
                           false};
    for (std::size_t r = 0; r < runs; ++r) {
        TightnessRun run;
        run.frames = frames;
        run.attributed = r < motions;
        for (std::size_t f = 0; f < frames; ++f)
            for (const Json& row : all.cells[r * frames + f]) {
                run.motion = row.at("motion");
                run.nodes = row.at("n");
                add(level_ratios_of(row.at("levels")), run.levels);
                ++run.frames_done;
                result.violated |= row.at("violated").get<bool>();
            }
        if (run.frames_done > 0) // else neither rows nor columns are kept of it
            (run.attributed ? result.full : result.sweep).push_back(std::move(run));
    }
    return result;
}

int print_result(const Merged& all, const OutputOptions& options, const Provenance& from)
{
    const TightnessResult result = result_of(all);
    const std::vector<Figure> figures = figures_of(result);
    RecordOutput output(options, from);
    output.describe(all.campaign.plan.at("fields"));
    output.set(result.completeness());
    output.add_all(records_of(result, figures));
    output.finish();
    if (!options.records_only()) {
        print_tables(result, figures);
        fmt::print("\n{}\n", describe(from));
    }
    if (result.violated)
        fmt::print(stderr, "cinch: a bound is violated; 'cinch verify' says which\n");
    return result.violated ? 1 : 0;
}

} // namespace

int print_tightness(const Merged& all, const OutputOptions& options)
{
    Provenance from = provenance_of(all.campaign);
    from.seed = all.campaign.plan.at("seed");
    return print_result(all, options, from);
}

int tightness(const TightnessOptions& given)
{
    TightnessOptions options = given;
    if (options.methods.empty())
        options.methods = usual;
    if (const Plan plan = plan_of(options); plan.inputs.size() > 1 || plan.nodes.size() > 1 || plan.seeds.size() > 1) {
        refuse_what_no_study_has(options);
        return study(plan, options.shards, options.threads, options.output);
    } else {
        options.input.input = plan.inputs.front();
        options.input.nodes = plan.nodes.front();
        options.input.seed = plan.seeds.front();
    }
    const int threads = options.threads > 0 ? options.threads : tbb::info::default_concurrency();
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    const Provenance here = provenance(threads, options.input.seed);
    RecordOutput(options.output, here); // what cannot be written is said before measuring
    catch_interrupt();
    if (!options.lists.motions.empty())
        options.input.motion = options.lists.motions.front();
    const Input first = or_leave([what = options.input] { return load_input(what); });
    const bool scripted = !first.simulation_nodes_fixed;
    if (!options.nodes.empty() && !scripted)
        throw InputError(
            "--sweep needs a shape or a mesh without --weights; this input brings its own simulation nodes");
    std::vector<std::string> motions = options.lists.motions;
    if (motions.empty() && scripted && !first.simulated)
        motions = {"strong", "mild"};
    else if (motions.empty())
        motions = {""};
    if (options.nodes.empty() && first.simulated && scripted)
        options.nodes = {65, 128, 225, 512}; // fewer may leave nothing to pin
    else if (options.nodes.empty() && scripted)
        options.nodes = {8, 16, 32, 65, 128, 225, 512};

    Cells cells(options, motions, first.clip.frame_count());
    const CampaignRun run = run_campaign(campaign_of("tightness", plan_of(first, options, motions), cells.count()),
                                         options.shards, [&](std::size_t cell) { return cells(cell); });
    const bool violated = result_of(run.all).violated;
    return end_run(run, options.shards, violated ? 1 : 0, [&] {
        if (options.shards.folder.empty())
            print_result(run.all, options.output, here);
        else
            print_tightness(run.all, options.output);
    });
}

} // namespace cinch
