// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/audit/audit.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <tbb/info.h>

#include "cinch/environment.hpp"
#include "experiments/audit/audit_rows.hpp"
#include "experiments/baselines/engines/engine_formula.hpp"
#include "experiments/input_checksum.hpp"
#include "experiments/measure/race.hpp"
#include "experiments/records/json_number.hpp"
#include "experiments/report/number.hpp"
#include "experiments/report/table.hpp"
#include "experiments/report/view.hpp"

namespace cinch {
namespace {

using Json = nlohmann::ordered_json;

// A body of a file, with the clips that are its cells.
struct AuditedBody {
    std::string name;
    std::vector<std::string> report, missing;
    Json fields;
    std::size_t clips = 0, joints = 0;
};

Json to_json(const AuditedBody& body)
{
    return {{"input", body.name},    {"report", body.report}, {"missing", body.missing},
            {"fields", body.fields}, {"clips", body.clips},   {"joints", body.joints}};
}

AuditedBody body_of(const Json& from)
{
    return {from.at("input"),  from.at("report"), from.at("missing"),
            from.at("fields"), from.at("clips"),  from.at("joints")};
}

Json plan_of(const std::vector<TimedBody>& bodies, const AuditOptions& options)
{
    Json all = Json::array();
    std::uint64_t sum = checksum_of_nothing;
    for (const TimedBody& body : bodies) {
        all.push_back(to_json(AuditedBody{body.input.name, body.input.report, body.input.missing, fields_of(body.input),
                                          body.clips.size(), body.input.surface.weights.node_count}));
        sum = checksum_of(body, sum);
    }
    Json outside = Json::object();
    for (const OutsideMethod& method : options.outside)
        outside[method.name] = method.command;
    return {{"bodies", all},
            {"checksum", sum},
            {"samples", options.samples},
            {"seconds", options.seconds},
            {"outside", outside}};
}

// What was found, a formula of a clip after the other.
struct Found {
    AuditedBody body;
    std::string clip;
    AuditedFormula formula;
};

std::vector<Found> all_of(const Merged& all)
{
    std::vector<Found> out;
    std::size_t cell = 0;
    for (const Json& of : all.campaign.plan.at("bodies")) {
        const AuditedBody body = body_of(of);
        for (std::size_t i = 0; i < body.clips; ++i, ++cell)
            for (const Json& row : all.cells[cell])
                out.push_back({body, row.at("clip"), audited_formula_of(row)});
    }
    return out;
}

Json record_of(const Found& found)
{
    const AuditedFormula& f = found.formula;
    Json record{{"experiment", "audit"},
                {"input", found.body.name},
                {"clip", found.clip},
                {"formula", f.formula},
                {"used_by", f.used_by},
                {"verdict", name_of(f.verdict)},
                {"violated", f.verdict == AuditVerdict::refuted},
                {"instants", f.instants},
                {"worst_overflow", f.worst ? or_null(f.worst->beyond) : Json()},
                {"worst_share", f.worst ? or_null(f.worst_share) : Json()},
                {"worst_time", f.worst ? Json(f.worst->time_s) : Json()},
                {"worst_vertex", f.worst ? Json(f.worst->vertex) : Json()},
                {"worst_direction", f.worst ? Json(f.worst->direction) : Json()},
                {"bound", f.worst ? or_null(f.worst->bound) : Json()},
                {"centre", Json()},
                {"mean_ratio", or_null(f.mean_ratio)},
                {"max_ratio", or_null(f.max_ratio)},
                {"ns_per_box", f.ns ? Json(f.ns->value) : Json()},
                {"ns_per_box_low", f.ns ? Json(f.ns->low) : Json()},
                {"ns_per_box_high", f.ns ? Json(f.ns->high) : Json()},
                {"ns_per_joint", f.ns ? Json(f.ns->value / static_cast<double>(found.body.joints)) : Json()}};
    if (f.worst && f.worst->direction < 0)
        record["centre"] = {or_null(f.worst->centre[0]), or_null(f.worst->centre[1]), or_null(f.worst->centre[2])};
    return record;
}

std::string said_of(const AuditedFormula& f)
{
    return f.verdict == AuditVerdict::holds ? fmt::format("holds at {}", f.instants) : name_of(f.verdict);
}

std::string share_of(double share)
{
    return share >= 1e-4 ? fmt::format("{:.2f} %", 100 * share) : fmt::format("{:.0e}", share);
}

void print_table(const std::vector<Found>& found, std::size_t first, std::size_t last)
{
    std::vector<std::vector<std::string>> lines;
    std::size_t number = 0; // of counterexamples, as --show has them
    for (std::size_t i = 0; i < first; ++i)
        number += found[i].formula.worst.has_value();
    for (std::size_t i = first; i < last; ++i) {
        const AuditedFormula& f = found[i].formula;
        lines.push_back({f.formula, said_of(f), f.worst ? std::to_string(++number) : "",
                         f.worst ? share_of(f.worst_share) : "-",
                         f.worst ? fmt::format("{:.3f}", f.worst->time_s) : "-", fmt::format("{:.3f}", f.mean_ratio),
                         fmt::format("{:.3f}", f.max_ratio),
                         f.ns ? grouped(static_cast<std::size_t>(f.ns->value + 0.5)) + mark(*f.ns) : "-"});
    }
    fmt::print("{}\n", table({"formula", "verdict", "#", "beyond", "at s", "mean", "max", "ns"}, lines));
}

void print_legend()
{
    fmt::print("verdict: proven, at all real times by the exact side (to rounding: of a bound 2^-40\n"
               "larger); holds at so many instants, each decided exactly; refuted by a vertex outside,\n"
               "in real arithmetic (--show # has it).\n"
               "beyond: by how much of the surface's half diagonal. mean, max: half diagonal of the\n"
               "bound (of a ball the radius) over that of the true box, at instants. ns: per bound.\n\n");
    for (const EngineFormula& formula : engine_formulas())
        fmt::print("{} ({}): {}\n", formula.name, formula.used_by, formula.says);
    fmt::print("\n");
}

void print_summary(const std::vector<Found>& found)
{
    std::vector<std::string> names;
    for (const Found& f : found)
        if (std::find(names.begin(), names.end(), f.formula.formula) == names.end())
            names.push_back(f.formula.formula);
    std::vector<std::vector<std::string>> lines;
    for (const std::string& name : names) {
        std::size_t clips = 0, refuted = 0, proven = 0;
        double worst = 0;
        std::vector<double> ratios;
        for (const Found& f : found)
            if (f.formula.formula == name) {
                ++clips;
                refuted += f.formula.verdict == AuditVerdict::refuted;
                proven += f.formula.verdict == AuditVerdict::proven;
                worst = std::max(worst, f.formula.worst ? f.formula.worst_share : 0);
                ratios.push_back(f.formula.mean_ratio);
            }
        std::sort(ratios.begin(), ratios.end());
        lines.push_back({name, std::to_string(clips), std::to_string(proven), std::to_string(refuted),
                         refuted ? share_of(worst) : "-", fmt::format("{:.3f}", ratios[ratios.size() / 2])});
    }
    fmt::print("{}\n", table({"formula", "clips", "proven", "refuted", "worst", "median ratio"}, lines));
}

void print_audit(const Merged& all, const OutputOptions& options, const Provenance& from,
                 const Completeness& completeness, const Json& view)
{
    const std::vector<Found> found = all_of(all);
    RecordOutput output(options, from);
    output.set(completeness);
    std::string described;
    for (const Found& f : found) {
        if (f.body.name != described)
            output.describe(f.body.fields);
        described = f.body.name;
        output.add(record_of(f));
    }
    if (!view.is_null())
        output.add({{"experiment", "view"}, {"scene", view["scene"]}, {"view", view}});
    output.finish();
    if (options.records_only())
        return;
    print_note(completeness);
    std::string of;
    for (std::size_t i = 0; i < found.size();) {
        std::size_t last = i;
        while (last < found.size() && found[last].body.name == found[i].body.name && found[last].clip == found[i].clip)
            ++last;
        if (found[i].body.name != of)
            for (const std::string& line : found[i].body.report)
                fmt::print("{}\n", line);
        of = found[i].body.name;
        fmt::print("\n{}: {}{}\n\n", of, found[i].clip, partial_mark(found[i].body.missing));
        print_table(found, i, last);
        i = last;
    }
    fmt::print("all clips\n\n");
    print_summary(found);
    print_legend();
    fmt::print("{}\n", describe(from));
}

// Whether a view can compute it.
bool is_drawn(const std::string& formula)
{
    const auto& all = engine_formulas();
    return std::any_of(all.begin(), all.end(), [&](const EngineFormula& f) { return f.name == formula; });
}

// The character in the box that it is farthest outside of, at that time, to look at.
Json view_of_worst(const std::vector<Found>& found, const AuditOptions& options)
{
    const Found* worst = nullptr;
    for (const Found& f : found)
        if (f.formula.worst && is_drawn(f.formula.formula) &&
            (!worst || f.formula.worst_share > worst->formula.worst_share))
            worst = &f;
    if (!worst)
        return {};
    ViewRequest request;
    request.scene = worst->body.name;
    request.title = worst->formula.formula + ", " + worst->clip;
    request.text =
        fmt::format("{} ({}): {} of the half diagonal outside at {:.3f} s, and what else bounds the character.",
                    worst->formula.formula, worst->formula.used_by, share_of(worst->formula.worst_share),
                    worst->formula.worst->time_s);
    request.clip = worst->clip;
    request.weights = options.input.weights;
    request.transforms = options.input.transforms;
    request.partial = options.input.partial;
    request.formulas = {worst->formula.formula};
    for (const Found& f : found)
        if (f.body.name == worst->body.name && f.clip == worst->clip && is_drawn(f.formula.formula) &&
            f.formula.formula != worst->formula.formula)
            request.formulas.push_back(f.formula.formula);
    request.methods = {Method::best};
    request.swept = true;
    request.formula_first = true;
    request.level = 0;
    request.surface = "glass";
    Json view = make_view(request);
    // The frame nearest to the counterexample's time.
    const auto times = view["time_s"].get<std::vector<double>>();
    std::size_t nearest = 0;
    for (std::size_t f = 0; f < times.size(); ++f)
        if (std::abs(times[f] - worst->formula.worst->time_s) < std::abs(times[nearest] - worst->formula.worst->time_s))
            nearest = f;
    view["first"]["frame"] = nearest;
    return view;
}

std::string fraction(double x) { return fmt::format("{:.17g} ({:a})", x, x); }

int show(const std::vector<Found>& found, std::size_t number)
{
    std::size_t seen = 0;
    for (const Found& f : found) {
        if (!f.formula.worst || ++seen != number)
            continue;
        const Counterexample& c = *f.formula.worst;
        fmt::print("{}, {}: {} ({})\n", f.body.name, f.clip, f.formula.formula, f.formula.used_by);
        fmt::print("at t = {} s, vertex {} is, in real arithmetic, at\n", fraction(c.time_s), c.vertex);
        for (std::size_t r = 0; r < 3; ++r)
            fmt::print("  {} in [{:.17g}, {:.17g}]\n", "xyz"[r], c.place[r].low, c.place[r].high);
        if (c.direction < 0)
            fmt::print("outside the ball about ({:.17g}, {:.17g}, {:.17g}) of radius {}\n", c.centre[0], c.centre[1],
                       c.centre[2], fraction(c.bound));
        else
            fmt::print("outside the box: {} {} {}\n", "xyz"[c.direction / 2],
                       c.direction % 2 ? ">=" : "<=", fraction(c.direction % 2 ? -c.bound : c.bound));
        fmt::print("by {:.3g}, {} of the surface's half diagonal then\n", c.beyond, share_of(f.formula.worst_share));
        return 0;
    }
    throw InputError(fmt::format("--show {}: there {} {}", number, seen == 1 ? "is" : "are",
                                 counted(seen, "counterexample", "counterexamples")));
}

} // namespace

int print_audit(const Merged& all, const OutputOptions& options)
{
    print_audit(all, options, provenance_of(all.campaign), {}, {});
    return 0;
}

int audit(const AuditOptions& options)
{
    require_default_arithmetic();
    const Provenance from = provenance(tbb::info::default_concurrency(), options.input.seed);
    RecordOutput(options.output, from); // what cannot be written is said before measuring
    std::vector<TimedBody> bodies;
    for (const std::string& name : options.inputs) {
        InputOptions what = options.input;
        what.input = name;
        for (TimedBody& body : load_timed(what))
            bodies.push_back(std::move(body));
    }
    catch_interrupt();
    const auto cells = all_clips(bodies);
    const CampaignRun run = run_campaign(campaign_of("audit", plan_of(bodies, options), cells.size()), options.shards,
                                         [&](std::size_t cell) {
                                             const TimedBody& body = bodies[cells[cell].first];
                                             const TimedClip& clip = body.clips[cells[cell].second];
                                             return rows_of(audit_clip(body, clip, options), clip.motion.name);
                                         });
    if (options.show)
        return show(all_of(run.all), options.show);
    return end_run(run, options.shards, 0, [&] {
        const bool draw = !options.output.report.empty() && !options.output.records_only() && run.is_whole();
        print_audit(run.all, options.output, options.shards.folder.empty() ? from : provenance_of(run.all.campaign),
                    run.completeness(), draw ? view_of_worst(all_of(run.all), options) : Json());
    });
}

} // namespace cinch
