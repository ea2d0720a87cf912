// SPDX-License-Identifier: GPL-3.0-or-later
#include <optional>

#include <fmt/format.h>

#include "cinch/environment.hpp"
#include "experiments/bake/prove.hpp"
#include "experiments/report/interrupt.hpp"
#include "experiments/report/progress.hpp"
#include "experiments/verify.hpp"

namespace cinch {
namespace {

void refuse_options_of_frames(const VerifyOptions& o)
{
    for (const auto& [given, option] : {std::pair(o.rest_shape != RestShape::aabb, "--rest"),
                                        {o.remember, "--remember"},
                                        {o.update != VerifiedUpdate::refit, "--update"},
                                        {!o.shards.folder.empty() || !o.shards.shard.empty(), "--out and --shard"},
                                        {!o.vipr.empty(), "--vipr"},
                                        {o.stats, "--stats"},
                                        {o.volume, "--volume"},
                                        {o.input.fps != 0, "--fps"}})
        if (given)
            throw InputError(fmt::format("{} is for frames; not with --times all", option));
    if (o.sabotage != Sabotage::none)
        throw InputError("--sabotage is for frames; of bounds over time it is an option of 'cinch bake'");
}

} // namespace

int verify_all_times(const VerifyOptions& options)
{
    require_default_arithmetic();
    refuse_options_of_frames(options);
    RecordOutput output(options.output, provenance(options.threads, options.input.seed));
    BakeOptions bounds;
    bounds.whole = true;
    bounds.bounds.methods = options.methods;
    bounds.bounds.kdop = options.kdop;
    bounds.bounds.precision = options.precision;
    bounds.bounds.passes = options.passes;
    const bool words = !options.output.records_only();
    const std::vector<TimedBody> bodies = load_timed(options.input);
    if (bodies.size() > 1 && !options.certificate.empty())
        throw InputError("--certificate is of one body; --body chooses it");
    catch_interrupt();
    exact::TimeVerdict all;
    std::vector<std::string> missing;
    bool stopped = false;
    try {
        for (const TimedBody& body : bodies) {
            output.describe(fields_of(body.input));
            missing.insert(missing.end(), body.input.missing.begin(), body.input.missing.end());
            if (words)
                for (const std::string& line : body.input.report)
                    fmt::print("{}\n", line);
            const Bvh bvh = build_bvh(body.input.surface, options.leaf ? options.leaf : 16);
            IntervalRefitter refit(bvh, body.input.surface, bounds.bounds, body.targets());
            std::optional<TimeProofFile> certificate;
            if (!options.certificate.empty())
                certificate.emplace(options.certificate, body, bvh, options.methods, options.kdop);
            Progress progress("proving clips", body.clips.size());
            for (std::size_t i = 0; i < body.clips.size(); ++i) {
                const TimedClip& clip = body.clips[i];
                const TimedMotion motion = watched(clip.motion, TimeSabotage::none);
                const auto baked =
                    bake_clip(refit, motion, bounds, bvh.bvs.size() * static_cast<std::size_t>(options.kdop));
                const exact::TimeVerdict own = prove(body, clip, bvh, options.kdop, baked);
                all.add(own);
                if (certificate)
                    certificate->add(clip, baked);
                output.add({{"experiment", "verify"},
                            {"input", body.input.name},
                            {"clip", motion.name},
                            {"t0", motion.first_s()},
                            {"t1", motion.last_s()},
                            {"bvs", bvh.bvs.size()},
                            {"kdop", options.kdop},
                            {"method", name_of(options.methods)},
                            {"precision", options.precision == Precision::float32 ? "float" : "double"},
                            {"bounds", own.bounds},
                            {"proven", own.proven()},
                            {"violated", own.violated},
                            {"undecided", own.undecided}});
                if (words)
                    fmt::print("{}, {:.6g} to {:.6g} s: {}\n{}", motion.name, motion.first_s(), motion.last_s(),
                               verdict_line(own), worst_line(own));
                progress.done(i + 1);
            }
            if (certificate)
                certificate->commit(all);
        }
    } catch (const Interrupted&) {
        stopped = true;
        output.set({0, 0, false, "interrupted"});
    }
    output.finish();
    if (words)
        fmt::print("{}{}{}\n", verdict_line(all), partial_mark(missing),
                   stopped ? options.certificate.empty() ? "; interrupted"
                                                         : "; interrupted, and " + options.certificate + " not written"
                           : "");
    return all.violated || all.undecided ? 1 : stopped ? interrupt_status() : 0;
}

} // namespace cinch
