// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/collide/collide.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "cinch/surface.hpp"
#include "experiments/collide/collide_tables.hpp"
#include "experiments/report/interrupt.hpp"
#include "experiments/report/or_leave.hpp"
#include "experiments/simulation/find_scene.hpp"

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

Json record(const SceneResult& r, const Measured& m, bool cold)
{
    Json out{{"experiment", "collide"},
             {"scene", r.scene},
             {"backend", m.backend},
             {"bodies", r.bodies},
             {"vertices", r.vertices},
             {"n", r.nodes},
             {"frames_done", m.frames},
             {"frames", m.frames_wanted},
             {"rounds_done", m.rounds},
             {"rounds", m.rounds_wanted},
             {"complete", m.is_complete()},
             {"cold", cold},
             {"evaluate_ms", m.evaluate_ms},
             {"update_ms", m.update_ms},
             {"query_ms", m.query_ms},
             {"total_ms", m.total_ms},
             {"pairs", m.pairs},
             {"pairs_differing", m.differing},
             {"megabytes_per_body", m.megabytes}};
    if (const Measured* full = r.of("refit-1"))
        out["gain"] = full->total_ms / m.total_ms;
    if (m.counts) {
        const QueryCounts& c = m.sums;
        const double frames = static_cast<double>(m.frames),
                     tests = std::max<double>(1, static_cast<double>(c.triangle_tests));
        auto mean = [&](auto x) { return static_cast<double>(x) / frames; };
        out.update({{"mean_bounds", mean(c.updates.bounds)},
                    {"mean_leaves", mean(c.updates.leaves)},
                    {"mean_vertices", mean(c.updates.vertices)},
                    {"mean_merged", mean(c.updates.merged)},
                    {"mean_box_tests", mean(c.box_tests)},
                    {"mean_leaf_pairs", mean(c.leaf_pairs)},
                    {"mean_triangle_tests", mean(c.triangle_tests)},
                    {"share_double", static_cast<double>(c.in_double) / tests},
                    {"share_exact", static_cast<double>(c.in_exact) / tests}});
    }
    auto rounded = [](const std::vector<double>& all) { // six digits say it
        Json list = Json::array();
        for (const double x : all)
            list.push_back(std::stod(fmt::format("{:.6g}", x)));
        return list;
    };
    out.update({{"pairs_of_frame", rounded(m.pairs_of_frame)}, {"total_ms_of_frame", rounded(m.total_of_frame)}});
    return out;
}

} // namespace

int collide(const CollideOptions& options)
{
    const Provenance from = provenance(options.threads, options.seed);
    RecordOutput output(options.output, from);
    const std::vector<BackendKind> kinds = chosen_backends(options.backends);
    std::vector<std::string> names = options.scenes;
    const bool all = names.empty();
    if (all)
        names = {"santa-ring-1", "santa-ring-2", "santa-ring-3", "santa-ring-4", "santa-ring-5",
                 "santa-ring-6", "santa-ring-7", "santa-ring-8", "fishes"};
    const auto own = std::find_if(kinds.begin(), kinds.end(), [](const BackendKind& k) { return k.name == "cinch"; });
    const std::size_t fewer[] = {12, 6}; // of the fishes: how time grows with bodies
    const std::size_t wanted = names.size() + (all && own != kinds.end() ? std::size(fewer) : 0);
    std::vector<SceneResult> results;
    auto add = [&](SceneResult&& result) {
        if (!result.backends.empty())
            results.push_back(std::move(result));
    };
    catch_interrupt();
    try {
        for (const std::string& name : names) {
            throw_if_interrupted();
            CollideScene scene = load(name, options);
            add(run(scene, kinds, options));
            if (name != "fishes" || !all || own == kinds.end())
                continue;
            for (const std::size_t bodies : fewer) {
                throw_if_interrupted();
                scene.name = fmt::format("fishes/{}", bodies);
                scene.bodies.resize(bodies);
                add(run(scene, {*own}, options));
            }
        }
    } catch (const Interrupted&) { // what was measured is kept
        if (results.empty())
            throw;
    }
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
    std::vector<Json> records;
    bool different = false;
    for (const SceneResult& r : results)
        for (const Measured& m : r.backends) {
            records.push_back(record(r, m, options.cold));
            different |= m.differing > 0 && m.counts; // of this project's own
        }
    for (const Figure& f : figures_of(results, options.cold))
        records.push_back({{"experiment", "collide"},
                           {"figure", f.what},
                           {"measured", f.measured},
                           {"target", f.target},
                           {"reached", f.reached}});
    for (const Slope& s : slopes_of(results))
        records.push_back({{"experiment", "collide"}, {"slope", s.what}, {"exponent", s.exponent}});
    output.set(completeness);
    output.add_all(records);
    output.finish();
    if (!options.output.records_only()) {
        print_note(completeness);
        print_tables(results, options.cold);
        fmt::print("{}\n", describe(from));
    }
    if (different) {
        fmt::print(stderr, "cinch: a check failed: backends of this project found different pairs\n");
        return 1;
    }
    if (!completeness.complete) {
        std::fflush(stdout);
        fmt::print(stderr, "cinch: {}\n", completeness.note);
        return 130;
    }
    return 0;
}

} // namespace cinch
