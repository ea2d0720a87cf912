// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/tightness.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include "cinch/surface.hpp"
#include "exact/verifier.hpp"
#include "experiments/measure/box_radius.hpp"
#include "experiments/measure/race.hpp"
#include "experiments/report/interrupt.hpp"
#include "experiments/report/number.hpp"
#include "experiments/report/or_leave.hpp"
#include "experiments/report/progress.hpp"
#include "experiments/report/table.hpp"

namespace cinch {
namespace {

struct LevelRatio {
    std::size_t bvs = 0, measured = 0;
    double sum = 0, max = 0;
    exact::Loss loss; ///< in units of the true radius

    double mean() const { return measured ? sum / static_cast<double>(measured) : NAN; }
};

struct Run { ///< one motion and number of nodes
    std::string motion;
    std::size_t nodes = 0;
    std::size_t frames_done = 0, frames = 0;
    std::map<std::string, std::vector<LevelRatio>> levels; ///< by method, of the frames done

    bool is_complete() const { return frames_done == frames; }
};

const std::vector<Methods> usual = [] {
    const Methods all = all_methods.without(Method::convex | Method::corners | Method::vertices);
    return std::vector<Methods>(all.begin(), all.end());
}();

void add_frame(const Bvh& bvh, std::span<const double> truth, std::span<const double> supports,
               const exact::FrameVerdict* verdict, std::vector<LevelRatio>& levels)
{
    levels.resize(bvh.level.size() - 1);
    for (std::size_t l = 0; l < levels.size(); ++l) {
        levels[l].bvs = bvh.level[l + 1] - bvh.level[l];
        for (std::size_t bv = bvh.level[l]; bv < bvh.level[l + 1]; ++bv) {
            const double whole = box_radius(truth.subspan(6 * bv, 6)),
                         ratio = box_radius(supports.subspan(6 * bv, 6)) / whole;
            if (!(whole > 0 && std::isfinite(ratio)))
                continue;
            ++levels[l].measured;
            levels[l].sum += ratio;
            levels[l].max = std::max(levels[l].max, ratio);
            if (!verdict)
                continue;
            const exact::Loss& loss = verdict->bvs[bv].loss;
            levels[l].loss.box += loss.box / whole;
            levels[l].loss.interval += loss.interval / whole;
            levels[l].loss.corner += (loss.corner + loss.rounding) / whole;
        }
    }
}

// What refits and verifies an input; owns or shares all that it reads.
struct Prepared {
    Prepared(std::shared_ptr<const Input> shared, const TightnessOptions& options, bool attribute)
        : input(std::move(shared)), bvh(build_bvh(input->surface, options.leaf)),
          vertices(bvh, input->surface, {Method::vertices, 6, Rounding::plain})
    {
        if (attribute)
            verifier.emplace(input->surface, bvh, throw_if_interrupted);
        for (const Methods methods : options.methods) {
            throw_if_interrupted();
            refits.emplace_back(bvh, input->surface,
                                RefitOptions{methods, 6, Rounding::proven, options.precision, options.passes});
        }
    }
    std::shared_ptr<const Input> input;
    Bvh bvh;
    Refitter vertices;
    std::optional<exact::Verifier> verifier;
    std::vector<Refitter> refits;
};

// Ratios of every level and method; with `attribute` also by the exact verifier what is lost where. Frame by frame, so
// that after an interrupt all methods have the same ones.
Run measure(const std::shared_ptr<const Input>& shared, const TightnessOptions& options, bool attribute, bool& violated)
{
    const Input& input = *shared;
    const std::size_t frames = input.clip.frame_count();
    Run run{input.clip.name, input.surface.weights.node_count, 0, frames, {}};
    Progress progress(fmt::format("{} nodes, '{}'", run.nodes, run.motion), options.methods.size() * frames);
    try {
        const std::unique_ptr<Prepared> prepared =
            or_leave([=] { return std::make_unique<Prepared>(shared, options, attribute); });
        const Bvh& bvh = prepared->bvh;
        std::vector<double> truth(bvh.bvs.size() * 6), supports(truth);
        for (std::size_t f = 0; f < frames; ++f) {
            std::map<std::string, std::vector<LevelRatio>> now = run.levels; // kept if the frame is whole
            const Clip::Frame maps = input.clip.frame(f);
            prepared->vertices(maps, truth);
            for (std::size_t m = 0; m < options.methods.size(); ++m) {
                throw_if_interrupted();
                prepared->refits[m](maps, supports);
                std::optional<exact::FrameVerdict> verdict;
                if (attribute) {
                    verdict = prepared->verifier->check(maps, options.methods[m], 6, supports);
                    violated |= !verdict->examples.empty();
                }
                add_frame(bvh, truth, supports, verdict ? &*verdict : nullptr, now[name_of(options.methods[m])]);
                progress.done(f * options.methods.size() + m + 1);
            }
            run.levels = std::move(now);
            ++run.frames_done;
        }
    } catch (const Interrupted&) {
    }
    return run;
}

nlohmann::ordered_json record(const Input& input, const Run& run, const std::string& method, std::size_t level,
                              bool attributed)
{
    const LevelRatio& l = run.levels.at(method)[level];
    auto share = [&](double x) {
        return l.measured ? nlohmann::ordered_json(x / static_cast<double>(l.measured)) : nlohmann::ordered_json();
    };
    nlohmann::ordered_json out{{"experiment", "tightness"},
                               {"input", input.name},
                               {"motion", run.motion},
                               {"method", method},
                               {"n", run.nodes},
                               {"level", level},
                               {"bvs", l.bvs},
                               {"mean_ratio", share(l.sum)},
                               {"max_ratio", l.measured ? nlohmann::ordered_json(l.max) : nlohmann::ordered_json()}};
    out.update({{"frames_done", run.frames_done}, {"frames", run.frames}, {"complete", run.is_complete()}});
    if (attributed)
        out.update({{"box_loss", share(l.loss.box)},
                    {"interval_loss", share(l.loss.interval)},
                    {"method_loss", share(l.loss.corner)}});
    return out;
}

std::string frames_of(const Run& run)
{
    return run.is_complete() ? counted(run.frames, "frame", "frames")
                             : interrupted_after(run.frames_done, run.frames, "frames");
}

void print_levels(const Run& run, const std::vector<std::string>& names)
{
    fmt::print("motion '{}', {}, {}: mean ratio by level\n\n", run.motion,
               counted(run.nodes, "simulation node", "simulation nodes"), frames_of(run));
    std::vector<std::string> header{"level", "BVs"};
    header.insert(header.end(), names.begin(), names.end());
    std::vector<std::vector<std::string>> means, greatest;
    for (std::size_t l = 0; l < run.levels.at(names[0]).size(); ++l) {
        std::vector<std::string> row{std::to_string(l), grouped(run.levels.at(names[0])[l].bvs)}, most = row;
        for (const std::string& name : names) {
            const LevelRatio& level = run.levels.at(name)[l];
            row.push_back(level.measured ? fmt::format("{:.3f}", level.mean()) : "-");
            most.push_back(level.measured ? fmt::format("{:.2f}", level.max) : "-");
        }
        means.push_back(row);
        greatest.push_back(most);
    }
    const std::string part = run.is_complete() ? "" : ", " + frames_of(run);
    fmt::print("{}\ngreatest ratio by level{}\n\n{}\n", table(header, means), part, table(header, greatest));
    const auto& last = run.levels.at(names.back());
    std::vector<std::vector<std::string>> rows;
    for (std::size_t l = 0; l < last.size(); ++l) {
        auto share = [&](double x) {
            return last[l].measured ? fmt::format("{:.3f}", x / static_cast<double>(last[l].measured)) : "-";
        };
        rows.push_back(
            {std::to_string(l), share(last[l].loss.box), share(last[l].loss.interval), share(last[l].loss.corner)});
    }
    fmt::print("what '{}' gives away, per direction, as a share of the true radius{}\n\n{}\n", names.back(), part,
               table({"level", "box", "interval", "method"}, rows));
}

void add_figures(const Run& run, std::vector<Figure>& figures)
{
    const auto best = run.levels.find("best");
    if (!run.is_complete() || best == run.levels.end() || (run.motion != "strong" && run.motion != "mild"))
        return;
    double worst = 0;
    for (const LevelRatio& level : best->second)
        worst = std::max(worst, level.mean());
    const double target = run.motion == "strong" ? 1.30 : 1.15, root = best->second[0].mean();
    figures.push_back({fmt::format("'{}': best, mean ratio of its worst level", run.motion),
                       fmt::format("{:.3f}", worst), fmt::format("<= {:.2f}", target), worst <= target});
    if (run.motion == "strong")
        figures.push_back(
            {"'strong': best, mean ratio of the root", fmt::format("{:.3f}", root), "<= 1.20", root <= 1.2});
    if (const auto sphere = run.levels.find("sphere"); sphere != run.levels.end() && run.motion == "strong") {
        const double times = sphere->second[0].mean() / root, most = sphere->second[0].max / root;
        figures.push_back(
            {"'strong': sphere over best at the root, mean", fmt::format("{:.1f}", times), ">= 50", times >= 50});
        figures.push_back({"'strong': sphere at most over best", fmt::format("{:.1f}", most), "-", true});
    }
}

// What is measured, and what was so far.
struct Measured {
    std::vector<std::string> names, motions;
    std::vector<std::size_t> nodes;
    std::vector<Run> full, sweep; ///< of each motion; of each number of nodes, under the first motion
    bool violated = false;

