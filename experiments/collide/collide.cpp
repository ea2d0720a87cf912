// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/collide/collide.hpp"

#include <algorithm>
#include <filesystem>
#include <optional>

#include <fmt/format.h>

#include "cinch/surface.hpp"
#include "experiments/collide/collide_rows.hpp"
#include "experiments/collide/collide_tables.hpp"
#include "experiments/report/interrupt.hpp"
#include "experiments/report/or_leave.hpp"
#include "experiments/simulation/find_scene.hpp"
#include "toolkit/surface/checksum.hpp"
#include "toolkit/surface/read_mesh.hpp"

namespace cinch {
namespace {

using Json = nlohmann::ordered_json;

std::vector<BackendKind> chosen_backends(const std::vector<std::string>& names)
{
    if (names.empty())
        return backend_kinds();
    std::vector<BackendKind> chosen;
    for (const std::string& name : names) {
        const auto& all = backend_kinds();
        const auto found = std::find_if(all.begin(), all.end(), [&](const BackendKind& k) { return k.name == name; });
        if (found == all.end()) {
            std::vector<std::string> known;
            for (const BackendKind& k : all)
                known.push_back(k.name);
            throw InputError(fmt::format("--backends: expected names of {}, found '{}'", fmt::join(known, ", "), name));
        }
        chosen.push_back(*found);
    }
    return chosen;
}

CollideScene load(const std::string& name, const CollideOptions& options)
{
    if (!is_scene(name))
        throw InputError::in_file(
            name, fmt::format("no such scene; known are {}, or a .json file", fmt::join(shipped_scenes(), ", ")));
    InputOptions what;
    what.input = name;
    what.frames = options.frames;
    what.last_frames = true;
    what.seed = options.seed;
    CollideScene scene{name, or_leave([what] { return load_inputs(what).bodies; })};
    if (scene.bodies.size() < 2)
        throw InputError::in_file(name, "has one body; bodies are tested against each other, so it takes two");
    return scene;
}

SceneResult run(const CollideScene& scene, const std::vector<BackendKind>& kinds, const CollideOptions& options)
{
    SceneResult result{scene.name,
                       scene.bodies.size(),
                       scene.bodies[0].surface.mesh.vertices.size(),
                       scene.bodies[0].surface.weights.node_count,
                       {},
                       kinds.size()};
    result.backends = measure(scene, kinds, {options.rounds, options.threads, options.cold});
    return result;
}

// A cell: a scene, with the backends that run on it.
struct SceneCell {
    std::string scene;
    std::size_t bodies = 0; ///< only the first so many; 0: all
    bool own_alone = false;

