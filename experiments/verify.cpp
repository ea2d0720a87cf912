// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/verify.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include "cinch/refit.hpp"
#include "cinch/surface.hpp"
#include "exact/certificate.hpp"
#include "experiments/certificate_parts.hpp"
#include "experiments/records/run_campaign.hpp"
#include "experiments/report/interrupt.hpp"
#include "experiments/report/line_file.hpp"
#include "experiments/report/or_leave.hpp"
#include "experiments/report/progress.hpp"
#include "experiments/report/whole_file.hpp"
#include "experiments/verify_lazy.hpp"
#include "experiments/verify_report.hpp"
#include "experiments/verify_rows.hpp"
#include "toolkit/bounds/rounding.hpp"
#include "toolkit/deform/dyadic.hpp"

namespace cinch {

void damage(Bvh& bvh, Sabotage sabotage)
{
    for (std::size_t i = 0; i < bvh.node.size();
         ++i) { // the first interval with room in it, so one of the root's if there is one
        if (!(bvh.l[i] < bvh.h[i]))
            continue;
        if (sabotage == Sabotage::swap_interval)
            std::swap(bvh.l[i], bvh.h[i]);
        else if (sabotage == Sabotage::lower_h)
            bvh.h[i] -= weight_unit;
        return;
    }
}

namespace {

// limited ≤ eq12 ≤ convex on the doubles of every frame, and where the method is the default, that it is not clearly
// looser than eq12.
class Ladder {
public:
    Ladder(const Bvh& bvh, const DeformableSurface& surface, const RefitOptions& options,
           std::span<const MorphTarget> targets)
        : is_default_(options.methods == Method::best && options.rest_shape == RestShape::aabb),
          looser_(bvh.bvs.size() * static_cast<std::size_t>(options.kdop)), tighter_(looser_)
    {
        for (const Method method : ladder_methods) {
            RefitOptions rung = options;
            rung.methods = method;
            rungs_.emplace_back(bvh, surface, rung, targets);
        }
    }
    void check(std::span<const AffineMap> maps, std::span<const double> weights, std::span<const double> supports,
               LadderTotals& totals)
    {
        rungs_[0](maps, weights, looser_);
        for (std::size_t r = 1; r < rungs_.size(); ++r) {
            throw_if_interrupted();
            rungs_[r](maps, weights, tighter_);
            for (std::size_t i = 0; i < looser_.size(); ++i)
                totals.broken += !(tighter_[i] <= looser_[i]);
            totals.compared += looser_.size();
            looser_.swap(tighter_);
            if (r == 1 && is_default_)
                compare_default(supports, looser_, totals);
        }
    }

private:
    static void compare_default(std::span<const double> supports, std::span<const double> eq12, LadderTotals& totals)
    {
        for (std::size_t i = 0; i < supports.size(); ++i) {
            const double width = eq12[i] + eq12[i ^ 1], excess = supports[i] - eq12[i]; // NaN where both are infinite
            const double carried =
                8 * unit_roundoff * std::abs(eq12[i]); // what moving both by the body's origin may set apart
            totals.above += excess > 0;
            totals.clearly += excess > 0.01 * width + carried;
        }
        totals.defaults += supports.size();
    }