    // Of what was interrupted before its first frame nothing is kept: neither rows nor columns.
    void keep(Run&& run, std::vector<Run>& runs)
    {
        if (run.frames_done > 0)
            runs.push_back(std::move(run));
    }
    Completeness completeness(std::size_t frames) const
    {
        const std::size_t wanted = motions.size() + nodes.size();
        std::size_t whole = 0, done = 0;
        for (const auto* runs : {&full, &sweep})
            for (const Run& run : *runs) {
                whole += run.is_complete();
                done += run.frames_done;
            }
        Completeness out{done, wanted * frames, whole == wanted, ""};
        if (!out.complete)
            out.note = interrupted_after(
                done, wanted * frames,
                fmt::format("frames ({} of {})", whole,
                            counted(wanted, "motion or number of nodes", "motions and numbers of nodes")));
        return out;
    }
};

std::shared_ptr<const Input> load(const InputOptions& what)
{
    return or_leave([what] { return std::make_shared<const Input>(load_input(what)); });
}

void measure_all(const TightnessOptions& options, Measured& measured)
{
    InputOptions what = options.input;
    for (const std::string& motion : measured.motions) {
        throw_if_interrupted();
        what.motion = motion;
        measured.keep(measure(load(what), options, true, measured.violated), measured.full);
    }
    TightnessOptions coarse = options;
    coarse.leaf = std::max<std::size_t>(options.leaf, 16); // what counts here is the upper levels
    what.motion = measured.motions[0];
    for (const std::size_t nodes : measured.nodes) {
        throw_if_interrupted();
        what.nodes = nodes;
        measured.keep(measure(load(what), coarse, false, measured.violated), measured.sweep);
    }
}

void print_tables(const Measured& measured, const std::vector<Figure>& figures, const Completeness& completeness,
                  const Input& first, const TightnessOptions& options, const Provenance& from)
{
    print_note(completeness);
    for (const std::string& line : first.report)
        fmt::print("{}\n", line);
    fmt::print("bounds in {}, AABBs, at most {} per leaf; radius: half diagonal{}\n\n", name_of(options.precision),
               counted(options.leaf, "triangle", "triangles"), partial_mark(first.missing));
    for (const Run& run : measured.full)
        print_levels(run, measured.names);
    if (const std::vector<Run>& sweep = measured.sweep; !sweep.empty()) {
        const std::vector<std::string>& names = measured.names;
        std::vector<std::string> header{"n"};
        header.insert(header.end(), names.begin(), names.end());
        std::vector<std::vector<std::string>> rows;
        for (const Run& run : sweep) {
            std::vector<std::string> row{std::to_string(run.nodes)};
            for (const std::string& name : names)
                row.push_back(fmt::format("{:.3f}", run.levels.at(name)[0].mean()));
            rows.push_back(row);
        }
        const std::string part = sweep.size() < measured.nodes.size()
                                     ? ", " + interrupted_after(sweep.size(), measured.nodes.size(), "rows")
                                 : sweep.back().is_complete() ? ""
                                                              : ", the last row " + frames_of(sweep.back());
        fmt::print("motion '{}': mean ratio of the root against simulation nodes{}\n\n{}\n", measured.motions[0], part,
                   table(header, rows));
    }
    fmt::print("box: extrema at the vertices' actual weights; interval: weight intervals; method:\n"
               "all else, negative where the method knows more of the weights than intervals do.\n"
               "The paper's root: 1.5 on average, 2.5 at most, up to 68 times tighter than spheres.\n\n");
    print(figures);
    fmt::print("\n{}\n", describe(from));
}

} // namespace

int tightness(const TightnessOptions& given)
{
    TightnessOptions options = given;
    if (options.methods.empty())
        options.methods = usual;
    const int threads = options.threads > 0 ? options.threads : tbb::info::default_concurrency();
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    std::vector<std::string> names;
    for (const Methods methods : options.methods)
        names.push_back(name_of(methods));
    const Provenance from = provenance(threads, options.input.seed);
    RecordOutput output(options.output, from);
    const Input first = load_input(options.input);
    output.describe(fields_of(first));
    const bool scripted = !first.simulation_nodes_fixed;
    if (!options.nodes.empty() && !scripted)
        throw InputError(
            "--sweep needs a shape or a mesh without --weights; this input brings its own simulation nodes");
    std::vector<std::string> motions{options.input.motion};
    if (scripted && !first.simulated && options.input.motion.empty())
        motions = {"strong", "mild"};
    if (options.nodes.empty() && first.simulated && scripted)
        options.nodes = {65, 128, 225, 512}; // fewer may leave nothing to pin
    else if (options.nodes.empty() && scripted)
        options.nodes = {8, 16, 32, 65, 128, 225, 512};

    catch_interrupt();
    Measured measured{names, motions, options.nodes, {}, {}};
    try {
        measure_all(options, measured);
    } catch (const Interrupted&) { // what was measured is kept
    }
    const Completeness completeness = measured.completeness(first.clip.frame_count());
    std::vector<nlohmann::ordered_json> records;
    for (const auto* runs : {&measured.full, &measured.sweep})
        for (const Run& run : *runs)
            for (const std::string& name : names)
                for (std::size_t l = 0; l < run.levels.at(name).size(); ++l)
                    records.push_back(record(first, run, name, l, runs == &measured.full));
    std::vector<Figure> figures;
    for (const Run& run : measured.full)
        add_figures(run, figures);
    if (const auto best = std::find(names.begin(), names.end(), "best");
        best != names.end() && completeness.complete && measured.sweep.size() > 1) {
        const std::vector<Run>& sweep = measured.sweep;
        const double few = sweep.front().levels.at("best")[0].mean(), many = sweep.back().levels.at("best")[0].mean();
        figures.push_back({fmt::format("root ratio of best, n = {} / n = {}", sweep.back().nodes, sweep.front().nodes),
                           fmt::format("{:.3f}", many / few), "< 1", many < few});
    }
    for (const Figure& f : figures)
        records.push_back({{"experiment", "tightness"},
                           {"input", first.name},
                           {"figure", f.what},
                           {"measured", f.measured},
                           {"target", f.target},
                           {"reached", f.reached}});
    output.set(completeness);
    output.add_all(records);
    output.finish();
    if (!options.output.records_only())
        print_tables(measured, figures, completeness, first, options, from);
    if (measured.violated) {
        fmt::print(stderr, "cinch: a bound is violated; 'cinch verify' says which\n");
        return 1;
    }
    if (!completeness.complete) {
        std::fflush(stdout);
        fmt::print(stderr, "cinch: {}\n", completeness.note);
        return 130;
    }
    return 0;
}

} // namespace cinch
