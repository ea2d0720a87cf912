// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bake/bake.hpp"

#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cinch/environment.hpp"
#include "experiments/bake/bake_targets.hpp"
#include "experiments/bake/prove.hpp"
#include "experiments/report/interrupt.hpp"
#include "experiments/report/number.hpp"
#include "experiments/report/progress.hpp"

namespace cinch {
namespace {

using Json = nlohmann::ordered_json;

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

Json record_of(const TimedBody& body, const BakeOptions& options, const Bvh& bvh, const std::string& clip,
               const BakedInterval& interval, std::size_t bv)
{
    const int kdop = options.bounds.kdop;
    const double* s = interval.supports.data() + bv * static_cast<std::size_t>(kdop);
    Json record{{"experiment", "bake"},
                {"input", body.input.name},
                {"clip", clip},
                {"t0", interval.first_s},
                {"t1", interval.last_s},
                {"bv", bv},
                {"level", level_of(bvh, bv)},
                {"min", {-s[1], -s[3], -s[5]}},
                {"max", {s[0], s[2], s[4]}},
                {"statement", statement_of(options.engine)},
                {"method", name_of(options.bounds.methods)},
                {"precision", options.bounds.precision == Precision::float32 ? "float" : "double"},
                {"kdop", kdop}};
    if (kdop != 6)
        record["supports"] = std::vector<double>(s, s + kdop);
    return record;
}

std::string of_box(const double* s) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", s[0], s[1], s[2]); }

std::string words_of(const BakedFigures& f)
{
    return fmt::format("  time adds {:.3f} on average, {:.3f} at most; root {:.3f}, leaves {:.3f} of the truth; {} "
                       "intervals for {} between keys\n  outside the union of frames at 30 fps: {:.2f} % of the half "
                       "diagonal; of key times: {:.2f} %; of these bounds: {:.2f} %\n",
                       f.time_mean, f.time_max, f.root, f.leaves, f.intervals, f.key_segments, 100 * f.missed_30fps,
                       100 * f.missed_keys, 100 * f.missed_by_us);
}

} // namespace

int bake(const BakeOptions& options)
{
    require_default_arithmetic();
    RecordOutput output(options.output, provenance(0, options.input.seed));
    const std::vector<TimedBody> bodies = load_timed(options.input, options.engine);
    if (bodies.size() > 1 && (!options.npz.empty() || !options.usd.empty() || !options.certificate.empty()))
        throw InputError("--npz, --usd and --certificate hold one body; --body chooses it");
    catch_interrupt();
    const bool words = !options.output.records_only();
    exact::TimeVerdict verdict;
    try {
        for (const TimedBody& body : bodies) {
            output.describe(fields_of(body.input));
            if (words)
                for (const std::string& line : body.input.report)
                    fmt::print("{}\n", line);
            const Bvh bvh = build_bvh(body.input.surface, options.leaf);
            const std::size_t count = bvh.bvs.size() * static_cast<std::size_t>(options.bounds.kdop),
                              written = bvs_down_to(bvh, options.level);
            IntervalRefitter refit(bvh, body.input.surface, options.bounds, body.targets());
            std::vector<std::pair<std::string, std::vector<BakedInterval>>> baked;
            std::vector<BakedFigures> figures;
            std::optional<TimeProofFile> proof_file;
            if (!options.certificate.empty())
                proof_file.emplace(options.certificate, body, bvh, options.bounds.methods, options.bounds.kdop);
            Progress progress("baking clips", body.clips.size());
            for (const TimedClip& source : body.clips) {
                const TimedMotion motion = watched(source.motion, options.sabotage);
                baked.emplace_back(motion.name, bake_clip(refit, motion, options, count));
                const std::vector<BakedInterval>& intervals = baked.back().second;
                for (const BakedInterval& interval : intervals)
                    for (std::size_t bv = 0; bv < written; ++bv)
                        output.add(record_of(body, options, bvh, motion.name, interval, bv));
                if (proof_file)
                    proof_file->add(source, intervals);
                std::string proof;
                if (options.prove) {
                    const exact::TimeVerdict own = prove(body, source, bvh, options.bounds.kdop, intervals);
                    verdict.add(own);
                    proof = "  " + verdict_line(own) + "\n" + worst_line(own);
                }
                if (words) {
                    fmt::print("{}, {:.6g} to {:.6g} s:\n", motion.name, motion.first_s(), motion.last_s());
                    for (const BakedInterval& interval : intervals) {
                        const double* s = interval.supports.data();
                        const double low[3] = {-s[1], -s[3], -s[5]}, high[3] = {s[0], s[2], s[4]};
                        fmt::print("  {:8.4f} to {:8.4f} s  {} to {}\n", interval.first_s, interval.last_s, of_box(low),
                                   of_box(high));
                    }
                    fmt::print("{}", proof);
                }
                if (options.report) {
                    const BakedFigures f =
                        figures_of(body.input.surface, bvh, body.targets(), refit, source.motion, options, intervals);
                    output.add({{"experiment", "bake"},
                                {"input", body.input.name},
                                {"clip", motion.name},
                                {"time_ratio", f.time_mean},
                                {"max_time_ratio", f.time_max},
                                {"root_ratio", f.root},
                                {"leaf_ratio", f.leaves},
                                {"missed_30fps", f.missed_30fps},
                                {"missed_keys", f.missed_keys},
                                {"missed", f.missed_by_us},
                                {"key_segments", f.key_segments},
                                {"intervals", f.intervals}});
                    figures.push_back(f);
                    if (words)
                        fmt::print("{}", words_of(f));
                }
                progress.done(baked.size());
            }
            if (options.report) {
                const std::vector<Figure> reached =
                    time_targets(figures, refits_per_interval(body, bvh, options.bounds), bvh.bvs.size());
                for (const Figure& figure : reached)
                    output.add(record_of(figure, "bake"));
                if (words)
                    print(reached);
            }
            if (!options.npz.empty())
                write_npz(options.npz, bvh, written, options.bounds.kdop, baked);
            if (proof_file)
                proof_file->commit(verdict);
            if (!options.usd.empty())
                write_usd(options.usd, baked);
            if (words)
                fmt::print("{} of {} BVs written; one box of '{}' holds {}{}\n", grouped(written),
                           grouped(bvh.bvs.size()), name_of(options.bounds.methods), statement_of(options.engine),
                           partial_mark(body.input.missing));
        }
    } catch (const Interrupted&) {
        output.set({0, 0, false, "interrupted"});
        output.finish();
        if (words)
            fmt::print("interrupted; files were not written\n");
        return interrupt_status();
    }
    output.finish();
    if (words && options.prove)
        fmt::print("{}\n", verdict_line(verdict));
    return verdict.violated || verdict.undecided ? 1 : 0;
}

} // namespace cinch