    bool is_default_;
    std::vector<double> looser_, tighter_;
    std::vector<Refitter> rungs_;
};

// In the last frame verified: the exact attribution of the root's bounds, and VIPR files of the first BV of every
// level.
void explain_last_frame(const Input& input, const Bvh& bvh, const VerifyOptions& options, std::size_t frame,
                        std::span<const double> supports, VerifyTotals& totals)
{
    if (totals.levels.empty() || options.sabotage != Sabotage::none || options.rest_shape == RestShape::obb ||
        input.clip.displaces())
        return; // damaged data need not have a proof; nor has a displaced BV one over weights
    const Clip::Frame maps = input.clip.frame(frame);
    auto place = [&](std::size_t bv, int direction) {
        return exact::OneBound{
            input.surface, bvh,
            maps,          options.methods,
            options.kdop,  bv,
            direction,     supports[bv * static_cast<std::size_t>(options.kdop) + static_cast<std::size_t>(direction)]};
    };
    for (int d = 0; (options.output.json || !options.output.report.empty()) && d < options.kdop; ++d) {
        throw_if_interrupted();
        if (const exact::OneBound root = place(0, d); std::isfinite(root.bound))
            totals.root.push_back({d, root.bound, exact::exact_loss(root)});
    }
    if (options.vipr.empty())
        return;
    for (std::size_t level = 0; level < totals.levels.size(); ++level)
        for (int d = 0; d < options.kdop; ++d) {
            throw_if_interrupted();
            if (const exact::OneBound bound = place(bvh.level[level], d); std::isfinite(bound.bound)) {
                const auto path = std::filesystem::path(options.vipr) / fmt::format("bv{}-d{}.vipr", bound.bv, d);
                write_whole(path, exact::vipr(bound));
            }
        }
}

RefitOptions refit_options(const VerifyOptions& options)
{
    const Rounding rounding = options.sabotage == Sabotage::no_rounding ? Rounding::plain : Rounding::proven;
    return {options.methods, options.kdop,       rounding,        options.precision,
            options.passes,  options.rest_shape, options.remember};
}

Bvh damaged_bvh(const DeformableSurface& surface, const VerifyOptions& options)
{
    Bvh bvh = build_bvh(surface, options.leaf);
    damage(bvh, options.sabotage);
    return bvh;
}

// What refits and verifies a body of the inputs, which it shares.
struct PreparedInput {
    PreparedInput(std::shared_ptr<const Inputs> shared, const Input& input, const VerifyOptions& options)
        : inputs(std::move(shared)), bvh(damaged_bvh(input.surface, options)),
          verifier(input.surface, bvh, throw_if_interrupted, input.targets),
          refit(bvh, input.surface, refit_options(options), input.targets),
          ladder(bvh, input.surface, refit_options(options), input.targets)
    {
    }
    std::shared_ptr<const Inputs> inputs;
    Bvh bvh;
    exact::Verifier verifier;
    Refitter refit;
    Ladder ladder;
};

exact::Claim claim_of(const Input& input, const VerifyOptions& options)
{
    return {.methods = options.methods,
            .kdop = options.kdop,
            .shape = options.rest_shape,
            .clip = input.clip.name,
            .frames = input.clip.frame_count(),
            .missing = input.missing,
            .targets = input.targets};
}

// Where the proof of a frame goes.
using FrameSink = std::function<void(const exact::FramePose& pose, std::span<const double> supports,
                                     const exact::FrameVerdict& verdict)>;

// Refits and proves every BV of one body in one frame; `supports` are its bounds.
VerifyTotals verify_frame(PreparedInput& prepared, const Input& input, const VerifyOptions& options, std::size_t f,
                          const FrameSink& proof, std::vector<double>& supports)
{
    const Bvh& bvh = prepared.bvh;
    VerifyTotals totals;
    supports.resize(bvh.bvs.size() * static_cast<std::size_t>(options.kdop));
    const Clip::Frame maps = input.clip.frame(f);
    const std::vector<double> weights = input.clip.weights(f);
    totals.unbounded_nodes = prepared.refit(maps, weights, supports).unbounded_nodes;
    const exact::FrameVerdict verdict =
        prepared.verifier.check(maps, options.methods, options.kdop, supports, options.rest_shape, weights);
    if (options.volume) {
        totals.volumes.resize(bvh.level.size() - 1);
        add_volumes(input.surface, bvh, maps, options.kdop, supports, totals.volumes);
    }
    prepared.ladder.check(maps, weights, supports, totals.ladder);
    if (proof)
        proof({input.clip.time_s(f), maps, weights}, supports, verdict);
    add_levels(bvh, totals);
    add(bvh, verdict, options.kdop, {}, totals);
    totals.infinite = static_cast<std::size_t>(
        std::count_if(supports.begin(), supports.end(), [](double s) { return std::isinf(s); }));
    totals.packed_bytes = prepared.refit.bytes();
    totals.rest_bytes = bvh.bytes();
    return totals;
}

std::unique_ptr<PreparedInput> prepare(const std::shared_ptr<const Inputs>& inputs, const Input& input,
                                       const VerifyOptions& options)
{
    return or_leave([inputs, &input, options] { return std::make_unique<PreparedInput>(inputs, input, options); });
}

// One body in every frame, on top of what `totals` has. An interrupt ends it between two frames: `totals` has whole
// ones.
void verify_body(const std::shared_ptr<const Inputs>& inputs, const Input& input, const VerifyOptions& options,
                 LineFile* certificate, VerifyTotals& totals)
{
    const std::unique_ptr<PreparedInput> prepared = prepare(inputs, input, options);
    std::optional<exact::CertificateWriter> proof;
    if (certificate)
        proof.emplace(input.surface, prepared->bvh, claim_of(input, options), [=](std::string_view text) {
            throw_if_interrupted(); // then none is written
            certificate->line(text);
        });
    const std::size_t before = totals.frames;
    Progress progress("verifying frames", totals.frames_wanted);
    std::vector<double> supports;
    for (std::size_t f = 0; f < input.clip.frame_count(); ++f) {
        throw_if_interrupted();
        const VerifyTotals frame = verify_frame(
            *prepared, input, options, f,
            proof ? FrameSink([&](auto&&... of_frame) { proof->frame(of_frame...); }) : FrameSink(), supports);
        add_row(frame_row(0, f, frame), totals);
        progress.done(totals.frames);
    }
    if (proof && totals.frames - before == input.clip.frame_count())
        proof->end();
    if (totals.frames > before)
        explain_last_frame(input, prepared->bvh, options, totals.frames - before - 1, supports, totals);
}

// Frame by frame into a folder, or those of one shard.
int verify_in_cells(const std::shared_ptr<const Inputs>& inputs, const VerifyOptions& options)
{
    std::vector<std::pair<std::size_t, std::size_t>> cells; // body and frame
    for (std::size_t body = 0; body < inputs->bodies.size(); ++body)
        for (std::size_t f = 0; f < inputs->bodies[body].clip.frame_count(); ++f)
            cells.emplace_back(body, f);
    VerifyOptions own = options;
    own.output.json = true; // whatever is printed later: the exact attribution of the root goes with the last frame
    std::unique_ptr<PreparedInput> prepared;
    std::optional<std::size_t> prepared_body;
    std::vector<double> supports;
    std::optional<CertificateParts> parts;
    if (!options.certificate.empty())
        parts.emplace(std::filesystem::path(options.shards.folder) / options.certificate);
    const CampaignRun run = run_campaign(
        campaign_of("verify", verify_plan(*inputs, options), cells.size()), options.shards, [&](std::size_t cell) {
            const auto [body, f] = cells[cell];
            const Input& input = inputs->bodies[body];
            const auto start = std::chrono::steady_clock::now();
            if (prepared_body != body) {
                prepared = prepare(inputs, input, options);
                if (parts)
                    parts->write_surface(input.surface, prepared->bvh, claim_of(input, options));
            }
            prepared_body = body;
            exact::BoundCounts counts;
            const FrameSink proof = [&](auto&&... of_frame) {
                counts = parts->write_frame(claim_of(input, options), f, of_frame...);
            };
            VerifyTotals frame = verify_frame(*prepared, input, options, f, parts ? proof : FrameSink(), supports);
            if (f + 1 == input.clip.frame_count())
                explain_last_frame(input, prepared->bvh, own, f, supports, frame);
            frame.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
            nlohmann::ordered_json row = frame_row(body, f, frame);
            if (parts)
                row["certificate"] = {counts.proven, counts.infinite, counts.violated};
            return Rows{std::move(row)};
        });
    return end_run(run, options.shards, verdict_of(run.all),
                   [&] { print_verify(run.all, options.output, options.shards.folder); });
}

} // namespace

int verify(const VerifyOptions& given)
{
    VerifyOptions options = given;
    if (!options.input.morphs.empty())
        throw InputError("--morphs is of all times; with --times all");
    options.input.morph_frames = options.update == VerifiedUpdate::refit && options.vipr.empty() && !options.volume;
    if (options.leaf == 0)
        options.leaf = options.update == VerifiedUpdate::refit ? 1 : 16;
    const auto start = std::chrono::steady_clock::now();
    const int threads = options.threads > 0 ? options.threads : tbb::info::default_concurrency();
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    if (!options.vipr.empty() && (!options.methods.within(box_methods) || options.rest_shape == RestShape::obb))
        throw InputError(
            "--vipr needs methods that bound over weights and the BV's own box: convex, corners, eq12, limited");
    const Provenance from = provenance(threads, options.input.seed);
    RecordOutput output(options.output, from);
    std::optional<LineFile> certificate;
    if (!options.certificate.empty() && options.shards.folder.empty())
        certificate.emplace(options.certificate);
    const auto shared = std::make_shared<const Inputs>(load_inputs(options.input));
    const Inputs& inputs = *shared;
    output.describe(fields_of(inputs));
    if (inputs.bodies.size() > 1 && (!options.certificate.empty() || !options.vipr.empty()))
        throw InputError("--certificate and --vipr are of one body; --body chooses it");
    if (!options.shards.folder.empty()) {
        if (options.update != VerifiedUpdate::refit || options.remember || !options.vipr.empty())
            throw InputError("--out goes neither with --update and --remember, where frames depend on those before "
                             "them, nor with --vipr");
        if (options.certificate.find('/') != std::string::npos || options.certificate.starts_with('.'))
            throw InputError(
                fmt::format("--certificate {}: with --out it names a folder in that one", options.certificate));
        catch_interrupt();
        return verify_in_cells(shared, options);
    }
    VerifyTotals totals;
    for (const Input& input : inputs.bodies)
        totals.frames_wanted += input.clip.frame_count();
    if (!options.vipr.empty())
        std::filesystem::create_directories(options.vipr);
    catch_interrupt();
    std::optional<LazyTotals> lazy;
    if (options.update != VerifiedUpdate::refit) {
        lazy.emplace();
        totals.at_once = inputs.bodies.size();
    } else if (options.sabotage == Sabotage::stale) {
        throw InputError("--sabotage stale goes with --update lazy, full and front");
    }
    try {
        if (lazy)
            verify_lazy(inputs, options, totals, *lazy);
        for (const Input& input : inputs.bodies)
            if (!lazy)
                verify_body(shared, input, options, certificate ? &*certificate : nullptr, totals);
    } catch (const Interrupted&) { // what is in `totals` is kept
    }
    const Completeness completeness = completeness_of(totals);
    finish(totals);
    totals.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

    output.set(completeness);
    output.add_all(lazy ? lazy_records_of(verified(inputs), options, totals, *lazy)
                        : records_of(verified(inputs), options, totals));
    output.finish();
    if (!options.output.records_only() && lazy)
        print_lazy_table(verified(inputs), options, totals, *lazy, from);
    else if (!options.output.records_only())
        print_table(verified(inputs), options, totals, from);
    if (certificate && completeness.complete)
        certificate->commit();
    if (totals.violated || !totals.ladder.holds())
        return 1;
    if (!completeness.complete) {
        std::fflush(stdout);
        fmt::print(stderr, "cinch: {}{}\n", completeness.note,
                   certificate ? "; " + options.certificate + " is not written: it would not prove the rest" : "");
        return 130;
    }
    if (interrupted()) {
        fmt::print(stderr, "cinch: interrupted after all frames\n");
        return 130;
    }
    return 0;
}

} // namespace cinch
