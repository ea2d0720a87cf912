// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/tightness/tables.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "experiments/input.hpp"
#include "experiments/report/number.hpp"
#include "experiments/report/table.hpp"

namespace cinch {
namespace {

using Json = nlohmann::ordered_json;

// A sum over the measured BVs as their mean, as text and as JSON.
std::string share(const LevelRatio& level, double sum)
{
    return level.measured ? fmt::format("{:.3f}", sum / static_cast<double>(level.measured)) : "-";
}

Json json_share(const LevelRatio& level, double sum)
{
    return level.measured ? Json(sum / static_cast<double>(level.measured)) : Json();
}

Json record(const TightnessResult& result, const TightnessRun& run, const std::string& method, std::size_t level)
{
    const LevelRatio& l = run.levels.at(method)[level];
    Json out{{"experiment", "tightness"},
             {"input", result.input},
             {"motion", run.motion},
             {"method", method},
             {"n", run.nodes},
             {"level", level},
             {"bvs", l.bvs},
             {"mean_ratio", json_share(l, l.sum)},
             {"max_ratio", l.measured ? Json(l.max) : Json()},
             {"frames_done", run.frames_done},
             {"frames", run.frames},
             {"complete", run.is_complete()}};
    if (run.attributed)
        out.update({{"box_loss", json_share(l, l.loss.box)},
                    {"interval_loss", json_share(l, l.loss.interval)},
                    {"method_loss", json_share(l, l.loss.corner)}});
    return out;
}

std::string frames_of(const TightnessRun& run)
{
    return run.is_complete() ? counted(run.frames, "frame", "frames")
                             : interrupted_after(run.frames_done, run.frames, "frames");
}

void print_levels(const TightnessRun& run, const std::vector<std::string>& names)
{
    fmt::print("motion '{}', {}, {}: mean ratio by level\n\n", run.motion,
               counted(run.nodes, "simulation node", "simulation nodes"), frames_of(run));
    std::vector<std::string> header{"level", "BVs"};
    header.insert(header.end(), names.begin(), names.end());
    std::vector<std::vector<std::string>> means, greatest, losses;
    for (std::size_t l = 0; l < run.levels.at(names[0]).size(); ++l) {
        std::vector<std::string> row{std::to_string(l), grouped(run.levels.at(names[0])[l].bvs)}, most = row;
        for (const std::string& name : names) {
            const LevelRatio& level = run.levels.at(name)[l];
            row.push_back(share(level, level.sum));
            most.push_back(level.measured ? fmt::format("{:.2f}", level.max) : "-");
        }
        means.push_back(row);
        greatest.push_back(most);
        const LevelRatio& last = run.levels.at(names.back())[l];
        losses.push_back({std::to_string(l), share(last, last.loss.box), share(last, last.loss.interval),
                          share(last, last.loss.corner)});
    }
    const std::string part = run.is_complete() ? "" : ", " + frames_of(run);
    fmt::print("{}\ngreatest ratio by level{}\n\n{}\n", table(header, means), part, table(header, greatest));
    fmt::print("what '{}' gives away, per direction, as a share of the true radius{}\n\n{}\n", names.back(), part,
               table({"level", "box", "interval", "method"}, losses));
}

void print_sweep(const TightnessResult& result)
{
    const std::vector<TightnessRun>& sweep = result.sweep;
    std::vector<std::string> header{"n"};
    header.insert(header.end(), result.methods.begin(), result.methods.end());
    std::vector<std::vector<std::string>> rows;
    for (const TightnessRun& run : sweep) {
        std::vector<std::string> row{std::to_string(run.nodes)};
        for (const std::string& name : result.methods)
            row.push_back(fmt::format("{:.3f}", run.levels.at(name)[0].mean()));
        rows.push_back(row);
    }
    const std::string part = sweep.size() < result.sweep_wanted
                                 ? ", " + interrupted_after(sweep.size(), result.sweep_wanted, "rows")
                             : sweep.back().is_complete() ? ""
                                                          : ", the last row " + frames_of(sweep.back());
    fmt::print("motion '{}': mean ratio of the root against simulation nodes{}\n\n{}\n", sweep.front().motion, part,
               table(header, rows));
}

void add_figures(const TightnessRun& run, std::vector<Figure>& figures)
{
    const auto best = run.levels.find("best");
    if (!run.is_complete() || best == run.levels.end())
        return;
    double worst = 0, greatest = 0;
    for (const LevelRatio& level : best->second) {
        worst = std::max(worst, level.mean());
        greatest = std::max(greatest, level.max);
    }
    const double root = best->second[0].mean();
    const auto figure = [&](const char* what, const char* format, double value, double target) {
        figures.push_back({fmt::format("'{}': best, {}", run.motion, what), fmt::format(fmt::runtime(format), value),
                           fmt::format("<= {:.2f}", target), value <= target});
    };
    const bool given = run.motion == "strong" || run.motion == "mild"; // others are of characters and scenes
    figure("mean ratio of its worst level", "{:.3f}", worst, given ? 1.15 : 1.12);
    figure("greatest ratio of any BV", "{:.2f}", greatest, given ? 2 : 1.8);
    figure("mean ratio of the root", "{:.3f}", root, given ? 1.10 : 1.12);
    if (const auto sphere = run.levels.find("sphere"); sphere != run.levels.end() && run.motion == "strong") {
        const double times = sphere->second[0].mean() / root, most = sphere->second[0].max / root;
        figures.push_back(
            {"'strong': sphere over best at the root, mean", fmt::format("{:.1f}", times), ">= 50", times >= 50});
        figures.push_back({"'strong': sphere at most over best", fmt::format("{:.1f}", most), "-", true});
    }
}

} // namespace

Completeness TightnessResult::completeness() const
{
    std::size_t whole = 0, done = 0;
    for (const auto* runs : {&full, &sweep})
        for (const TightnessRun& run : *runs) {
            whole += run.is_complete();
            done += run.frames_done;
        }
    Completeness out{done, frames_wanted, whole == runs_wanted, ""};
    if (!out.complete)
        out.note = interrupted_after(
            done, frames_wanted,
            fmt::format("frames ({} of {})", whole,
                        counted(runs_wanted, "motion or number of nodes", "motions and numbers of nodes")));
    return out;
}

std::vector<Figure> figures_of(const TightnessResult& result)
{
    std::vector<Figure> figures;
    if (result.input != "brain") // the targets are about this one
        return figures;
    for (const TightnessRun& run : result.full)
        add_figures(run, figures);
    const auto best = std::find(result.methods.begin(), result.methods.end(), "best");
    if (best != result.methods.end() && result.completeness().complete && result.sweep.size() > 1) {
        const double few = result.sweep.front().levels.at("best")[0].mean(),
                     many = result.sweep.back().levels.at("best")[0].mean();
        figures.push_back(
            {fmt::format("root ratio of best, n = {} / n = {}", result.sweep.back().nodes, result.sweep.front().nodes),
             fmt::format("{:.3f}", many / few), "< 1", many < few});
    }
    return figures;
}

std::vector<Json> records_of(const TightnessResult& result, const std::vector<Figure>& figures)
{
    std::vector<Json> records;
    for (const auto* runs : {&result.full, &result.sweep})
        for (const TightnessRun& run : *runs)
            for (const std::string& name : result.methods)
                for (std::size_t l = 0; l < run.levels.at(name).size(); ++l)
                    records.push_back(record(result, run, name, l));
    for (const Figure& f : figures) {
        records.push_back(record_of(f, "tightness"));
        records.back()["input"] = result.input;
    }
    return records;
}

void print_tables(const TightnessResult& result, const std::vector<Figure>& figures)
{
    print_note(result.completeness());
    for (const std::string& line : result.report)
        fmt::print("{}\n", line);
    fmt::print("bounds in {}, AABBs, at most {} per leaf; radius: half diagonal{}\n\n", result.precision,
               counted(result.leaf, "triangle", "triangles"), partial_mark(result.missing));
    for (const TightnessRun& run : result.full)
        print_levels(run, result.methods);
    if (!result.sweep.empty())
        print_sweep(result);
    fmt::print("box: extrema at the vertices' actual weights; interval: weight intervals; method:\n"
               "all else, negative where the method knows more of the weights than intervals do.\n"
               "The paper's root: 1.5 on average, 2.5 at most, up to 68 times tighter than spheres.\n\n");
    print(figures);
}

} // namespace cinch
