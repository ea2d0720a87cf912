// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/simulation/simulate.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include "cinch/surface.hpp"
#include "experiments/report/interrupt.hpp"
#include "experiments/report/number.hpp"
#include "experiments/report/progress.hpp"
#include "experiments/report/provenance.hpp"
#include "experiments/report/table.hpp"
#include "experiments/simulation/frame_output.hpp"

namespace cinch {
namespace {

using Json = nlohmann::ordered_json;

struct BodyTotals {
    std::size_t steps = 0, iterations = 0, products = 0, projected = 0, at_rounding = 0;
    double residual = 0, relative = 0; ///< greatest; of the relative ones
    StepReport last;
};

struct EffectTotals {
    std::string name;
    std::size_t bodies = 0; ///< on which the scene has it act
    std::size_t effects =
        0; ///< that were made for them; none where nodes are pinned, which costs nothing that can be told apart
    std::size_t calls = 0;
    double seconds = 0;
};

// Of all effects that a scene can name, in the order in which they are listed.
std::vector<EffectTotals> effect_totals(const Simulation& simulation)
{
    std::vector<EffectTotals> totals;
    for (const std::string& name : effect_names()) {
        EffectTotals sum{name};
        for (const Simulation::Body& body : simulation.bodies()) {
            const auto& named = simulation.scene().effects;
            sum.bodies += std::any_of(named.begin(), named.end(), [&](const SceneEffect& e) {
                return e.kind->name == name && e.acts_on(body.name);
            });
            const auto effects = body.simulation.effects();
            for (std::size_t e = 0; e < effects.size(); ++e)
                if (effects[e]->name() == name) {
                    const EffectCost cost = body.simulation.cost(e);
                    ++sum.effects;
                    sum.calls += cost.calls;
                    sum.seconds += cost.seconds;
                }
        }
        totals.push_back(sum);
    }
    return totals;
}

struct Result {
    std::vector<BodyTotals> bodies;
    std::size_t frames = 0, steps = 0; ///< advanced; steps over all bodies
    double seconds = 0;                ///< of all bodies, one after the other
    std::string failure;
    std::size_t first = 0, last = 0; ///< frame that the run begins with, and that it is to come to

