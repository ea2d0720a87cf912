// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bake/bake.hpp"

#include <cmath>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cinch/environment.hpp"
#include "experiments/bake/bake_rows.hpp"
#include "experiments/bake/bake_targets.hpp"
#include "experiments/input_checksum.hpp"
#include "experiments/report/interrupt.hpp"
#include "experiments/report/number.hpp"

namespace cinch {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* statement_of_poses =
    "every vertex, in exact arithmetic and as computed, in every pose within the limits";

std::string statement_of(const Engine& engine)
{
    std::string out = "every vertex, in exact arithmetic and as computed";
    if (engine.float32)
        out += ", and as an engine in binary32 places it by the weights of the file";
    if (engine.joint_error > 0)
        out += fmt::format(", with joint matrices off by {:g} of their chains", engine.joint_error);
    if (engine.nlerp)
        out += ", with rotations of nlerp too";
    return out + ", at all times of [t0, t1]";
}

Json record_of(const BakedBody& body, const Json& plan, const std::string& clip, const BakedInterval& interval,
               std::size_t bv)
{
    const int kdop = plan.at("kdop");
    const double* s = interval.supports.data() + bv * static_cast<std::size_t>(kdop);
    Json record{{"experiment", "bake"},
                {"input", body.name},
                {"clip", clip},
                {"t0", interval.first_s},
                {"t1", interval.last_s},
                {"bv", bv},
                {"level", level_of(body.levels, bv)},
                {"min", {-s[1], -s[3], -s[5]}},
                {"max", {s[0], s[2], s[4]}},
                {"statement", plan.at("statement")},
                {"method", plan.at("method")},
                {"precision", plan.at("precision")},
                {"kdop", kdop}};
    if (kdop != 6)
        record["supports"] = std::vector<double>(s, s + kdop);
    return record;
}

Json record_of(const BakedBody& body, const std::string& clip, const BakedFigures& f)
{
    return {{"experiment", "bake"},
            {"input", body.name},
            {"clip", clip},
            {"time_ratio", f.time_mean},
            {"max_time_ratio", f.time_max},
            {"root_ratio", f.root},
            {"leaf_ratio", f.leaves},
            {"missed_30fps", f.missed_30fps},
            {"missed_keys", f.missed_keys},
            {"missed", f.missed_by_us},
            {"key_segments", f.key_segments},
            {"intervals", f.intervals}};
}

std::string of_box(const double* s) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", s[0], s[1], s[2]); }

std::string words_of(const BakedFigures& f)
{
    return fmt::format(
        "  time adds {:.3f} on average, {:.3f} at most; root {:.3f}, leaves {:.3f} of the truth; "
        "{:.1f} intervals for {} between keys\n  outside the union of frames at 30 fps: {:.2f} % of the half "
        "diagonal; of key times: {:.2f} %; of these bounds: {:.2f} %\n",
        f.time_mean, f.time_max, f.root, f.leaves, f.intervals, f.key_segments, 100 * f.missed_30fps,
        100 * f.missed_keys, 100 * f.missed_by_us);
}

void print_clip(const BakedClip& clip, std::string_view of)
{
    fmt::print("{}, {:.6g} to {:.6g} s:\n", clip.name, clip.first_s, clip.last_s);
    for (const BakedInterval& interval : clip.intervals) {
        const double* s = interval.supports.data();
        const double low[3] = {-s[1], -s[3], -s[5]}, high[3] = {s[0], s[2], s[4]};
        fmt::print("  {:8.4f} to {:8.4f} s  {} to {}\n", interval.first_s, interval.last_s, of_box(low), of_box(high));
    }
    if (clip.verdict)
        fmt::print("  {}\n{}", verdict_line(*clip.verdict, of), clip.worst);
    if (clip.figures)
        fmt::print("{}", words_of(*clip.figures));
}

std::vector<BakedBody> bodies_of(const Merged& all)
{
    std::vector<BakedBody> bodies;
    for (const Json& body : all.campaign.plan.at("bodies"))
        bodies.push_back(baked_body_of(body));
    return bodies;
}

void print_bake(const Merged& all, const OutputOptions& options, const Provenance& from,
                const Completeness& completeness)
{
    const Json& plan = all.campaign.plan;
    const bool words = !options.records_only();
    const std::string_view of = plan.at("statement") == statement_of_poses ? "poses" : "times";
    RecordOutput output(options, from);
    output.set(completeness);
    if (words)
        print_note(completeness);
    std::size_t cell = 0;
    for (const BakedBody& body : bodies_of(all)) {
        output.describe(body.fields);
        if (words)
            for (const std::string& line : body.report)
                fmt::print("{}\n", line);
        std::vector<BakedFigures> figures;
        std::optional<IntervalCost> cost;
        for (std::size_t i = 0; i < body.clips; ++i, ++cell) {
            if (all.cells[cell].empty())
                continue;
            const BakedClip clip = baked_clip_of(all.cells[cell]);
            for (const BakedInterval& interval : clip.intervals)
                for (std::size_t bv = 0; bv < body.written; ++bv)
                    output.add(record_of(body, plan, clip.name, interval, bv));
            if (words)
                print_clip(clip, of);
            if (clip.figures) {
                output.add(record_of(body, clip.name, *clip.figures));
                figures.push_back(*clip.figures);
            }
            if (clip.cost)
                cost = clip.cost;
        }
        if (!figures.empty()) {
            const std::vector<Figure> reached =
                time_targets(figures, cost.value_or(IntervalCost()), body.levels.back());
            for (const Figure& figure : reached)
                output.add(record_of(figure, "bake"));
            if (words)
                print(reached);
        }
        if (words)
            fmt::print("{} of {} BVs written; one box of '{}' holds {}{}\n", grouped(body.written),
                       grouped(body.levels.back()), plan.at("method").get<std::string>(),
                       plan.at("statement").get<std::string>(), partial_mark(body.missing));
    }
    output.finish();
    if (words && plan.at("prove"))
        fmt::print("{}\n", verdict_line(verdict_of_clips(all), of));
}

// A body made ready, with which its clips are baked one by one.
class Baker {
public:
    Baker(const TimedBody& body, const BakeOptions& options)
        : body_(body), options_(options), bvh_(build_bvh(body.input.surface, options.leaf)),
          refit_(bvh_, body.input.surface, options.bounds, body.targets())
    {
        if (!options.certificate.empty())
            certificate_.emplace(options.certificate, body, bvh_, options.bounds.methods, options.bounds.kdop);
    }