    std::string name() const { return bodies ? fmt::format("{}/{}", scene, bodies) : scene; }
};

std::vector<SceneCell> cells_of(const CollideOptions& options, const std::vector<BackendKind>& kinds)
{
    std::vector<SceneCell> cells;
    for (const std::string& name : options.scenes)
        cells.push_back({name});
    if (!options.scenes.empty())
        return cells;
    for (int ring = 1; ring <= 8; ++ring)
        cells.push_back({fmt::format("santa-ring-{}", ring)});
    cells.push_back({"fishes"});
    if (std::any_of(kinds.begin(), kinds.end(), [](const BackendKind& k) { return k.name == "cinch"; }))
        for (const std::size_t fewer : {12, 6}) // how time grows with bodies
            cells.push_back({"fishes", fewer, true});
    return cells;
}

// The same scene again, with fewer bodies, is not simulated again.
class Scenes {
public:
    CollideScene& get(const SceneCell& cell, const CollideOptions& options)
    {
        if (!scene_ || loaded_ != cell.scene || (cell.bodies == 0 && scene_->bodies.size() != whole_)) {
            scene_.reset();
            scene_.emplace(load(cell.scene, options));
            loaded_ = cell.scene;
            whole_ = scene_->bodies.size();
        }
        if (cell.bodies)
            scene_->bodies.resize(cell.bodies);
        scene_->name = cell.name();
        return *scene_;
    }

private:
    std::optional<CollideScene> scene_;
    std::string loaded_;
    std::size_t whole_ = 0;
};

Json plan_of(const CollideOptions& options, const std::vector<SceneCell>& cells, const std::vector<BackendKind>& kinds)
{
    Json names = Json::array(), backends = Json::array(), sums = Json::object();
    for (const SceneCell& cell : cells)
        names.push_back(cell.name());
    for (const BackendKind& kind : kinds)
        backends.push_back(kind.name);
    for (const SceneCell& cell : cells)
        if (std::filesystem::is_regular_file(cell.scene))
            sums[cell.scene] = checksum(read_bytes(cell.scene));
    return {{"scenes", names},          {"backends", backends},       {"frames", options.frames},
            {"rounds", options.rounds}, {"threads", options.threads}, {"cold", options.cold},
            {"seed", options.seed},     {"checksums", sums}};
}

std::vector<SceneResult> scenes_of(const Merged& all)
{
    std::vector<SceneResult> results;
    for (const Rows& cell : all.cells)
        for (const Json& row : cell)
            results.push_back(scene_result_of(row));
    return results;
}

// Of this project's own.
bool differ(const std::vector<SceneResult>& results)
{
    for (const SceneResult& r : results)
        for (const Measured& m : r.backends)
            if (m.differing > 0 && m.counts)
                return true;
    return false;
}

Completeness completeness_of(const std::vector<SceneResult>& results, std::size_t wanted)
{
    const auto whole = static_cast<std::size_t>(
        std::count_if(results.begin(), results.end(), [](const SceneResult& r) { return r.is_complete(); }));
    Completeness completeness{0, 0, whole == wanted,
                              whole == wanted ? ""
                                              : interrupted_after(whole, wanted, wanted == 1 ? "scene" : "scenes")};
    for (const SceneResult& r : results)
        for (const Measured& m : r.backends) {
            completeness.frames_done += m.frames;
            completeness.frames += m.frames_wanted;
        }
    return completeness;
}

int print_results(const Merged& all, const OutputOptions& options, const Provenance& from)
{
    const bool cold = all.campaign.plan.at("cold");
    const std::vector<SceneResult> results = scenes_of(all);
    const Completeness completeness = completeness_of(results, all.cells.size());
    RecordOutput output(options, from);
    output.set(completeness);
    Rows records;
    for (const SceneResult& r : results)
        for (const Measured& m : r.backends)
            records.push_back(record(r, m, cold));
    output.add_all(records);
    for (const Figure& f : figures_of(results, cold))
        output.add(record_of(f, "collide"));
    for (const Slope& s : slopes_of(results))
        output.add({{"experiment", "collide"}, {"slope", s.what}, {"exponent", s.exponent}});
    output.finish();
    if (!options.records_only()) {
        print_note(completeness);
        print_tables(results, results_of(records, Json::object()), cold);
        fmt::print("{}\n", describe(from));
    }
    if (!differ(results))
        return 0;
    fmt::print(stderr, "cinch: a check failed: backends of this project found different pairs\n");
    return 1;
}

} // namespace

int print_collide(const Merged& all, const OutputOptions& options)
{
    Provenance from = provenance_of(all.campaign);
    from.seed = all.campaign.plan.at("seed");
    from.threads = all.campaign.plan.at("threads");
    return print_results(all, options, from);
}

int collide(const CollideOptions& options)
{
    const Provenance here = provenance(options.threads, options.seed);
    RecordOutput(options.output, here); // what cannot be written is said before measuring
    const std::vector<BackendKind> kinds = chosen_backends(options.backends);
    const std::vector<SceneCell> cells = cells_of(options, kinds);
    Scenes scenes;
    catch_interrupt();
    const CampaignRun run = run_campaign(
        campaign_of("collide", plan_of(options, cells, kinds), cells.size()), options.shards, [&](std::size_t cell) {
            const CollideScene& scene = scenes.get(cells[cell], options);
            std::vector<BackendKind> own = kinds;
            if (cells[cell].own_alone)
                std::erase_if(own, [](const BackendKind& k) { return k.name != "cinch"; });
            const SceneResult result = cinch::run(scene, own, options);
            if (result.backends.empty())
                throw Interrupted{};
            if (!result.is_complete())
                throw CutShort{{}, Rows{to_json(result)}};
            return Rows{to_json(result)};
        });
    return end_run(run, options.shards, differ(scenes_of(run.all)) ? 1 : 0, [&] {
        if (options.shards.folder.empty())
            print_results(run.all, options.output, here);
        else
            print_collide(run.all, options.output);
    });
}

} // namespace cinch
