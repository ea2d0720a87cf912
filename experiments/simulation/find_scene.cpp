// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/simulation/find_scene.hpp"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cinch/io.hpp"
#include "experiments/guard_surface.hpp"
#include "experiments/report/whole_file.hpp"
#include "experiments/shipped.hpp"
#include "toolkit/surface/checksum.hpp"
#include "toolkit/surface/read_mesh.hpp"

namespace cinch {
namespace {

namespace fs = std::filesystem;

fs::path scene_folder() { return shipped_folder("scenes"); }

// Of a scene that was read already.
std::string with_elastic_model(const std::string& text, const std::string& model)
{
    nlohmann::json scene = nlohmann::json::parse(text);
    for (nlohmann::json& effect : scene.at("effects"))
        if (effect.at("effect") == "elastic")
            effect["model"] = model;
    return scene.dump();
}

} // namespace

FoundScene find_scene(const std::string& name, const SceneChanges& changes)
{
    const bool file = fs::path(name).extension() == ".json";
    if (!file && !is_scene(name))
        throw InputError::in_file(
            name, fmt::format("no such scene; known are {}, or a .json file", fmt::join(shipped_scenes(), ", ")));
    const fs::path path = file ? fs::path(name) : scene_folder() / (name + ".json");
    guard_input(path);
    std::string text = read_bytes(path);
    const std::string named = file ? name : name + ".json", folder = path.parent_path().string();
    FoundScene found{parse_scene(text, named, folder), named, 0};
    if (!changes.elastic_model.empty()) {
        text = with_elastic_model(text, changes.elastic_model);
        found.scene = parse_scene(text, named, folder);
    }
    Scene& scene = found.scene;
    scene.decoders = &decompression();
    if (changes.nodes) {
        bool any = false;
        for (SceneBody& body : scene.bodies)
            if (body.nodes > 0) {
                body.nodes = changes.nodes;
                any = true;
            }
        if (!any)
            throw InputError::in_file(name,
                                      "--nodes needs a body whose simulation nodes are sampled; this scene gives them");
    }
    if (changes.duration_s != -1) {
        if (!(changes.duration_s >= 0) || changes.duration_s / scene.frame_s > 1e6)
            throw InputError(fmt::format("--duration {}: expected seconds >= 0 that make at most a million frames",
                                         changes.duration_s));
        scene.duration_s = changes.duration_s;
    }
    if (changes.step_s != 0) {
        if (!(changes.step_s > 0))
            throw InputError(fmt::format("--step {}: expected seconds > 0", changes.step_s));
        scene.integration.step_s = changes.step_s;
    }
    if (!changes.integrator.empty())
        scene.integration.method = changes.integrator == "explicit" ? Integration::Method::explicit_euler
                                                                    : Integration::Method::implicit_euler;
    // The duration is left out, so that a run can be continued for longer.
    std::string surfaces; // files that it names may change beside it
    for (const SceneBody& body : scene.bodies)
        guard_surface(body.surface);
    for (const SceneBody& body : scene.bodies)
        if (std::error_code error; fs::is_regular_file(body.surface, error))
            surfaces += fmt::format("{}|", checksum(read_bytes(body.surface)));
    found.identity =
        checksum(surfaces + text + fmt::format("|{}|{}|{}", changes.nodes, changes.step_s, changes.integrator));
    return found;
}

} // namespace cinch