    BakedBody body() const
    {
        return {body_.input.name,       body_.input.report, body_.input.missing,
                fields_of(body_.input), bvh_.level,         bvs_down_to(bvh_, options_.level),
                body_.clips.size()};
    }

    Rows bake(std::size_t number)
    {
        const TimedClip& source = body_.clips[number];
        const TimedMotion motion = watched(source.motion, options_.sabotage);
        const auto k = static_cast<std::size_t>(options_.bounds.kdop);
        BakedClip clip{motion.name, motion.first_s(), motion.last_s(), {}, {}, {}, {}, {}};
        clip.intervals = bake_clip(refit_, motion, options_, bvh_.bvs.size() * k);
        if (certificate_)
            certificate_->add(source, clip.intervals);
        if (options_.prove) {
            clip.verdict = prove(body_, source, bvh_, options_.bounds.kdop, clip.intervals);
            clip.worst = worst_line(*clip.verdict);
        }
        if (options_.report) {
            clip.figures =
                figures_of(body_.input.surface, bvh_, body_.targets(), refit_, source.motion, options_, clip.intervals);
            if (number == 0)
                clip.cost = interval_cost(body_, bvh_, options_.bounds);
        }
        for (BakedInterval& interval : clip.intervals)
            interval.supports.resize(bvs_down_to(bvh_, options_.level) * k);
        return rows_of(clip);
    }

