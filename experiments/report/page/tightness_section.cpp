// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "experiments/report/page/charts.hpp"
#include "experiments/report/page/sections.hpp"

namespace cinch {
namespace {

using html::cell;
using html::figure;
using html::percent;

constexpr const char* shown_scene = "brain-pull";
constexpr std::size_t nodes = 509;

/// Of the root in the whole run, whose looseness is attributed; sweeps over simulation nodes have coarser trees.
Traced root(const Results& results, const char* method, const char* field)
{
    for (const Record* r : results.where(
             {{"experiment", "tightness"}, {"input", shown_scene}, {"method", method}, {"n", nodes}, {"level", 0}}))
        if (r->fields.contains("box_loss"))
            return Results::number(*r, field);
    return {};
}

Traced root_of_sweep(const Results& results, const char* method, std::size_t n)
{
    for (const Record* r : results.where(
             {{"experiment", "tightness"}, {"input", shown_scene}, {"method", method}, {"n", n}, {"level", 0}}))
        if (!r->fields.contains("box_loss"))
            return Results::number(*r, "mean_ratio");
    return {};
}

/// How much of what Eq. 12 gives away at the root has this cause.
Traced share(const Results& results, const char* loss)
{
    return root(results, "eq12", loss) / (root(results, "eq12", "box_loss") + root(results, "eq12", "interval_loss") +
                                          root(results, "eq12", "method_loss"));
}

std::string causes(const Results& results)
{
    const Traced box = share(results, "box_loss"), interval = share(results, "interval_loss");
    if (!box.known() || !interval.known())
        return "";
    return fmt::format(" Of what Eq. 12 gives away at the root, {} is due to transforming one rest box by every "
                       "simulation node, {} to weight intervals in place of weights, {} to the method itself; "
                       "boxes of each simulation node’s own vertices and rest support take away most of the first, so "
                       "that the default’s ratio is {} on average.",
                       percent(box), percent(interval), percent(share(results, "method_loss")),
                       figure(root(results, "best", "mean_ratio")));
}

struct Row {
    const char* label;
    const PaperFigure& paper;
    Traced eq12, best;
    bool ours_may_be_less; ///< a looseness: less is better; otherwise a gain
    html::Judgement on;
    std::string says; ///< what is concluded from it
};

/// A ratio may exceed the paper's by a quarter: the brain and how it is pulled are not the paper's own.
html::Judgement as_tight(const char* name, const Traced& ratio, const char* place, const char* column)
{
    return html::at_most(name, ratio, 1.25 * paper_figure(place, "root", column).value);
}
html::Judgement root_mean(const Results& results)
{
    return as_tight("root-mean", root(results, "eq12", "mean_ratio"), "Fig. 5", "mean");
}
html::Judgement root_most(const Results& results)
{
    return as_tight("root-most", root(results, "eq12", "max_ratio"), "Fig. 5", "max");
}
/// Spheres over Eq. 12: at least a quarter of the paper's.
html::Judgement spheres_loose(const Results& results)
{
    return html::at_least("spheres", root(results, "sphere", "max_ratio") / root(results, "eq12", "max_ratio"),
                          paper_figure("Fig. 5", "root", "spheres").value / 4);
}

std::string block_of(const Results& results, const Row& r)
{
    std::vector<std::string> rows{
        html::row({html::raw_cell(r.label, "l"), html::paper_cell(r.paper), cell(r.eq12), cell(r.paper.value / r.eq12),
                   cell(r.best), cell(r.paper.value / r.best)})};
    if (!r.eq12.known()) {
        rows.push_back(html::conclusion(6, {}, ""));
        return html::block(rows);
    }
    const bool same = r.on.is == Verdict::holds;
    std::string why = same                 ? r.says
                      : r.ours_may_be_less ? fmt::format("Eq. 12’s root is {} times as large as the paper’s.",
                                                         figure(r.eq12 / r.paper.value))
                                           : "Spheres are closer to the bounds here.";
    if (r.ours_may_be_less)
        why += same ? fmt::format(" The default’s is {}.", figure(r.best)) : causes(results);
    else
        why += fmt::format(
            " The default is up to {} times tighter than they are.{}", figure(r.best),
            same ? ""
                 : " How loose accumulated spheres are depends on how far each simulation node’s transform is from the "
                   "others over the whole surface, which here is less than in the paper’s pull.");
    rows.push_back(html::conclusion(6, {r.on}, why));
    return html::block(rows);
}

std::string attribution(const Results& results)
{
    std::vector<std::string> blocks;
    for (const char* method : {"eq12", "limited", "best"}) {
        std::vector<const Record*> levels;
        for (const Record* r :
             results.where({{"experiment", "tightness"}, {"input", shown_scene}, {"method", method}, {"n", nodes}}))
            if (r->fields.contains("box_loss"))
                levels.push_back(r);
        std::vector<std::string> rows;
        for (std::size_t i = 0; i < levels.size(); ++i)
            if (i == 0 || i == levels.size() / 2 || i + 1 == levels.size())
                rows.push_back(html::row(
                    {html::text_cell(rows.empty() ? method : "", "l"), cell(Results::number(*levels[i], "level")),
                     cell(Results::number(*levels[i], "mean_ratio")), cell(Results::number(*levels[i], "box_loss")),
                     cell(Results::number(*levels[i], "interval_loss")),
                     cell(Results::number(*levels[i], "method_loss"))}));
        if (!rows.empty())
            blocks.push_back(html::block(rows));
    }
    if (blocks.empty())
        return "";
    return "<h3>Why bounds are loose</h3>\n" +
           html::table(
               "What each step gives away, computed exactly, as a share of the true radius: boxes at the vertices’ "
               "actual weights, weight intervals in place of weights, and the method; the last is "
               "negative where a method knows more of the weights than their intervals. Root, middle and leaves.",
               {html::row({html::head_cell("method"), html::head_cell("level"), html::head_cell("mean ratio"),
                           html::head_cell("box"), html::head_cell("interval"), html::head_cell("method")})},
               blocks);
}

std::vector<Claim> tightness_claims(const Results& results)
{
    std::vector<Claim> claims;
    auto add = [&](const char* says, const char* where, std::vector<html::Judgement> on, std::string answer) {
        const bool known = html::verdict(on) != Verdict::unknown;
        claims.push_back({says, where, std::move(on), known ? std::move(answer) : ""});
    };
    const Traced mean = root(results, "eq12", "mean_ratio"), most = root(results, "eq12", "max_ratio");
    add("With 509 simulation nodes the root AABB is 1.5 times larger than the optimum on average, and at most 2.5 "
        "times.",
        "Fig. 5", {root_mean(results), root_most(results)},
        fmt::format("With Eq. 12 it is {} times larger on average and at most {} times, by the default {} and {}.",
                    figure(mean), figure(most), figure(root(results, "best", "mean_ratio")),
                    figure(root(results, "best", "max_ratio"))));
    const Traced spheres = root(results, "sphere", "max_ratio") / root(results, "eq12", "max_ratio");
    add("It is up to 68 times tighter than accumulated spheres: orders of magnitude.", "Fig. 5",
        {spheres_loose(results)},
        fmt::format("Spheres, as reconstructed here, are {} times as large as Eq. 12’s root where both are loosest, {} "
                    "times as large as the default’s.",
                    figure(spheres),
                    figure(root(results, "sphere", "max_ratio") / root(results, "best", "max_ratio"))));
    const Traced few = root_of_sweep(results, "eq12", 65), growth = mean / few,
                 spheres_growth = root(results, "sphere", "mean_ratio") / root_of_sweep(results, "sphere", 65);
    add("Tightness does not suffer from more simulation nodes, as that of accumulated deformations does.", "Section 2",
        {html::at_most("looseness-growth", growth, 1.25)},
        fmt::format("From 65 to 509 simulation nodes the mean ratio of the root is multiplied by {} with Eq. 12, by {} "
                    "with spheres, by {} with the default.{}",
                    figure(growth), figure(spheres_growth),
                    figure(root(results, "best", "mean_ratio") / root_of_sweep(results, "best", 65)),
                    growth.value <= 1.25
                        ? ""
                        : " The more simulation nodes, the further the most displaced of them carries the one rest box "
                          "of the whole BV; a box of each node’s own vertices, as in the default, shrinks with them."));
    return claims;
}

} // namespace

Section tightness_section(const Results& results)
{
    Section section{"fig-5", "Figs. 1 and 5: tightness", "", {}};
    if (!results.where({{"experiment", "tightness"}, {"input", shown_scene}, {"n", nodes}}).empty()) {
        const Traced spheres_eq12 = root(results, "sphere", "max_ratio") / root(results, "eq12", "max_ratio"),
                     spheres_best = root(results, "sphere", "max_ratio") / root(results, "best", "max_ratio");
        std::vector<std::string> blocks;
        for (const Row& row :
             {Row{"Fig. 1: root, pulled hardest", paper_figure("Fig. 1", "root", "ratio"),
                  root(results, "eq12", "max_ratio"), root(results, "best", "max_ratio"), true,
                  as_tight("root-hardest", root(results, "eq12", "max_ratio"), "Fig. 1", "ratio"),
                  "Under the largest deformation the root is about twice the optimum, or less."},
              Row{"Fig. 5: root, mean over the frames", paper_figure("Fig. 5", "root", "mean"),
                  root(results, "eq12", "mean_ratio"), root(results, "best", "mean_ratio"), true, root_mean(results),
                  "The bound stays near the optimum, at a cost linear in the simulation nodes."},
              Row{"Fig. 5: root, greatest", paper_figure("Fig. 5", "root", "max"), root(results, "eq12", "max_ratio"),
                  root(results, "best", "max_ratio"), true, root_most(results),
                  "In the loosest frame the root is within a quarter of the paper’s, or tighter."},
              Row{"Fig. 5: spheres over root, greatest", paper_figure("Fig. 5", "root", "spheres"), spheres_eq12,
                  spheres_best, false, spheres_loose(results),
                  "Spheres around accumulated deformations are looser by more than an order of magnitude."}})
            blocks.push_back(block_of(results, row));
        section.body = html::table("Radius (half diagonal) of the root’s AABB over that of the optimal one: the pulled "
                                   "brain, 30,000 vertices, 509 simulation nodes.",
                                   {html::row({html::head_cell(""), html::head_cell("paper"),
                                               html::head_cell("Eq. 12, here"), html::head_cell("paper / here"),
                                               html::head_cell("default, here"), html::head_cell("paper / here")})},
                                   blocks);
        section.body += attribution(results);
        section.claims = tightness_claims(results);
    }
    for (const auto& charts : {level_charts(results), sweep_charts(results), loss_charts(results)})
        for (const html::ChartFigure& chart : charts)
            section.body += html::chart(chart);
    return section;
}

} // namespace cinch
