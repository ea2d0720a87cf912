// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/page/charts.hpp"

#include <algorithm>
#include <functional>

#include <fmt/format.h>

namespace cinch {
namespace {

using html::ChartFigure;
using html::escaped;

// Charts under construction by title, and their series by name, in the order in which they come.
class Charts {
public:
    ChartFigure& at(const Chart& kind, const std::string& caption)
    {
        const auto found =
            std::find_if(all_.begin(), all_.end(), [&](const ChartFigure& c) { return c.chart.title == kind.title; });
        return found != all_.end() ? *found : all_.emplace_back(ChartFigure{kind, caption, {}});
    }
    static void point(ChartFigure& figure, const std::string& series, double x, double y, const Source& from,
                      bool points_only = false)
    {
        if (!std::isfinite(x) || !std::isfinite(y))
            return;
        auto& all = figure.chart.series;
        auto found = std::find_if(all.begin(), all.end(), [&](const Series& s) { return s.name == series; });
        if (found == all.end())
            found = all.insert(all.end(), Series{series, {}, {}, points_only, {}, {}});
        found->x.push_back(x);
        found->y.push_back(y);
        if (figure.from.empty() || figure.from.back() != from)
            figure.from.push_back(from);
    }
    std::vector<ChartFigure> drawn() // those with a line to see
    {
        std::erase_if(all_, [](const ChartFigure& c) {
            return std::none_of(c.chart.series.begin(), c.chart.series.end(),
                                [](const Series& s) { return s.points_only || s.x.size() > 1; });
        });
        return std::move(all_);
    }

private:
    std::vector<ChartFigure> all_;
};

std::string run_of(const Record& r) // of tightness
{
    return fmt::format("{}{}{}, {} nodes", r.word("input"), r.word("motion").empty() ? "" : ", ", r.word("motion"),
                       html::digits(r.number("n")));
}

} // namespace

std::vector<ChartFigure> scaling_charts(const Results& results)
{
    Charts charts;
    for (const Record* r : results.where({{"experiment", "scaling"}})) {
        const std::string input = r->word("input"), method = r->word("method");
        if (method.empty() || (input.empty() && r->number("vertices") != 30000))
            continue;
        const std::string what = input.empty() ? "the brain, 30,000 vertices" : input;
        ChartFigure& chart =
            charts.at({"Time of one bound: " + what, "simulation nodes n", "µs for six directions", true, true, {}},
                      fmt::format("Time of one bound of the whole of {} (six directions) against the number of "
                                  "simulation nodes, one core.",
                                  escaped(what)));
        Charts::point(chart, method, r->number("n"), r->number("ns_per_bound") / 1e3, r->at);
    }
    return charts.drawn();
}

std::vector<ChartFigure> level_charts(const Results& results)
{
    Charts charts;
    for (const bool mean : {true, false})
        for (const Record* r : results.where({{"experiment", "tightness"}}))
            if (r->fields.contains("box_loss")) {
                const std::string run = run_of(*r);
                ChartFigure& chart = charts.at(
                    {fmt::format("{} ratio by level: {}", mean ? "Mean" : "Greatest", run),
                     "BVH level (0: root)",
                     "bound radius / true radius",
                     false,
                     true,
                     {}},
                    fmt::format("{} ratio of bound radius to true radius over the frames, by level of the BVH: {}.",
                                mean ? "Mean" : "Greatest", escaped(run)));
                Charts::point(chart, r->word("method"), r->number("level"),
                              r->number(mean ? "mean_ratio" : "max_ratio"), r->at);
            }
    return charts.drawn();
}

std::vector<ChartFigure> sweep_charts(const Results& results)
{
    Charts charts;
    for (const Record* r : results.where({{"experiment", "tightness"}, {"level", 0}}))
        if (!r->fields.contains("box_loss")) {
            const std::string run =
                fmt::format("{}{}{}", r->word("input"), r->word("motion").empty() ? "" : ", ", r->word("motion"));
            ChartFigure& chart = charts.at(
                {"Ratio of the root: " + run, "simulation nodes n", "bound radius / true radius", true, true, {}},
                fmt::format("Mean ratio of the root against the number of simulation nodes: {}.", escaped(run)));
            Charts::point(chart, r->word("method"), r->number("n"), r->number("mean_ratio"), r->at);
        }
    return charts.drawn();
}

std::vector<ChartFigure> loss_charts(const Results& results)
{
    Charts charts;
    for (const Record* r : results.where({{"experiment", "tightness"}}))
        if (r->fields.contains("box_loss") && (r->word("method") == "eq12" || r->word("method") == "best")) {
            const std::string run = run_of(*r);
            ChartFigure& chart = charts.at(
                {"What is lost: " + run, "BVH level (0: root)", "loss per direction / true radius", false, false, {}},
                fmt::format("What the paper’s Eq. 12 and the default give away, by exact attribution, as a share of "
                            "the true radius: {}.",
                            escaped(run)));
            for (const auto& [field, name] : {std::pair("box_loss", "box"), std::pair("interval_loss", "interval"),
                                              std::pair("method_loss", "method")})
                Charts::point(chart, r->word("method") + ": " + name, r->number("level"), r->number(field), r->at);
        }
    return charts.drawn();
}

std::vector<ChartFigure> cost_charts(const Results& results)
{
    Charts charts;
    for (const bool of_root : {false, true}) {
        std::vector<const Record*> rows;
        for (const Record* r : results.where({{"experiment", "cost"}, {"kdop", 6}}))
            if (!r->word("arithmetic").empty() && r->fields.contains("level") == of_root)
                rows.push_back(r);
        const auto chart_of = [&](const Record& r) -> ChartFigure& {
            const std::string what = r.word("input");
            return of_root
                       ? charts.at({"From one bound to the true box: the root of " + what + ", 6-DOP",
                                    "µs",
                                    "bound radius / true radius",
                                    true,
                                    false,
                                    {}},
                                   fmt::format("A bound of the root that tightens by branch and bound down the tree, "
                                               "and the box of all vertices: looseness against time, {}, six "
                                               "directions, one core.",
                                               escaped(what)))
                       : charts.at({"What accuracy costs: " + what + ", 6-DOP",
                                    "µs per BV",
                                    "bound radius / true radius",
                                    true,
                                    true,
                                    {}},
                                   fmt::format("Every method in every arithmetic: looseness against time, {}, six "
                                               "directions, one core. Lower left is better; of what is on the line, "
                                               "nothing else is as fast, as tight and as well proven.",
                                               escaped(what)));
        };
        const auto point = [&](const Record& r, const std::string& series, bool points_only) {
            Charts::point(chart_of(r), series, r.number("ns_per_bound") / 1e3, r.number("mean_ratio"), r.at,
                          points_only);
        };
        for (const Record* r : rows)
            if (const bool is_anytime = r->word("method") == "anytime"; of_root)
                point(*r, is_anytime ? "anytime" : "vertices, " + r->word("arithmetic"), !is_anytime);
            else
                point(*r, r->word("arithmetic"), true);
        std::erase_if(rows, [](const Record* r) { return !r->fields.value("pareto", false); });
        std::ranges::stable_sort(rows, {}, [](const Record* r) { return r->number("ns_per_bound"); });
        for (const Record* r : rows)
            point(*r, "Pareto-optimal", of_root);
    }
    return charts.drawn();
}

std::vector<ChartFigure> simulation_charts(const Results& results)
{
    Charts charts;
    for (const Record* r : results.where({{"experiment", "cost"}})) {
        const std::string scene = r->word("simulation");
        if (scene.empty())
            continue;
        ChartFigure& chart = charts.at(
            {"Error against time: " + scene, "seconds per simulated second", "relative error", true, true, {}},
            fmt::format("Error of the simulation nodes’ positions at the end against computing time, {}.",
                        escaped(scene)));
        Charts::point(chart, r->word("energy") + ", " + r->word("integrator"),
                      r->number("seconds_per_simulated_second"), r->number("error"), r->at);
    }
    return charts.drawn();
}

std::vector<ChartFigure> collide_charts(const Results& results)
{
    Charts charts;
    for (const Record* r : results.where({{"experiment", "collide"}})) {
        const auto pairs = r->fields.find("pairs_of_frame"), ms = r->fields.find("total_ms_of_frame");
        if (pairs == r->fields.end() || ms == r->fields.end() || !pairs->is_array() || !ms->is_array() ||
            pairs->size() != ms->size())
            continue;
        const std::string scene = r->word("scene");
        ChartFigure& chart = charts.at(
            {scene + ": time per frame", "intersecting triangle pairs in the frame", "ms per frame", false, true, {}},
            fmt::format(
                "Time of a frame against its intersecting pairs of triangles, {}; a point per frame and backend.",
                escaped(scene)));
        for (std::size_t f = 0; f < pairs->size(); ++f)
            if ((*pairs)[f].is_number() && (*ms)[f].is_number())
                Charts::point(chart, r->word("backend"), (*pairs)[f].get<double>(), (*ms)[f].get<double>(), r->at,
                              true);
    }
    return charts.drawn();
}

std::vector<ChartFigure> verify_charts(const Results& results)
{
    Charts charts;
    for (const Record* r : results.where({{"experiment", "verify"}}))
        if (r->fields.contains("level") && r->fields.contains("mean_ratio")) {
            const std::string what =
                fmt::format("{}, {}, {}-DOP", r->word("input"), r->word("method"), html::digits(r->number("kdop")));
            ChartFigure& chart = charts.at(
                {"Ratio by level: " + what, "BVH level (0: root)", "bound radius / true radius", false, false, {}},
                fmt::format("Ratio of bound radius to true radius by level of the BVH: {}.", escaped(what)));
            Charts::point(chart, "mean", r->number("level"), r->number("mean_ratio"), r->at);
            Charts::point(chart, "greatest", r->number("level"), r->number("max_ratio"), r->at);
        }
    return charts.drawn();
}

std::vector<ChartFigure> charts_of(const Results& results)
{
    std::vector<ChartFigure> all;
    for (const auto& charts :
         {scaling_charts(results), level_charts(results), sweep_charts(results), loss_charts(results),
          cost_charts(results), simulation_charts(results), collide_charts(results), verify_charts(results)})
        all.insert(all.end(), charts.begin(), charts.end());
    return all;
}

} // namespace cinch
