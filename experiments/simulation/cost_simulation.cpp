// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/simulation/cost_simulation.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/format.h>
#include <tbb/global_control.h>

#include "experiments/report/interrupt.hpp"
#include "experiments/report/or_leave.hpp"
#include "experiments/report/progress.hpp"
#include "experiments/report/table.hpp"
#include "experiments/simulation/find_scene.hpp"
#include "experiments/simulation/step_figures.hpp"

namespace cinch {
namespace {

struct Outcome {
    std::vector<Field> positions; ///< of every body, at the end
    std::size_t steps = 0;
    double seconds = 0;
    std::string failure;
};

Outcome run(const Scene& scene, const std::string& file)
{
    Simulation simulation(scene, file);
    Outcome out;
    const auto start = std::chrono::steady_clock::now();
    while (simulation.frame() + 1 < simulation.frame_count() && out.failure.empty()) {
        const auto reports = simulation.advance();
        throw_if_interrupted(); // half a run is none
        for (const StepReport& r : reports) {
            out.steps += static_cast<std::size_t>(r.substeps);
            if (out.failure.empty())
                out.failure = r.failure;
        }
    }
    out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    for (const Simulation::Body& body : simulation.bodies())
        out.positions.push_back(body.simulation.positions());
    return out;
}

// Root mean square distance of the nodes from the reference, over that of the reference from the start.
double error_of(const Outcome& outcome, const Outcome& reference, const Outcome& start)
{
    double off = 0, moved = 0;
    for (std::size_t b = 0; b < reference.positions.size(); ++b) {
        off += (whole(outcome.positions[b]) - whole(reference.positions[b])).squaredNorm();
        moved += (whole(reference.positions[b]) - whole(start.positions[b])).squaredNorm();
    }
    return std::sqrt(off / moved);
}

struct Row {
    std::string energy, integrator;
    double step_s, error, seconds_per_second;
    std::size_t steps;
    std::string failure;
    bool pareto = false;
};

void mark_pareto(std::vector<Row>& rows)
{
    for (Row& row : rows)
        row.pareto = row.failure.empty() && std::none_of(rows.begin(), rows.end(), [&](const Row& other) {
                         return other.failure.empty() && other.energy == row.energy && other.error <= row.error &&
                                other.seconds_per_second <= row.seconds_per_second &&
                                (other.error < row.error || other.seconds_per_second < row.seconds_per_second);
                     });
}

FoundScene scene_with(const CostSimulationOptions& options, const std::string& elastic_model)
{
    SceneChanges changes;
    changes.elastic_model = elastic_model;
    FoundScene found = find_scene(options.scene, changes);
    Scene& scene = found.scene;
    scene.duration_s = std::min(scene.duration_s, options.duration_s);
    scene.frame_s = scene.duration_s > 0 ? scene.duration_s / std::ceil(scene.duration_s * 60) : 1.0 / 60;
    scene.integration.cancelled = interrupted;
    return found;
}

} // namespace

int cost_simulation(const CostSimulationOptions& options)
{
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    const Provenance from = provenance(1, 0);
    RecordOutput output(options.output, from);
    const FoundScene found = scene_with(options, "");
    const Scene& given = found.scene;
    pin_to_one_core();
    catch_interrupt();

    std::vector<Row> rows;
    const double frame = given.frame_s;
    const double implicit_steps[] = {frame, frame / 2, frame / 4, frame / 8, frame / 16, frame / 32};
    const double explicit_shares[] = {0.6, 0.3, 0.15};
    std::size_t done = 0;
    const std::size_t wanted =
        2 * (1 + std::size(implicit_steps) + std::size(explicit_shares)) + 1; // runs, and the steps
    StepFigures steps;
    try {
        Progress progress("simulating", wanted);
        Scene still = given;
        still.duration_s = 0;
        const Outcome start = or_leave([still, file = found.file] { return run(still, file); });
        for (const char* name : {"neo-hookean", "stvk"}) {
            const Scene scene = scene_with(options, name).scene;
            Scene fine = scene;
            fine.integration.method = Integration::Method::explicit_euler;
            fine.integration.safety = 0.02;
            const Outcome reference = or_leave([fine, file = found.file] { return run(fine, file); });
            progress.done(++done);
            auto measure = [&](const char* integrator, const Scene& how, double step) {
                const Outcome outcome = or_leave([how, file = found.file] { return run(how, file); });
                rows.push_back({name, integrator,
                                step > 0 ? step
                                         : scene.duration_s * static_cast<double>(scene.bodies.size()) /
                                               static_cast<double>(std::max<std::size_t>(outcome.steps, 1)),
                                error_of(outcome, reference, start), outcome.seconds / scene.duration_s, outcome.steps,
                                outcome.failure});
                progress.done(++done);
            };
            if (!reference.failure.empty()) {
                rows.push_back({name, "explicit", 0, NAN, NAN, 0, "no reference: " + reference.failure});
                continue;
            }
            for (const double step : implicit_steps) {
                Scene how = scene;
                how.integration.method = Integration::Method::implicit_euler;
                how.integration.step_s = step;
                measure("implicit", how, step);
            }
            for (const double share : explicit_shares) {
                Scene how = fine;
                how.integration.safety = share;
                measure("explicit", how, 0);
            }
        }
        steps = measure_steps(options.seconds);
        progress.done(++done);
    } catch (const Interrupted&) { // whole runs are kept
    }
    mark_pareto(rows);
    const bool is_complete = !interrupted() || !steps.rows.empty();
    const auto frames = static_cast<std::size_t>(given.duration_s / given.frame_s + 0.5);
    const Completeness completeness{
        frames, frames, is_complete,
        is_complete ? "" : interrupted_after(done, wanted, "runs")}; // every row is of all frames

    std::vector<nlohmann::ordered_json> records;
    for (const Row& r : rows)
        records.push_back({{"experiment", "cost"},
                           {"simulation", options.scene},
                           {"energy", r.energy},
                           {"integrator", r.integrator},
                           {"step_s", r.step_s},
                           {"steps", r.steps},
                           {"error", r.error},
                           {"seconds_per_simulated_second", r.seconds_per_second},
                           {"pareto", r.pareto},
                           {"failure", r.failure}});
    if (options.output.json || !options.output.report.empty())
        for (const StepFigures::Row& r : steps.rows)
            records.push_back({{"experiment", "cost"},
                               {"substep", "brain"},
                               {"nodes", r.nodes},
                               {"neighbours", r.neighbours},
                               {"us_per_substep", r.step_us},
                               {"plain_us_per_substep", r.plain_us},
                               {"difference_m", r.off}});
    output.set(completeness);
    output.add_all(records);
    output.finish();
    if (!options.output.records_only()) {
        print_note(completeness);
        fmt::print("{}: {:.3g} s simulated, one core\n\n", options.scene, given.duration_s);
        std::vector<std::vector<std::string>> cells;
        for (const Row& r : rows)
            cells.push_back({r.pareto ? "*" : "", r.energy, r.integrator, fmt::format("{:.3g}", 1e3 * r.step_s),
                             std::to_string(r.steps), fmt::format("{:.2e}", r.error),
                             fmt::format("{:.3f}", r.seconds_per_second), r.failure.substr(0, 20)});
        fmt::print("{}\n*: nothing of the same energy is both faster and more accurate. error: RMS\n"
                   "distance of the nodes at the end from a converged run of the same energy (fifty\n"
                   "steps for each stable one), over how far they have moved. time: seconds of\n"
                   "computing per simulated second.\n\n",
                   table({"", "energy", "integrator", "step ms", "steps", "error", "time", "failure"}, cells));
        if (!steps.rows.empty()) {
            cells.clear();
            for (const StepFigures::Row& r : steps.rows)
                cells.push_back({std::to_string(r.nodes), fmt::format("{:.1f}", r.neighbours),
                                 fmt::format("{:.1f}", r.step_us), fmt::format("{:.1f}", r.plain_us),
                                 fmt::format("{:.2f}", r.plain_us / r.step_us)});
            fmt::print("One explicit substep of a brain (gravity, neo-Hookean, hourglass), microseconds\n\n{}\n",
                       table({"nodes", "neighbours", "cinch", "plain Eigen", "ratio"}, cells));
            print(steps.figures);
        }
        fmt::print("\n{}\n", describe(from));
    }
    std::fflush(stdout);
    if (!is_complete) {
        fmt::print(stderr, "cinch: {}\n", completeness.note);
        return 130;
    }
    return 0;
}

} // namespace cinch
