// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "experiments/report/page/sections.hpp"

namespace cinch {
namespace {

using html::cell;
using html::head_cell;

// Of all clips together: who fails, where, and how loose who does not is.
std::string by_formula(const std::vector<const Record*>& all)
{
    std::vector<std::string> names;
    std::map<std::string, std::vector<const Record*>> of;
    for (const Record* r : all) {
        if (of[r->word("formula")].empty())
            names.push_back(r->word("formula"));
        of[r->word("formula")].push_back(r);
    }
    std::vector<std::string> rows;
    for (const std::string& name : names) {
        std::vector<const Record*>& clips = of[name];
        const Record* worst = nullptr;
        std::size_t refuted = 0, proven = 0;
        for (const Record* r : clips) {
            proven += r->word("verdict") == "proven";
            if (r->word("verdict") != "refuted")
                continue;
            ++refuted;
            if (!worst || r->number("worst_share") > worst->number("worst_share"))
                worst = r;
        }
        std::sort(clips.begin(), clips.end(),
                  [](const Record* a, const Record* b) { return a->number("mean_ratio") < b->number("mean_ratio"); });
        rows.push_back(html::row({html::text_cell(name, "l"), html::text_cell(clips.front()->word("used_by"), "l"),
                                  html::text_cell(std::to_string(clips.size())),
                                  html::text_cell(std::to_string(proven)), html::text_cell(std::to_string(refuted)),
                                  worst ? cell(Results::number(*worst, "worst_share"),
                                               fmt::format("{:.2g} %", 100 * worst->number("worst_share")))
                                        : html::text_cell("–"),
                                  worst ? html::text_cell(worst->word("clip"), "l") : html::text_cell(""),
                                  cell(Results::number(*clips[clips.size() / 2], "mean_ratio"))}));
    }
    return html::table(
        "Every formula on all clips: proven at all real times by the exact side, or refuted by a vertex that "
        "is outside in real arithmetic. Worst: how far, of the surface’s half diagonal. Ratio: half "
        "diagonal of the bound over that of the true box, mean over a clip, median of the clips.",
        {html::row({head_cell("formula"), head_cell("as in"), head_cell("clips"), head_cell("proven"),
                    head_cell("refuted"), head_cell("worst"), head_cell("in"), head_cell("ratio")})},
        {html::block(rows)});
}

std::string of_clips(const std::vector<const Record*>& all)
{
    std::vector<std::string> blocks, rows;
    std::string of;
    auto end_block = [&] {
        if (!rows.empty())
            blocks.push_back(html::block(rows));
        rows.clear();
    };
    for (const Record* r : all) {
        const std::string clip = r->word("input") + ": " + r->word("clip");
        if (clip != of)
            end_block();
        const bool refuted = r->word("verdict") == "refuted";
        rows.push_back(html::row(
            {html::text_cell(clip == of ? "" : clip, "l"), html::text_cell(r->word("formula"), "l"),
             html::text_cell(r->word("verdict"), "l"),
             refuted ? cell(Results::number(*r, "worst_share"), fmt::format("{:.2g} %", 100 * r->number("worst_share")))
                     : html::text_cell("–"),
             refuted ? cell(Results::number(*r, "worst_time")) : html::text_cell(""),
             cell(Results::number(*r, "mean_ratio")), cell(Results::number(*r, "max_ratio")),
             cell(Results::number(*r, "ns_per_box"))}));
        of = clip;
    }
    end_block();
    return html::table("Clip by clip. Beyond: how far the worst vertex is outside, of the surface’s half diagonal; at: "
                       "when, s. ns: of one bound; a dash where one stands for the whole clip.",
                       {html::row({head_cell("clip"), head_cell("formula"), head_cell("verdict"), head_cell("beyond"),
                                   head_cell("at"), head_cell("ratio"), head_cell("greatest"), head_cell("ns")})},
                       blocks);
}

double median_ratio(const std::vector<const Record*>& all, const std::string& formula)
{
    std::vector<double> ratios;
    for (const Record* r : all)
        if (r->word("formula") == formula)
            ratios.push_back(r->number("mean_ratio"));
    std::sort(ratios.begin(), ratios.end());
    return ratios.empty() ? 0 : ratios[ratios.size() / 2];
}

// What the rows say of the formula that most engines end with.
std::string of_joint_boxes(const std::vector<const Record*>& all)
{
    const double joints = median_ratio(all, "joint-boxes"), ours = median_ratio(all, "cinch best");
    if (joints == 0 || ours == 0)
        return "";
    return html::paragraph(
        fmt::format("For one box of a character a box per joint is enough: in real arithmetic it holds in every "
                    "pose that has no morph targets, and here it is {:.2f} times the true box in size, cinch’s "
                    "default {:.2f} times. It is not enough where morph targets displace the surface, where floats "
                    "round it inward (joint-boxes-float), where few poses stand for all times (key-union, "
                    "fps-union), and where more than one box is asked for, as by a tree for collisions.",
                    joints, ours));
}

} // namespace

Section audit_section(const Results& results)
{
    std::vector<const Record*> all;
    for (const Record* r : results.where({{"experiment", "audit"}}))
        if (r->fields.contains("verdict") && r->fields.contains("formula"))
            all.push_back(r);
    Section section{"audit", "What engines’ formulas do", "", {}};
    if (!all.empty())
        section.body = of_joint_boxes(all) + by_formula(all) + of_clips(all);
    return section;
}

} // namespace cinch
