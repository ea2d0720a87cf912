// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include "cinch/environment.hpp"
#include "experiments/bake/bake_rows.hpp"
#include "experiments/bake/prove.hpp"
#include "experiments/bake/verify_times.hpp"
#include "experiments/input_checksum.hpp"
#include "experiments/report/interrupt.hpp"
#include "experiments/report/progress.hpp"
#include "experiments/verify.hpp"

namespace cinch {
namespace {

using Json = nlohmann::ordered_json;

void refuse_options_of_frames(const VerifyOptions& o)
{
    for (const auto& [given, option] : {std::pair(o.rest_shape != RestShape::aabb, "--rest"),
                                        {o.remember, "--remember"},
                                        {o.update != VerifiedUpdate::refit, "--update"},
                                        {!o.vipr.empty(), "--vipr"},
                                        {o.stats, "--stats"},
                                        {o.volume, "--volume"},
                                        {o.input.fps != 0, "--fps"}})
        if (given)
            throw InputError(fmt::format("{} is for frames; not with --times all", option));
    if (o.sabotage != Sabotage::none)
        throw InputError("--sabotage is for frames; of bounds over time it is an option of 'cinch bake'");
}

// A body made ready, whose clips are proven one by one.
class Prover {
public:
    Prover(const TimedBody& body, const VerifyOptions& options)
        : body_(body), kdop_(options.kdop), bvh_(build_bvh(body.input.surface, options.leaf ? options.leaf : 16)),
          refit_(bvh_, body.input.surface, bounds_of(options), body.targets())
    {
        bake_.whole = true;
        bake_.bounds = bounds_of(options);
        if (!options.certificate.empty())
            certificate_.emplace(options.certificate, body, bvh_, options.methods, options.kdop);
    }

    BakedBody body() const
    {
        return {body_.input.name,  body_.input.report, body_.input.missing, fields_of(body_.input), bvh_.level, 0,
                body_.clips.size()};
    }

    Rows prove_clip(std::size_t number)
    {
        const TimedClip& clip = body_.clips[number];
        const TimedMotion motion = watched(clip.motion, TimeSabotage::none);
        const auto baked = bake_clip(refit_, motion, bake_, bvh_.bvs.size() * static_cast<std::size_t>(kdop_));
        BakedClip out{
            motion.name, motion.first_s(), motion.last_s(), {}, prove(body_, clip, bvh_, kdop_, baked), {}, {}, {}};
        out.worst = worst_line(*out.verdict);
        if (certificate_)
            certificate_->add(clip, baked);
        return rows_of(out);
    }

    void commit(const exact::TimeVerdict& verdict)
    {
        if (certificate_)
            certificate_->commit(verdict);
    }

private:
    static RefitOptions bounds_of(const VerifyOptions& options)
    {
        return {
            .methods = options.methods, .kdop = options.kdop, .precision = options.precision, .passes = options.passes};
    }

    const TimedBody& body_;
    int kdop_;
    Bvh bvh_;
    IntervalRefitter refit_;
    BakeOptions bake_;
    std::optional<TimeProofFile> certificate_;
};

Json plan_of(const std::vector<TimedBody>& bodies, const std::vector<std::unique_ptr<Prover>>& provers,
             const VerifyOptions& options)
{
    std::vector<BakedBody> said;
    for (const auto& of : provers)
        said.push_back(of->body());
    Json plan = plan_of_bodies(bodies, said);
    plan.update(Json{{"method", name_of(options.methods)},
                     {"precision", name_of(options.precision)},
                     {"passes", options.passes},
                     {"kdop", options.kdop},
                     {"leaf", options.leaf}});
    return plan;
}

void print_times(const Merged& all, const OutputOptions& options, const Provenance& from,
                 const Completeness& completeness)
{
    const Json& plan = all.campaign.plan;
    const bool words = !options.records_only();
    RecordOutput output(options, from);
    output.set(completeness);
    if (words)
        print_note(completeness);
    std::vector<std::string> missing;
    std::size_t cell = 0;
    for (const Json& of : plan.at("bodies")) {
        const BakedBody body = baked_body_of(of);
        output.describe(body.fields);
        missing.insert(missing.end(), body.missing.begin(), body.missing.end());
        if (words)
            for (const std::string& line : body.report)
                fmt::print("{}\n", line);
        for (std::size_t i = 0; i < body.clips; ++i, ++cell) {
            if (all.cells[cell].empty())
                continue;
            const BakedClip clip = baked_clip_of(all.cells[cell]);
            output.add({{"experiment", "verify"},
                        {"input", body.name},
                        {"clip", clip.name},
                        {"t0", clip.first_s},
                        {"t1", clip.last_s},
                        {"bvs", body.levels.back()},
                        {"kdop", plan.at("kdop")},
                        {"method", plan.at("method")},
                        {"precision", plan.at("precision")},
                        {"bounds", clip.verdict->bounds},
                        {"proven", clip.verdict->proven()},
                        {"violated", clip.verdict->violated},
                        {"undecided", clip.verdict->undecided}});
            if (words)
                fmt::print("{}, {:.6g} to {:.6g} s: {}\n{}", clip.name, clip.first_s, clip.last_s,
                           verdict_line(*clip.verdict), clip.worst);
        }
    }
    output.finish();
    if (words)
        fmt::print("{}{}\n", verdict_line(verdict_of_clips(all)), partial_mark(missing));
}

} // namespace

int print_verify_times(const Merged& all, const OutputOptions& options)
{
    print_times(all, options, provenance_of(all.campaign), {});
    return status_of(verdict_of_clips(all));
}

int verify_all_times(const VerifyOptions& options)
{
    require_default_arithmetic();
    refuse_options_of_frames(options);
    const int threads = options.threads > 0 ? options.threads : tbb::info::default_concurrency();
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    const Provenance from = provenance(threads, options.input.seed);
    const std::vector<TimedBody> bodies = load_timed(options.input);
    const std::string& certificate = options.certificate;
    if (bodies.size() > 1 && !certificate.empty())
        throw InputError("--certificate is of one body; --body chooses it");
    if (!options.shards.folder.empty() && !certificate.empty())
        throw InputError("--certificate with --times all is written in one run, without --out");
    catch_interrupt();
    std::vector<std::unique_ptr<Prover>> provers;
    for (const TimedBody& body : bodies)
        provers.push_back(std::make_unique<Prover>(body, options));
    const auto cells = all_clips(bodies);
    const CampaignRun run =
        run_campaign(campaign_of("verify --times all", plan_of(bodies, provers, options), cells.size()), options.shards,
                     [&](std::size_t cell) { return provers[cells[cell].first]->prove_clip(cells[cell].second); });
    const exact::TimeVerdict verdict = verdict_of_clips(run.all);
    if (run.is_whole() && run.shard.count == 1)
        provers.front()->commit(verdict);
    return end_run(run, options.shards, status_of(verdict), [&] {
        print_times(run.all, options.output, options.shards.folder.empty() ? from : provenance_of(run.all.campaign),
                    run.completeness());
        if (!run.is_whole() && !certificate.empty() && !options.output.records_only())
            fmt::print("{} is not written: it would not prove the rest\n", certificate);
    });
}

} // namespace cinch