    bool is_complete() const { return failure.empty() && first + frames >= last; }
    Completeness completeness() const
    {
        const std::size_t wanted = last > first ? last - first : 0;
        return {frames, wanted, is_complete(),
                is_complete()     ? ""
                : failure.empty() ? interrupted_after(frames, wanted, "frames")
                                  : fmt::format("stopped after {} of {} frames", frames, wanted)};
    }
};

Json energies_of(const Simulation& simulation, const std::string& scene, std::size_t b, const StepReport& r)
{
    return {{"experiment", "simulate"},
            {"scene", scene},
            {"frame", simulation.frame()},
            {"time_s", simulation.time_s()},
            {"body", simulation.bodies()[b].name},
            {"substeps", r.substeps},
            {"iterations", r.iterations},
            {"products", r.products},
            {"residual_m_per_s2", r.residual},
            {"acceleration_m_per_s2", r.acceleration},
            {"kinetic_j", r.kinetic},
            {"potential_j", r.potential},
            {"frames_done", 1},
            {"frames", 1},
            {"complete", true}}; // this one
}

Result run(const SimulateOptions& options, Simulation& simulation, FrameOutput& output, RecordOutput& records)
{
    Result result;
    result.bodies.resize(simulation.bodies().size());
    result.first = simulation.frame();
    result.last = simulation.frame_count() - 1;
    if (options.resume.empty())
        result.failure = output.write(simulation);
    if (!result.failure.empty())
        return result;
    output.save(simulation);
    const std::size_t first = result.first, last = result.last;
    Progress progress("simulating frames", last > first ? last - first : 0);
    while (simulation.frame() < last && !interrupted()) {
        const std::vector<StepReport> reports = simulation.advance();
        for (std::size_t b = 0; b < reports.size(); ++b) {
            const StepReport& r = reports[b];
            if (!r.failure.empty() && result.failure.empty())
                result.failure = fmt::format("body '{}' at {:.6g} s: {}", simulation.bodies()[b].name,
                                             simulation.time_s(), r.failure);
        }
        if (!result.failure.empty()) {
            if (interrupted()) // within the frame; the state is that before it
                result.failure.clear();
            break;
        }
        for (std::size_t b = 0; b < reports.size(); ++b) {
            const StepReport& r = reports[b];
            BodyTotals& t = result.bodies[b];
            t.steps += static_cast<std::size_t>(r.substeps);
            t.iterations += static_cast<std::size_t>(r.iterations);
            t.products += static_cast<std::size_t>(r.products);
            t.projected += static_cast<std::size_t>(r.projected);
            t.at_rounding += r.at_rounding;
            t.residual = std::max(t.residual, r.residual);
            t.relative = std::max(t.relative, r.acceleration > 0 ? r.residual / r.acceleration : 0);
            t.last = r;
            result.seconds += r.seconds;
            result.steps += static_cast<std::size_t>(r.substeps);
            if (options.energies)
                records.add(energies_of(simulation, options.scene, b, r));
        }
        ++result.frames;
        if (result.failure = output.write(simulation); !result.failure.empty())
            return result; // what was saved last has no such state
        if (simulation.frame() % options.every == 0)
            output.save(simulation);
        progress.done(simulation.frame() - first);
    }
    output.save(simulation);
    return result;
}

double ms_per_step(double seconds, const Result& result)
{
    return result.steps ? 1e3 * seconds / static_cast<double>(result.steps) : 0;
}

void add_totals(const SimulateOptions& options, const Simulation& simulation, const Result& result,
                RecordOutput& records)
{
    std::vector<std::string> names;
    const std::vector<EffectTotals> effects = effect_totals(simulation);
    for (const EffectTotals& effect : effects)
        if (effect.bodies)
            names.push_back(effect.name);
    double shared = 0;
    std::size_t nodes = 0;
    for (const Simulation::Body& body : simulation.bodies()) {
        shared += body.simulation.shared_seconds();
        nodes += body.simulation.body().size();
    }
    records.add(Json{{"experiment", "simulate"},
                     {"scene", options.scene},
                     {"effects", names},
                     {"bodies", simulation.bodies().size()},
                     {"nodes", nodes},
                     {"steps", result.steps},
                     {"ms_per_step", ms_per_step(result.seconds, result)},
                     {"time_s", simulation.time_s()},
                     {"load_report", simulation.notes()},
                     {"failure", result.failure}});
    for (const EffectTotals& effect : effects)
        if (effect.effects)
            records.add(Json{{"experiment", "simulate"},
                             {"scene", options.scene},
                             {"effect", effect.name},
                             {"bodies", effect.bodies},
                             {"calls", effect.calls},
                             {"ms_per_step", ms_per_step(effect.seconds, result)}});
    records.add(Json{{"experiment", "simulate"},
                     {"scene", options.scene},
                     {"effect", "shared: J and the transport of stresses"},
                     {"ms_per_step", ms_per_step(shared, result)}});
}

void print_tables(const SimulateOptions& options, const Simulation& simulation, const Result& result,
                  const Provenance& from)
{
    const Integration& integration = simulation.scene().integration;
    const bool is_explicit = integration.method == Integration::Method::explicit_euler;
    std::size_t vertices = 0, nodes = 0, neighbours = 0;
    for (const Simulation::Body& body : simulation.bodies()) {
        vertices += body.simulation.surface()->mesh.vertices.size();
        nodes += body.simulation.body().size();
        neighbours += body.simulation.body().neighbour.size();
    }
    print_note(result.completeness());
    fmt::print("{}\n", folded(options.scene + ": " + simulation.scene().about));
    fmt::print("{}, {}, {}, {:.1f} neighbours each\n", counted(simulation.bodies().size(), "body", "bodies"),
               counted(vertices, "vertex", "vertices"), counted(nodes, "simulation node", "simulation nodes"),
               static_cast<double>(neighbours) / static_cast<double>(nodes));
    for (const std::string& note : simulation.notes())
        fmt::print("{}\n", folded("note: " + note));
    fmt::print("\n{} to {:.3f} s, {} Euler, {} ({:.3f} ms each)\n\n", counted(result.frames, "frame", "frames"),
               simulation.time_s(), is_explicit ? "symplectic" : "implicit", counted(result.steps, "step", "steps"),
               ms_per_step(result.seconds, result));

    std::vector<std::vector<std::string>> rows;
    double shared = 0;
    for (const Simulation::Body& body : simulation.bodies())
        shared += body.simulation.shared_seconds();
    const std::vector<EffectTotals> effects = effect_totals(simulation);
    for (const EffectTotals& effect : effects)
        if (effect.effects)
            rows.push_back({effect.name, std::to_string(effect.bodies), grouped(effect.calls),
                            fmt::format("{:.4f}", ms_per_step(effect.seconds, result))});
        else if (effect.bodies)
            rows.push_back({effect.name, std::to_string(effect.bodies), "-", "-"});
    rows.push_back({"shared", "", "", fmt::format("{:.4f}", ms_per_step(shared, result))});
    fmt::print("{}shared: computing J, and carrying stresses to the nodes\n\n",
               table({"effect", "bodies", "calls", "ms per step"}, rows));

    rows.clear();
    for (std::size_t b = 0; b < result.bodies.size(); ++b) {
        const BodyTotals& t = result.bodies[b];
        const double steps = std::max<double>(1, static_cast<double>(t.steps));
        std::vector<std::string> row{simulation.bodies()[b].name, grouped(t.steps)};
        if (!is_explicit)
            for (const std::string& cell :
                 {fmt::format("{:.1f}", static_cast<double>(t.iterations) / steps),
                  fmt::format("{:.0f}", static_cast<double>(t.products) / steps), grouped(t.projected),
                  fmt::format("{:.1e}", t.residual), fmt::format("{:.1e}", t.relative)})
                row.push_back(cell);
        row.push_back(fmt::format("{:.4g}", t.last.kinetic));
        row.push_back(fmt::format("{:.4g}", t.last.potential));
        rows.push_back(std::move(row));
        if (b == 11 && result.bodies.size() > 13)
            break;
    }
    std::vector<std::string> header{"body", "steps"};
    if (!is_explicit)
        for (const char* name : {"Newton", "CG", "mended", "residual", "relative"})
            header.emplace_back(name);
    header.emplace_back("kinetic J");
    header.emplace_back("potential J");
    fmt::print("{}", table(header, rows));
    if (rows.size() < result.bodies.size())
        fmt::print("and {} more bodies\n", result.bodies.size() - rows.size());
    if (!is_explicit)
        fmt::print("Newton, CG: iterations and Hessian products per step. mended: iterations whose\n"
                   "Hessian had to be made semidefinite. residual: greatest error of an acceleration\n"
                   "that is left, m/s2. relative: to the greatest acceleration of its step.\n");
    if (options.explain) {
        std::string absent = "Left out of this scene, and so never constructed:";
        for (const EffectTotals& effect : effects)
            if (effect.bodies == 0)
                absent += " " + effect.name;
        fmt::print("\n{}\n", folded(absent));
        const bool needs =
            std::any_of(simulation.bodies().begin(), simulation.bodies().end(),
                        [](const Simulation::Body& body) { return body.simulation.model().needs_deformation; });
        fmt::print("J is computed {}.\n",
                   needs ? "in every evaluation: an effect needs it" : "only for frames: no effect needs it");
        for (const EffectTotals& effect : effects)
            if (effect.effects)
                fmt::print("{}: {} constructed, {} calls\n", effect.name, effect.effects, grouped(effect.calls));
    }
    fmt::print("\n{}\n", describe(from));
}

} // namespace

int simulate(const SimulateOptions& options)
{
    if (options.schema) {
        fmt::print("{}", scene_schema());
        return std::fflush(stdout) == 0 ? 0 : throw InputError("standard output cannot be written");
    }
    if (options.scene.empty())
        throw InputError(
            "simulate: SCENE is required, the name of a scene or a .json file; see 'cinch simulate --help'");
    const int threads = options.threads > 0 ? options.threads : tbb::info::default_concurrency();
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    if (options.every == 0)
        throw InputError("--every must be at least 1");
    const Provenance from = provenance(threads, 0);
    RecordOutput records(options.output, from);
    FoundScene found = find_scene(options.scene, options.changes);
    found.scene.integration.cancelled = interrupted;
    Simulation simulation(found.scene, found.file);
    FrameOutput output(options, found, simulation);
    catch_interrupt();
    const Result result = run(options, simulation, output, records);
    if (result.is_complete())
        output.commit();
    records.set(result.completeness());
    add_totals(options, simulation, result, records);
    records.finish();
    if (!options.output.records_only())
        print_tables(options, simulation, result, from);
    std::fflush(stdout);
    const std::string part = output.part().empty() ? "" : "; the frames so far are in " + output.part();
    if (!result.failure.empty()) {
        fmt::print(stderr, "cinch: {}{}\n", result.failure, part);
        return 1;
    }
    if (!result.is_complete()) {
        fmt::print(stderr, "cinch: interrupted at frame {} of {}{}\n", simulation.frame(), result.last, part);
        return 130;
    }
    return 0;
}

} // namespace cinch