    void commit(const exact::TimeVerdict& verdict)
    {
        if (certificate_)
            certificate_->commit(verdict);
    }

private:
    const TimedBody& body_;
    const BakeOptions& options_;
    Bvh bvh_;
    IntervalRefitter refit_;
    std::optional<TimeProofFile> certificate_;
};

Json plan_of(const std::vector<TimedBody>& bodies, const std::vector<std::unique_ptr<Baker>>& bakers,
             const BakeOptions& options)
{
    std::vector<BakedBody> said;
    for (const auto& of : bakers)
        said.push_back(of->body());
    Json plan = plan_of_bodies(bodies, said);
    plan.update(Json{{"statement", options.input.poses.empty() ? statement_of(options.engine) : statement_of_poses},
                     {"joint_error", options.engine.joint_error},
                     {"method", name_of(options.bounds.methods)},
                     {"precision", options.bounds.precision == Precision::float32 ? "float" : "double"},
                     {"passes", options.bounds.passes},
                     {"kdop", options.bounds.kdop},
                     {"leaf", options.leaf},
                     {"interval", options.interval_s},
                     {"whole", options.whole},
                     {"tolerance", options.tolerance},
                     {"prove", options.prove},
                     {"samples", options.report ? options.samples : 0},
                     {"sabotage", static_cast<int>(options.sabotage)}});
    return plan;
}

// --npz and --usd, of a body's clips.
void write_files(const Merged& all, const BakeOptions& options)
{
    const BakedBody body = bodies_of(all).front();
    std::vector<std::pair<std::string, std::vector<BakedInterval>>> clips;
    for (const Rows& cell : all.cells) {
        BakedClip clip = baked_clip_of(cell);
        clips.emplace_back(clip.name, std::move(clip.intervals));
    }
    if (!options.npz.empty())
        write_npz(options.npz, body.levels, body.written, options.bounds.kdop, clips);
    if (!options.usd.empty())
        write_usd(options.usd, clips);
}

void refuse_what_does_not_go_together(const BakeOptions& options, std::size_t bodies)
{
    const bool files = !options.npz.empty() || !options.usd.empty();
    if (bodies > 1 && (files || !options.certificate.empty()))
        throw InputError("--npz, --usd and --certificate hold one body; --body chooses it");
    if (!options.input.poses.empty() && options.report)
        throw InputError("--report is of clips; not with --poses");
    if (!options.shards.folder.empty() && !options.certificate.empty())
        throw InputError("--certificate is written in one run, without --out");
    if (!options.shards.shard.empty() && files)
        throw InputError("--npz and --usd hold all clips; with --shard there are some");
}

} // namespace

int print_bake(const Merged& all, const OutputOptions& options)
{
    print_bake(all, options, provenance_of(all.campaign), {});
    return status_of(verdict_of_clips(all));
}

int bake(const BakeOptions& options)
{
    require_default_arithmetic();
    const Provenance from = provenance(0, options.input.seed);
    const std::vector<TimedBody> bodies = load_timed(options.input, options.engine);
    refuse_what_does_not_go_together(options, bodies.size());
    catch_interrupt();
    std::vector<std::unique_ptr<Baker>> bakers;
    for (const TimedBody& body : bodies)
        bakers.push_back(std::make_unique<Baker>(body, options));
    const auto cells = all_clips(bodies);
    const CampaignRun run =
        run_campaign(campaign_of("bake", plan_of(bodies, bakers, options), cells.size()), options.shards,
                     [&](std::size_t cell) { return bakers[cells[cell].first]->bake(cells[cell].second); });
    const exact::TimeVerdict verdict = verdict_of_clips(run.all);
    const bool files = !options.npz.empty() || !options.usd.empty() || !options.certificate.empty();
    if (run.is_whole() && run.shard.count == 1 && files) {
        bakers.front()->commit(verdict);
        write_files(run.all, options);
    }
    return end_run(run, options.shards, status_of(verdict), [&] {
        print_bake(run.all, options.output, options.shards.folder.empty() ? from : provenance_of(run.all.campaign),
                   run.completeness());
        if (!run.is_whole() && files && !options.output.records_only())
            fmt::print("files were not written\n");
    });
}

} // namespace cinch
