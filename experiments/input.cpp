// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/input.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <mutex>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "experiments/guard_surface.hpp"
#include "experiments/input_parts.hpp"
#include "experiments/input_scene.hpp"
#include "experiments/report/number.hpp"
#include "experiments/report/whole_file.hpp"
#include "experiments/shipped.hpp"
#include "toolkit/deform/motion.hpp"
#include "toolkit/deform/sample_nodes.hpp"
#include "toolkit/surface/read_mesh.hpp"
#include "toolkit/surface/shapes.hpp"
#include "toolkit/surface/triangle_mesh.hpp"

namespace cinch {

void refuse_options(const InputOptions& o, bool scripted, bool clips, bool sampled)
{
    auto refuse = [](bool given, const char* option, const char* needs) {
        if (given)
            throw InputError(fmt::format("{} needs {}", option, needs));
    };
    if (!scripted) {
        refuse(o.nodes != 0, "--nodes",
               "a shape or a mesh without --weights; this input brings its own simulation nodes");
        refuse(o.support != 0, "--support", "a shape or a mesh without --weights; this input brings its own weights");
        refuse(!o.motion.empty(), "--motion",
               "a shape or a mesh without --transforms; this input brings its own motion");
    }
    if (!clips)
        refuse(!o.clip.empty(), "--clip", "a skinned character (.glb, .gltf) or --transforms");
    if (!sampled) {
        refuse(o.fps != 0, "--fps", "a skinned character (.glb, .gltf)");
        refuse(o.partial, "--partial", "a skinned character (.glb, .gltf)");
    }
}

void report_weights(Input& input, const Influences& influences)
{
    const WeightReport& weights = input.weights_read;
    if (weights.normalised)
        input.report.push_back(fmt::format(
            "{} of {} had weights that do not sum to 1 (sums {:.7g} to {:.7g}); normalised, which changed weights by "
            "up to {:.3g} %{}",
            grouped(weights.normalised), counted(weights.vertices, "vertex", "vertices"), weights.least_sum,
            weights.greatest_sum, 100 * weights.largest_change,
            influences.step > 0 && !weights.beyond_steps ? ", no more than their integers are coarse" : ""));
    if (weights.without_weight)
        input.report.push_back(fmt::format("{} no weight at all; bound to the first simulation node named",
                                           counted(weights.without_weight, "vertex has", "vertices have")));
}

void head_report(Input& input, const std::string& motion)
{
    const auto& weights = input.surface.weights;
    const std::string influences =
        fmt::format("{:.1f}", static_cast<double>(weights.node.size()) / static_cast<double>(weights.vertex_count()));
    input.report.insert(
        input.report.begin(),
        {fmt::format("{}: {}, {}", input.name, counted(input.surface.mesh.vertices.size(), "vertex", "vertices"),
                     counted(input.surface.mesh.triangles.size(), "triangle", "triangles")),
         fmt::format("{}, {} influences per vertex; {}",
                     counted(weights.node_count, "simulation node", "simulation nodes"), influences, motion)});
}

namespace {

// The last shape is kept: a study asks for the same one in cell after cell, and some take seconds to make.
std::optional<TriangleMesh> shape_of(const std::string& name)
{
    static std::mutex mutex;
    static std::string last;
    static std::optional<TriangleMesh> kept;
    const std::lock_guard lock(mutex);
    if (last != name) {
        kept = named_shape(name);
        last = name;
    }
    return kept;
}

// Simulation nodes of the shipped shapes, as in the paper.
std::size_t usual_nodes(const std::string& shape)
{
    return shape.starts_with("brain") ? 509 : shape.starts_with("santa") ? 115 : 96;
}

void script(Input& input, const InputOptions& options, std::size_t default_nodes)
{
    refuse_options(options, true, false, false);
    const std::string motion_name = options.motion.empty() ? "strong" : options.motion;
    const auto motion = named_motion(motion_name);
    if (!motion)
        throw InputError(fmt::format("--motion {}: unknown; known are {}", motion_name, motion_names));
    centre_and_scale(input.surface.mesh, 1.2);
    const std::size_t wanted = options.nodes ? options.nodes : default_nodes;
    const SimulationNodes nodes = sample_nodes(input.surface.mesh, wanted, options.seed);
    std::size_t alone = 0;
    input.surface.weights =
        kernel_weights(input.surface.mesh, nodes, options.support > 0 ? options.support : 2, &alone);
    input.clip = scripted_clip(*motion, nodes.position, options.frames ? options.frames : 4);
    input.clip.name = motion_name;
    input.nodes = input.surface.place = nodes.position;
    if (nodes.position.size() < wanted)
        input.report.push_back(fmt::format("only {} for {} simulation nodes",
                                           counted(nodes.position.size(), "distinct place", "distinct places"),
                                           grouped(wanted)));
    if (alone)
        input.report.push_back(fmt::format("{} beyond the reach of every simulation node; each follows its nearest one",
                                           counted(alone, "vertex lies", "vertices lie")));
}

void load_skin_text(Input& input, const InputOptions& options)
{
    input.simulation_nodes_fixed = true;
    refuse_options(options, false, true, false);
    if (options.weights.empty() || options.transforms.empty())
        throw InputError("--weights and --transforms go together");
    const Influences influences = read_weights_text(options.weights, input.surface.mesh.vertices.size());
    const std::vector<Clip> clips = read_clips_text(options.transforms, influences.node_count);
    input.clip = evenly_spread(choose_clip(clips, options.clip, options.transforms), options.frames);
    input.surface.weights = to_dyadic(influences, &input.weights_read);
    report_weights(input, influences);
}

Inputs scene_of(const InputOptions& options)
{
    refuse_options(options, true, false, false);
    if (!options.motion.empty() || options.support != 0 || !options.weights.empty() || !options.transforms.empty())
        throw InputError(
            fmt::format("{} is a scene: --motion, --support, --weights and --transforms do not apply", options.input));
    return load_scene(options);
}

} // namespace

std::vector<std::string> Inputs::missing() const
{
    std::vector<std::string> all;
    for (const Input& body : bodies)
        all.insert(all.end(), body.missing.begin(), body.missing.end());
    return all;
}

namespace {

nlohmann::ordered_json fields(const std::vector<std::string>& missing, std::span<const Input> bodies)
{
    std::size_t normalised = 0;
    double change = 0;
    for (const Input& body : bodies) {
        normalised += body.weights_read.normalised;
        change = std::max(change, body.weights_read.largest_change);
    }
    return {{"partial", !missing.empty()},
            {"missing", missing},
            {"weights_normalised", normalised},
            {"largest_weight_change", change}};
}

} // namespace

nlohmann::ordered_json fields_of(const Input& input) { return fields(input.missing, {&input, 1}); }

nlohmann::ordered_json fields_of(const Inputs& inputs) { return fields(inputs.missing(), inputs.bodies); }

std::string partial_mark(const std::vector<std::string>& missing)
{
    return missing.empty() ? "" : fmt::format(" (partial, without {})", fmt::join(missing, "; "));
}

Inputs load_inputs(const InputOptions& options)
{
    if (is_scene(options.input))
        return scene_of(options);
    if (!options.body.empty())
        throw InputError("--body needs a scene");
    Input input = load_input(options);
    Inputs inputs{input.name, input.report, {}};
    inputs.bodies.push_back(std::move(input));
    return inputs;
}

Input load_input(const InputOptions& options)
{
    if (is_scene(options.input)) {
        Inputs inputs = scene_of(options);
        Input first = std::move(inputs.bodies.front());
        first.report = inputs.report;
        if (inputs.bodies.size() > 1)
            first.report.push_back(fmt::format("only its body {} is looked at; --body chooses another", first.name));
        return first;
    }
    Input input;
    input.name = options.input;
    guard_surface(options.input);
    for (const std::string& file : {options.weights, options.transforms})
        guard_input(file);
    if (auto shape = shape_of(options.input)) {
        if (!options.weights.empty() || !options.transforms.empty())
            throw InputError("--weights and --transforms need a mesh file");
        input.surface.mesh = std::move(*shape);
        script(input, options, usual_nodes(options.input));
    } else if (is_character_file(options.input)) {
        load_character(input, options);
    } else if (is_mesh_file(options.input)) {
        MeshFile file = read_mesh(options.input);
        input.surface.mesh = std::move(file.mesh);
        input.report = std::move(file.notes);
        if (input.surface.mesh.vertices.empty() || input.surface.mesh.triangles.empty())
            throw InputError::in_file(options.input, "has no triangles; there is nothing to bound");
        if (options.weights.empty() && options.transforms.empty())
            script(input, options, 100);
        else
            load_skin_text(input, options);
    } else {
        throw InputError::in_file(options.input,
                                  std::filesystem::exists(options.input)
                                      ? "unknown format; known are " + mesh_extensions(", .glb, .gltf, .vrm")
                                      : fmt::format("no such file, and no shape ({}) or scene ({}) of that name",
                                                    fmt::join(shape_names(), ", "), fmt::join(shipped_scenes(), ", ")));
    }
    if (input.surface.mesh.triangles.empty())
        throw InputError::in_file(options.input, "has no triangles; there is nothing to bound");
    head_report(input,
                fmt::format("motion '{}', {}", input.clip.name, counted(input.clip.frame_count(), "frame", "frames")));
    return input;
}

} // namespace cinch
