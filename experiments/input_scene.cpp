// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/input_scene.hpp"

#include <fmt/format.h>

#include "experiments/report/interrupt.hpp"
#include "experiments/report/number.hpp"
#include "experiments/report/progress.hpp"
#include "experiments/simulation/find_scene.hpp"

namespace cinch {

Inputs load_scene(const InputOptions& options)
{
    SceneChanges changes;
    changes.nodes = options.nodes;
    FoundScene found = find_scene(options.input, changes);
    found.scene.integration.cancelled = interrupted;
    Simulation simulation(found.scene, found.file);
    Inputs inputs{options.input, {}, {}};
    std::vector<std::size_t> chosen;
    for (std::size_t b = 0; b < simulation.bodies().size(); ++b)
        if (options.body.empty() || simulation.bodies()[b].name == options.body)
            chosen.push_back(b);
    if (chosen.empty())
        throw InputError(fmt::format("--body {}: scene '{}' has no body of that name", options.body, options.input));
    const std::size_t last = simulation.frame_count() - 1,
                      wanted = std::min(options.frames ? options.frames : 4, std::max<std::size_t>(last, 1));
    for (const std::size_t b : chosen) {
        Input body;
        body.name = simulation.bodies().size() == 1 ? options.input : options.input + "/" + simulation.bodies()[b].name;
        body.simulated = true;
        body.simulation_nodes_fixed = found.scene.bodies[b].nodes == 0;
        body.surface = *simulation.bodies()[b].simulation.surface();
        body.nodes = body.surface.place = simulation.bodies()[b].simulation.body().rest;
        inputs.bodies.push_back(std::move(body));
    }
    std::vector<double> times;
    std::vector<std::vector<Clip::Frame>> kept(chosen.size());
    auto record = [&] {
        times.push_back(simulation.time_s());
        for (std::size_t i = 0; i < chosen.size(); ++i)
            kept[i].push_back(simulation.bodies()[chosen[i]].simulation.frame());
    };
    if (options.first_frame)
        record();
    {
        Progress progress("simulating frames", last);
        for (std::size_t f = 1; f <= last; ++f) {
            const std::vector<StepReport> steps = simulation.advance();
            throw_if_interrupted();
            for (std::size_t b = 0; b < steps.size(); ++b)
                if (!steps[b].failure.empty())
                    throw InputError(
                        fmt::format("{}: the scene cannot be simulated: body '{}' at {:.6g} s: {}; a shorter \"step\" "
                                    "in its integration may do it, and 'cinch simulate {}' "
                                    "shows how far it comes",
                                    options.input, simulation.bodies()[b].name, simulation.time_s(), steps[b].failure,
                                    options.input));
            if (options.last_frames ? f + wanted > last : f * wanted / last != (f - 1) * wanted / last)
                record();
            progress.done(f);
        }
    }
    if (last == 0 && !options.first_frame)
        record();
    for (std::size_t i = 0; i < chosen.size(); ++i)
        inputs.bodies[i].clip = Clip("simulated", times, std::move(kept[i]));
    std::size_t vertices = 0, triangles = 0, nodes = 0, influences = 0;
    for (const Input& body : inputs.bodies) {
        vertices += body.surface.mesh.vertices.size();
        triangles += body.surface.mesh.triangles.size();
        nodes += body.surface.weights.node_count;
        influences += body.surface.weights.node.size();
    }
    inputs.report = {fmt::format("{}: {}, {}, {}", options.input, counted(inputs.bodies.size(), "body", "bodies"),
                                 counted(vertices, "vertex", "vertices"), counted(triangles, "triangle", "triangles")),
                     fmt::format("{}, {:.1f} influences per vertex; simulated, {}",
                                 counted(nodes, "simulation node", "simulation nodes"),
                                 static_cast<double>(influences) / static_cast<double>(vertices),
                                 counted(inputs.bodies[0].clip.frame_count(), "frame", "frames"))};
    const std::vector<std::string> notes = simulation.notes();
    inputs.report.insert(inputs.report.end(), notes.begin(), notes.end());
    return inputs;
}

} // namespace cinch
