// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "cinch/io.hpp"
#include "cinch/surface.hpp"
#include "toolkit/surface/skin.hpp"

namespace cinch {

/// What the user asked to be deformed, and how. Empty strings and zeros mean "not given".
struct InputOptions {
    std::string input = "brain";
    std::size_t nodes = 0;
    double support = 0;
    std::string motion;
    std::string weights, transforms;
    std::string clip;
    std::string morphs; ///< of a character over time: "any" or "LEAST..GREATEST", weights that morph targets may have
                        ///< at any time, instead of the clip's
    std::string poses;  ///< of a character over time: a file of limits of its bones, whose poses all count, instead of
                        ///< clips (read_poses.hpp)
    double fps = 0;
    std::size_t frames = 0;
    bool last_frames = false; ///< of a scene: the last `frames` one after the other, instead of evenly spread
    bool first_frame = false; ///< of a scene: the one at time 0 too
    std::uint64_t seed = 0;
    std::string body;          ///< of a scene; empty: all of them, or the first where one is asked for
    bool morph_frames = false; ///< of a character: frames with weights of morph targets are welcome, Input::targets
    bool partial = false;      ///< of a character: bound what is modelled, and say what is missing; else what is not
                               ///< modelled is refused
};

/// Lists of what a command can take many of, as people write them; empty where not given.
struct InputLists {
    std::vector<std::string> inputs, motions;
    std::string nodes, seeds;
};

/// A surface with the frames that deform it.
struct Input {
    std::string name;
    DeformableSurface surface;
    std::vector<Vec3> nodes; ///< rest positions of the simulation nodes; empty where they have none, as joints
    Clip clip;
    std::vector<MorphTarget> targets;    ///< where the clip displaces the surface by them
    bool simulated = false;              ///< by a scene
    bool simulation_nodes_fixed = false; ///< the input brings its own, instead of as many as asked for
    std::vector<std::string> report;     ///< one line each: what was loaded, and what was changed or left out
    std::vector<std::string>
        missing; ///< what the file deforms or draws and the surface or its motion lacks, by name; empty: it is whole
    WeightReport weights_read; ///< what normalising the file's weights changed, where a file gives them
};

/// Loads a shipped shape, a mesh (with scripted motion, or with weights and transforms), a skinned character, or a
/// scene, which is simulated. Throws InputError, one line, for anything that cannot be used, options that do not apply
/// included.
Input load_input(const InputOptions& options);

/// A character with its morph targets read, and its surface without frames, for bounds over time.
Input load_character_surface(const InputOptions& options, Character& character);

/// The same as load_input with every body of a scene as an input of its own.
struct Inputs {
    std::string name;
    std::vector<std::string> report;
    std::vector<Input> bodies; ///< at least one

    std::vector<std::string> missing() const; ///< of all bodies
};
Inputs load_inputs(const InputOptions& options);

/// What every record of results on an input says of it, for RecordOutput::describe: whether it is partial, what is
/// missing, and what normalising its weights changed.
nlohmann::ordered_json fields_of(const Input& input);
nlohmann::ordered_json fields_of(const Inputs& inputs);

/// For the line that people take the result from: " (partial, without A; B)", or nothing where nothing is missing.
std::string partial_mark(const std::vector<std::string>& missing);

} // namespace cinch
