// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "experiments/guard_surface.hpp"
#include "experiments/input_parts.hpp"
#include "experiments/report/number.hpp"
#include "toolkit/surface/character.hpp"

namespace cinch {
namespace {

// Notes the file's surface and what is said of it.
void take_surface(Input& input, const Character& character)
{
    input.report.insert(input.report.end(), character.notes.begin(), character.notes.end());
    input.surface = surface_of(character, &input.weights_read);
    if (input.surface.mesh.triangles.empty())
        throw InputError::in_file(input.name, "has no triangles; there is nothing to bound");
    report_weights(input, character.influences);
}

Character open_character(Input& input, const InputOptions& options, Morphs morphs)
{
    input.simulation_nodes_fixed = true;
    refuse_options(options, false, true, true);
    if (!options.weights.empty() || !options.transforms.empty())
        throw InputError("--weights and --transforms need a mesh (OBJ, OFF, PLY, STL)");
    return read_gltf(options.input, Coverage::partial, morphs, &decompression());
}

} // namespace

void load_character(Input& input, const InputOptions& options)
{
    const auto choose = [&](const Character& of) -> const Character::Animation& {
        const bool rest = of.animations.empty() && options.clip.empty();
        return rest ? of.rest : choose_clip(of.animations, options.clip, options.input);
    };
    const auto missing_of = [&](const Character& of) {
        std::vector<std::string> missing = of.missing;
        missing.insert(missing.end(), choose(of).missing.begin(), choose(of).missing.end());
        return missing;
    };
    Character character = open_character(input, options, Morphs::missing);
    input.missing = missing_of(character);
    const bool morphs = std::any_of(input.missing.begin(), input.missing.end(),
                                    [](const std::string& what) { return what.starts_with("morph targets"); });
    if (morphs && options.morph_frames) { // with their targets vertices are others, where they are told apart by them
        character = open_character(input, options, Morphs::read);
        input.missing = missing_of(character);
    }
    const Character::Animation& animation = choose(character);
    if (!input.missing.empty() && !options.partial)
        throw InputError::in_file(options.input,
                                  fmt::format("has {}; {}--partial bounds the rest, and every result says so",
                                              not_modelled(input.missing),
                                              morphs ? "'cinch bake', 'verify' and 'view' have them; " : ""));
    const Clip clip = sample(character, animation, options.fps > 0 ? options.fps : 30);
    constexpr std::size_t most_frames =
        1'000'000; // of which nobody waits for the end; a choice among more is no trouble
    if (options.frames == 0 && clip.frame_count() > most_frames)
        throw InputError::in_file(
            options.input, fmt::format("clip '{}' has {} frames at this rate; --frames chooses some, --fps takes fewer",
                                       clip.name, grouped(clip.frame_count())));
    input.clip = evenly_spread(clip, options.frames);
    if (clip.displaces()) {
        input.targets = character.targets;
        input.report.push_back(counted(character.targets.size(), "morph target", "morph targets"));
    }
    if (character.animations.size() > 1 && options.clip.empty())
        input.report.push_back(
            fmt::format("{} clips; the first is used, --clip chooses another", character.animations.size()));
    take_surface(input, character);
    input.report.insert(input.report.end(), animation.notes.begin(), animation.notes.end());
    if (!input.missing.empty())
        input.report.push_back(fmt::format("partial, without {}", fmt::join(input.missing, "; ")));
}

Input load_character_surface(const InputOptions& options, Character& character)
{
    Input input;
    input.name = options.input;
    guard_surface(options.input);
    character = open_character(input, options, Morphs::read);
    input.missing = character.missing;
    if (!input.missing.empty() && !options.partial)
        throw InputError::in_file(
            options.input,
            fmt::format("has {}; --partial bounds the rest, and every result says so", not_modelled(input.missing)));
    take_surface(input, character);
    std::string motion = counted(character.animations.size(), "clip", "clips");
    if (!character.targets.empty())
        motion = counted(character.targets.size(), "morph target", "morph targets") + ", " + motion;
    head_report(input, motion);
    return input;
}

} // namespace cinch
