// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bake/bake.hpp"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cinch/environment.hpp"
#include "exact/time_check.hpp"
#include "experiments/bake/baked_clip.hpp"
#include "experiments/report/interrupt.hpp"
#include "experiments/report/number.hpp"
#include "experiments/report/progress.hpp"
#include "experiments/shipped.hpp"
#include "toolkit/surface/character.hpp"
#include "toolkit/time/character_motion.hpp"

namespace cinch {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* statement = "every vertex, in exact arithmetic and as computed, at all times of [t0, t1]";

// A clip with what the exact side reads of it.
struct Source {
    TimedMotion motion;
    const Character::Animation* animation = nullptr; // none for simulated and text clips
};

struct Body {
    Input input;
    std::optional<Character> character;
    std::vector<Source> clips;
};

// All clips of a character that can be used, or the one that was asked for.
std::vector<Body> load(const BakeOptions& options)
{
    std::vector<Body> bodies;
    InputOptions what = options.input;
    if (!is_character_file(what.input)) {
        if (is_scene(what.input)) { // all of its frames, of which a choice is the usual
            what.first_frame = true;
            if (what.frames == 0)
                what.frames = 1'000'000;
        }
        for (Input& input : load_inputs(what).bodies) {
            bodies.emplace_back();
            Body& body = bodies.back();
            body.input = std::move(input);
            body.clips.push_back({linear_motion(body.input.clip, body.input.surface), nullptr});
        }
        return bodies;
    }
    bodies.emplace_back();
    Body& body = bodies.back();
    Character& character = body.character.emplace();
    body.input = load_character_surface(what, character);
    std::vector<const Character::Animation*> wanted;
    for (const Character::Animation& animation : character.animations)
        if (what.clip.empty() || animation.name == what.clip)
            wanted.push_back(&animation);
    if (character.animations.empty() && what.clip.empty())
        wanted.push_back(&character.rest);
    if (wanted.empty()) {
        std::string known;
        for (const Character::Animation& animation : character.animations)
            known += (known.empty() ? "" : ", ") + animation.name;
        throw InputError::in_file(what.input, fmt::format("has no clip '{}'; it has {}", what.clip,
                                                          known.empty() ? "none" : known));
    }
    for (const Character::Animation* animation : wanted) {
        if (!animation->missing.empty()) {
            if (!options.input.partial)
                throw InputError::in_file(what.input, fmt::format("clip '{}' has {}; --clip chooses another, --partial "
                                                                  "bounds the rest, and every result says so",
                                                                  animation->name, not_modelled(animation->missing)));
            for (const std::string& name : animation->missing)
                if (std::find(body.input.missing.begin(), body.input.missing.end(), name) == body.input.missing.end())
                    body.input.missing.push_back(name);
        }
        body.clips.push_back({character_motion(character, *animation, body.input.surface), animation});
    }
    return bodies;
}

// Ends when it is asked to; and says what a wrong formula would say, for tests of the exact side.
TimedMotion watched(TimedMotion motion, TimeSabotage how)
{
    const double first_s = motion.first_s();
    motion.over = [right = std::move(motion.over), how, first_s](double a, double b) {
        throw_if_interrupted();
        MotionInterval out = right(a, b);
        if (how == TimeSabotage::none)
            return out;
        MotionInterval::Morph& morph = out.morph;
        if (how == TimeSabotage::still_morphs)
            morph.first = right(first_s, first_s).morph.first;
        if (how == TimeSabotage::still_morphs || how == TimeSabotage::first_half)
            morph.last = morph.at[0] = morph.first;
        if (how != TimeSabotage::half_bump)
            for (std::size_t k = how == TimeSabotage::no_remainder ? 0 : 1; k < 3; ++k)
                std::fill(morph.at[k].begin(), morph.at[k].end(), 0.0);
        if (how == TimeSabotage::still_morphs)
            return out;
        for (std::size_t j = 0; j < out.limits.size(); ++j) {
            MotionInterval::Limits& limit = out.limits[j];
            if (how == TimeSabotage::no_remainder) {
                limit = {0, HUGE_VAL, HUGE_VAL, 0, 0};
                out.bend[j] = {};
            } else if (how == TimeSabotage::half_bump) {
                for (auto& row : out.bend[j].m)
                    for (double& x : row)
                        x /= 2;
                for (std::vector<AffineMap>* maps : {&morph.slope, &morph.still})
                    for (auto& row : (morph.empty() ? out.bend : *maps)[j].m)
                        for (double& x : row)
                            x /= morph.empty() ? 1 : 2;
                limit.remainder /= 2;
                limit.bump /= 2;
                limit.path /= 2;
            } else {
                out.last[j] = out.first[j];
                out.bend[j] = {};
                limit = {};
            }
        }
        return out;
    };
    return motion;
}

Json record_of(const Body& body, const BakeOptions& options, const Bvh& bvh, const std::string& clip,
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
                {"statement", statement},
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
    const std::vector<Body> bodies = load(options);
    if (bodies.size() > 1 && (!options.npz.empty() || !options.usd.empty()))
        throw InputError("--npz and --usd hold one body; --body chooses it");
    catch_interrupt();
    const bool words = !options.output.records_only();
    exact::TimeVerdict verdict;
    std::size_t unproven = 0;
    try {
        for (const Body& body : bodies) {
            output.describe(fields_of(body.input));
            if (words)
                for (const std::string& line : body.input.report)
                    fmt::print("{}\n", line);
            const Bvh bvh = build_bvh(body.input.surface, options.leaf);
            const std::size_t count = bvh.bvs.size() * static_cast<std::size_t>(options.bounds.kdop),
                              written = bvs_down_to(bvh, options.level);
            const std::span<const MorphTarget> targets =
                body.character ? std::span<const MorphTarget>(body.character->targets) : std::span<const MorphTarget>();
            IntervalRefitter refit(bvh, body.input.surface, options.bounds, targets);
            std::vector<std::pair<std::string, std::vector<BakedInterval>>> baked;
            Progress progress("baking clips", body.clips.size());
            for (const Source& source : body.clips) {
                const TimedMotion motion = watched(source.motion, options.sabotage);
                baked.emplace_back(motion.name, bake_clip(refit, motion, options, count));
                const std::vector<BakedInterval>& intervals = baked.back().second;
                for (const BakedInterval& interval : intervals)
                    for (std::size_t bv = 0; bv < written; ++bv)
                        output.add(record_of(body, options, bvh, motion.name, interval, bv));
                std::string proof;
                if (options.prove && source.animation) {
                    const exact::ClipEnclosure clip(*body.character, *source.animation);
                    const exact::TimeChecker check(body.input.surface, bvh, clip, targets, options.bounds.kdop,
                                                   throw_if_interrupted);
                    exact::TimeVerdict own;
                    for (const BakedInterval& interval : intervals)
                        own.add(check(interval.first_s, interval.last_s, interval.supports));
                    verdict.add(own);
                    proof = fmt::format("  {} bounds for all times, {} proven, {} violated{}\n", grouped(own.bounds),
                                        grouped(own.proven()), grouped(own.violated),
                                        own.undecided ? ", " + grouped(own.undecided) + " undecided" : "");
                    if (own.worst)
                        proof +=
                            fmt::format("  vertex {} at {:.17g} s is {:.3g} beyond direction {} of BV {}\n",
                                        own.worst->vertex, own.worst->time_s, own.worst->at_least - own.worst->bound,
                                        own.worst->direction, own.worst->bv);
                } else if (options.prove) {
                    ++unproven;
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
                    const BakedFigures f = figures_of(body.input.surface, bvh, targets, refit, source.motion, options, intervals);
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
                    if (words)
                        fmt::print("{}", words_of(f));
                }
                progress.done(baked.size());
            }
            if (!options.npz.empty())
                write_npz(options.npz, bvh, written, options.bounds.kdop, baked);
            if (!options.usd.empty())
                write_usd(options.usd, baked);
            if (words)
                fmt::print("{} of {} BVs written; one box of '{}' holds {}{}\n", grouped(written),
                           grouped(bvh.bvs.size()), name_of(options.bounds.methods), statement,
                           partial_mark(body.input.missing));
        }
    } catch (const Interrupted&) {
        output.set({0, 0, false, "interrupted"});
        output.finish();
        if (words)
            fmt::print("interrupted; files were not written\n");
        return interrupt_status();
    }
    if (unproven)
        throw InputError("--prove is for characters; frames of scenes and of text skins are proven by 'cinch verify'");
    output.finish();
    if (words && options.prove)
        fmt::print("{} bounds for all times, {} proven, {} violated{}\n", grouped(verdict.bounds),
                   grouped(verdict.proven()), grouped(verdict.violated),
                   verdict.undecided ? ", " + grouped(verdict.undecided) + " undecided" : "");
    return verdict.violated ? 1 : 0;
}

} // namespace cinch
