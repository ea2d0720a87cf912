// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/verify.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include "exact/certificate.hpp"
#include "experiments/report/interrupt.hpp"
#include "experiments/report/line_file.hpp"
#include "experiments/report/progress.hpp"
#include "experiments/verify_lazy.hpp"
#include "experiments/verify_report.hpp"
#include "toolkit/deform/dyadic.hpp"
#include "toolkit/hierarchy/refit.hpp"
#include "toolkit/surface/input_error.hpp"

namespace cinch {

void damage(Bvh& bvh, Sabotage sabotage)
{
    for (std::size_t i = 0; i < bvh.node.size(); ++i) { // the first interval with room in it, so one of the root's if there is one
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

// limited ≤ eq12 ≤ convex on the doubles of every frame.
class Ladder {
public:
    Ladder(const Bvh& bvh, const DeformableSurface& surface, const RefitOptions& options)
        : looser_(bvh.bvs.size() * static_cast<std::size_t>(options.kdop)), tighter_(looser_)
    {
        for (const Method method : {Method::convex, Method::eq12, Method::limited}) {
            RefitOptions rung = options;
            rung.methods = method;
            rungs_.emplace_back(bvh, surface, rung);
        }
    }
    void check(std::span<const AffineMap> maps, LadderTotals& totals)
    {
        rungs_[0](maps, looser_);
        for (std::size_t r = 1; r < rungs_.size(); ++r) {
            rungs_[r](maps, tighter_);
            for (std::size_t i = 0; i < looser_.size(); ++i)
                totals.broken += !(tighter_[i] <= looser_[i]);
            totals.compared += looser_.size();
            looser_.swap(tighter_);
        }
    }

private:
    std::vector<double> looser_, tighter_;
    std::vector<Refitter> rungs_;
};

// In the last frame verified: the exact attribution of the root's bounds, and VIPR files of the first BV of every level.
void explain_last_frame(const Input& input, const Bvh& bvh, const VerifyOptions& options, std::size_t frame, std::span<const double> supports, VerifyTotals& totals)
{
    if (totals.levels.empty() || options.sabotage != Sabotage::none || options.rest_shape == RestShape::obb)
        return; // damaged data need not have a proof
    const Clip::Frame maps = input.clip.frame(frame);
    auto place = [&](std::size_t bv, int direction) {
        return exact::OneBound{input.surface, bvh, maps, options.methods, options.kdop, bv, direction,
                               supports[bv * static_cast<std::size_t>(options.kdop) + static_cast<std::size_t>(direction)]};
    };
    for (int d = 0; (options.output.json || !options.output.report.empty()) && d < options.kdop; ++d)
        if (const exact::OneBound root = place(0, d); std::isfinite(root.bound))
            totals.root.push_back({d, root.bound, exact::exact_loss(root)});
    if (options.vipr.empty())
        return;
    std::filesystem::create_directories(options.vipr);
    for (std::size_t level = 0; level < totals.levels.size(); ++level)
        for (int d = 0; d < options.kdop; ++d)
            if (const exact::OneBound bound = place(bvh.level[level], d); std::isfinite(bound.bound)) {
                const auto path = std::filesystem::path(options.vipr) / fmt::format("bv{}-d{}.vipr", bound.bv, d);
                std::ofstream out(path);
                out << exact::vipr(bound);
                if (!out.flush())
                    throw InputError::in_file(path.string(), "cannot be written");
            }
}

// Refits and proves every BV of one body in every frame, on top of what `totals` has.
void verify_body(const Input& input, const VerifyOptions& options, LineFile* certificate, VerifyTotals& totals)
{
    Bvh bvh = build_bvh(input.surface, options.leaf);
    damage(bvh, options.sabotage);
    const Rounding rounding = options.sabotage == Sabotage::no_rounding ? Rounding::plain : Rounding::proven;
    const exact::Verifier verifier(input.surface, bvh);
    const RefitOptions refit_options{options.methods, options.kdop, rounding, options.precision, options.passes, options.rest_shape, options.remember};
    Refitter refit(bvh, input.surface, refit_options);
    Ladder ladder(bvh, input.surface, refit_options);
    totals.packed_bytes += refit.bytes();
    totals.rest_bytes += bvh.bytes();

    add_levels(bvh, totals);
    if (options.volume && totals.volumes.size() < totals.levels.size())
        totals.volumes.resize(totals.levels.size());
    const exact::LineSink write = [&](std::string_view text) { certificate->line(text); };
    if (certificate)
        exact::certify_rest(input.surface, bvh, options.methods, options.kdop, input.clip.frame_count(), write, options.rest_shape);

    const std::size_t before = totals.frames;
    Progress progress("verifying frames", totals.frames_wanted);
    std::vector<double> supports(bvh.bvs.size() * static_cast<std::size_t>(options.kdop));
    for (std::size_t f = 0; f < input.clip.frame_count(); ++f) {
        if (interrupted())
            break;
        const Clip::Frame maps = input.clip.frame(f);
        totals.unbounded_nodes += refit(maps, supports).unbounded_nodes;
        const exact::FrameVerdict verdict = verifier.check(maps, options.methods, options.kdop, supports, options.rest_shape);
        if (certificate)
            exact::certify_frame(totals.frames, maps, options.methods, options.kdop, supports, verdict, write, options.rest_shape);
        add(bvh, verdict, options.kdop, {}, totals);
        totals.infinite += static_cast<std::size_t>(std::count_if(supports.begin(), supports.end(), [](double s) { return std::isinf(s); }));
        if (options.volume)
            add_volumes(input.surface, bvh, maps, options.kdop, supports, totals.volumes);
        ladder.check(maps, totals.ladder);
        progress.done(totals.frames);
    }
    if (totals.frames > before)
        explain_last_frame(input, bvh, options, totals.frames - before - 1, supports, totals);
}

} // namespace

int verify(const VerifyOptions& given)
{
    VerifyOptions options = given;
    if (options.leaf == 0)
        options.leaf = options.update == VerifiedUpdate::refit ? 1 : 16;
    const auto start = std::chrono::steady_clock::now();
    const int threads = options.threads > 0 ? options.threads : tbb::info::default_concurrency();
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    if (!options.vipr.empty() && (!options.methods.within(box_methods) || options.rest_shape == RestShape::obb))
        throw InputError("--vipr needs methods that bound over weights and the BV's own box: convex, corners, eq12, limited");
    const Provenance from = provenance(threads, options.input.seed);
    RecordOutput output(options.output, from);
    const Inputs inputs = load_inputs(options.input);
    output.describe(fields_of(inputs));
    if (inputs.bodies.size() > 1 && (!options.certificate.empty() || !options.vipr.empty()))
        throw InputError("--certificate and --vipr are of one body; --body chooses it");
    VerifyTotals totals;
    for (const Input& input : inputs.bodies)
        totals.frames_wanted += input.clip.frame_count();
    std::optional<LineFile> certificate;
    if (!options.certificate.empty())
        certificate.emplace(options.certificate);
    catch_interrupt();
    std::optional<LazyTotals> lazy;
    if (options.update != VerifiedUpdate::refit)
        lazy = verify_lazy(inputs, options, totals);
    else if (options.sabotage == Sabotage::stale)
        throw InputError("--sabotage stale goes with --update lazy, full and front");
    for (const Input& input : inputs.bodies)
        if (!lazy && !interrupted())
            verify_body(input, options, certificate ? &*certificate : nullptr, totals);
    if (certificate)
        certificate->close();
    finish(totals);
    totals.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

    output.add_all(lazy ? lazy_records_of(inputs, options, totals, *lazy) : records_of(inputs, options, totals));
    output.finish();
    if (!options.output.records_only() && lazy)
        print_lazy_table(inputs, options, totals, *lazy, from);
    else if (!options.output.records_only())
        print_table(inputs, options, totals, from);
    if (totals.violated || totals.ladder.broken)
        return 1;
    if (totals.frames < totals.frames_wanted) {
        fmt::print(stderr, "cinch: interrupted after {} of {} frames\n", totals.frames, totals.frames_wanted);
        return 130;
    }
    return 0;
}

} // namespace cinch
