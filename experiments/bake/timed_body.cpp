// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bake/timed_body.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "experiments/bake/read_poses.hpp"
#include "experiments/input_checksum.hpp"
#include "experiments/report/interrupt.hpp"
#include "experiments/shipped.hpp"
#include "toolkit/surface/character.hpp"
#include "toolkit/time/character_motion.hpp"

namespace cinch {

namespace {

// "any", or "LEAST..GREATEST".
std::pair<double, double> range_of_weights(const std::string& text)
{
    if (text == "any")
        return {0, 1};
    const std::size_t dots = text.find("..");
    double ends[2] = {0, 0};
    bool good = dots != std::string::npos;
    for (int i = 0; good && i < 2; ++i) {
        const std::string_view part =
            i == 0 ? std::string_view(text).substr(0, dots) : std::string_view(text).substr(dots + 2);
        const auto read = std::from_chars(part.data(), part.data() + part.size(), ends[i]);
        good = read.ec == std::errc() && read.ptr == part.data() + part.size() && std::isfinite(ends[i]);
    }
    if (!good || ends[0] > ends[1])
        throw InputError(fmt::format("--morphs: expected any or LEAST..GREATEST, found '{}'", text));
    return {ends[0], ends[1]};
}

// From here on the body's morph targets have any weights.
void free_weights(TimedBody& body, Character& character, const InputOptions& options, const Engine& engine)
{
    const auto [least, greatest] = range_of_weights(options.morphs);
    // An engine's sums are rounded against all that they add up, which the extent of their box holds only if 0 is in
    // it.
    if (!engine.exact() && (least > 0 || greatest < 0))
        throw InputError("--morphs with --engine, --nlerp or --joint-error: expected limits with 0 between them");
    if (character.targets.empty())
        throw InputError::in_file(options.input, "has no morph targets for --morphs");
    body.any_weights = AnyWeights{std::make_shared<const Character>(character), least, greatest};
    character = with_any_weights(std::move(character), least, greatest);
    body.input.report.push_back(fmt::format("weights of morph targets: any from {:g} to {:g}, whatever clips say, at "
                                            "any time",
                                            least, greatest));
}

} // namespace

std::vector<TimedBody> load_timed(const InputOptions& options, const Engine& engine)
{
    std::vector<TimedBody> bodies;
    InputOptions what = options;
    if (!is_character_file(what.input)) {
        if (!what.morphs.empty())
            throw InputError("--morphs is of characters (.glb, .gltf, .vrm)");
        if (!what.poses.empty())
            throw InputError("--poses is of characters (.glb, .gltf, .vrm)");
        if (!engine.exact())
            throw InputError("--engine, --nlerp and --joint-error are of characters (.glb, .gltf, .vrm)");
        if (is_scene(what.input)) { // all of its frames, of which a choice is the usual
            what.first_frame = true;
            if (what.frames == 0)
                what.frames = 1'000'000;
        }
        for (Input& input : load_inputs(what).bodies) {
            bodies.emplace_back();
            TimedBody& body = bodies.back();
            body.input = std::move(input);
            body.clips.push_back({linear_motion(body.input.clip, body.input.surface), nullptr});
        }
        return bodies;
    }
    bodies.emplace_back();
    TimedBody& body = bodies.back();
    const auto loaded = std::make_shared<Character>();
    Character& character = *loaded;
    body.character = loaded;
    body.input = load_character_surface(what, character);
    if (!what.poses.empty()) {
        if (!what.clip.empty() || !engine.exact())
            throw InputError("--poses stands for clips; not with --clip, --engine, --nlerp and --joint-error");
        body.poses = read_poses(what.poses, character);
    }
    if (!what.morphs.empty())
        free_weights(body, character, what, engine);
    if (!what.poses.empty()) {
        body.input.report.push_back(fmt::format("every pose within the limits of {}", what.poses));
        body.clips.push_back({poses_within(character, body.poses, body.input.surface), nullptr});
        return bodies;
    }
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
        throw InputError::in_file(
            what.input, fmt::format("has no clip '{}'; it has {}", what.clip, known.empty() ? "none" : known));
    }
    for (const Character::Animation* animation : wanted) {
        if (!animation->missing.empty()) {
            if (!options.partial)
                throw InputError::in_file(what.input, fmt::format("clip '{}' has {}; --clip chooses another, --partial "
                                                                  "bounds the rest, and every result says so",
                                                                  animation->name, not_modelled(animation->missing)));
            for (const std::string& name : animation->missing)
                if (std::find(body.input.missing.begin(), body.input.missing.end(), name) == body.input.missing.end())
                    body.input.missing.push_back(name);
        }
        body.clips.push_back({character_motion(character, *animation, body.input.surface, engine), animation});
    }
    return bodies;
}

std::uint64_t checksum_of(const TimedBody& body, std::uint64_t sum)
{
    sum = checksum_of(body.input, sum);
    auto take = [&](const auto& all) {
        sum = checksum({reinterpret_cast<const char*>(all.data()), all.size() * sizeof(all[0])}, sum);
    };
    for (const TimedClip& clip : body.clips) {
        take(clip.motion.name);
        take(clip.motion.keys);
        if (!body.poses.empty()) // they stand in no curve
            for (const MotionInterval::Limits& limit : clip.motion.over(0, 0).limits)
                sum = checksum({reinterpret_cast<const char*>(&limit.error), sizeof limit.error}, sum);
        if (!clip.animation)
            continue;
        for (const Curve& curve : clip.animation->curves) {
            take(curve.time_s);
            take(curve.value);
        }
        for (const WeightCurve& curve : clip.animation->morphs) {
            take(curve.time_s);
            take(curve.value);
        }
    }
    for (const MorphTarget& target : body.targets()) {
        take(target.vertex);
        take(target.displacement);
        take(target.half);
    }
    return sum;
}

std::vector<std::pair<std::size_t, std::size_t>> all_clips(const std::vector<TimedBody>& bodies)
{
    std::vector<std::pair<std::size_t, std::size_t>> out;
    for (std::size_t i = 0; i < bodies.size(); ++i)
        for (std::size_t clip = 0; clip < bodies[i].clips.size(); ++clip)
            out.emplace_back(i, clip);
    return out;
}

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

} // namespace cinch
