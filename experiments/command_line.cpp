// SPDX-License-Identifier: GPL-3.0-or-later
// The commands that simulate and measure.
#include <fmt/format.h>

#include "cinch/bounds.hpp"
#include "experiments/collide/backend.hpp"
#include "experiments/collide/collide.hpp"
#include "experiments/command_line.hpp"
#include "experiments/command_line_options.hpp"
#include "experiments/report/table.hpp"
#include "experiments/scaling/scaling.hpp"
#include "experiments/shipped.hpp"
#include "experiments/simulation/cost_simulation.hpp"
#include "experiments/simulation/simulate.hpp"
#ifdef CINCH_EXACT
#include "experiments/cost/cost.hpp"
#include "experiments/tightness/tightness.hpp"
#endif

namespace cinch {

void add_scaling(CLI::App& app, Run& run)
{
    const auto options = std::make_shared<ScalingOptions>();
    ScalingOptions& o = *options;
    CLI::App& command = *app.add_subcommand("scaling", "time by simulation nodes and vertices (Table 1)");
    command.callback([options, &run] { run = [options] { return scaling(*options); }; });
    command.add_option("INPUT", o.input, wrapped("a scene, mesh or character to measure instead of the brain"))
        ->option_text("");
    command.add_flag("--partial", o.partial,
                     wrapped("of a character: what is modelled, saying what is missing [refused]"));
    add_arithmetic(command, o.precision, o.passes);
    command.add_option("--seconds", o.seconds, wrapped("of measuring per size [1]"))
        ->check(within(0.001, 1e6))
        ->option_text("X");
    command.add_option("--seed", o.seed, wrapped("seed of everything random [0]"))->option_text("N");
    add_shards(command, o.shards);
    add_output(command, o.output);
    command.footer(R"(Examples:
  cinch scaling                        table and figures, about half a minute
  cinch scaling --precision double --csv > table1.csv
  cinch scaling --plot table1.svg
  cinch scaling brain-pull             the simulated brain

All methods take turns on one core. Exit status: 0 measured, 2 bad usage,
130 interrupted.)");
}

void add_simulate(CLI::App& app, Run& run)
{
    const auto options = std::make_shared<SimulateOptions>();
    SimulateOptions& o = *options;
    CLI::App& command = *app.add_subcommand("simulate", "run a scene with only the effects it names");
    command.callback([options, &run] { run = [options] { return simulate(*options); }; });
    const auto option = options_of(command);
    option("SCENE", o.scene, fmt::format("a scene ({}) or a file (.json)", fmt::join(shipped_scenes(), ", ")))
        ->option_text("");
    option("--nodes", o.changes.nodes, "simulation nodes per body, where they are sampled [as the scene says]")
        ->check(CLI::Range(1, 100000))
        ->option_text("N");
    option("--duration", o.changes.duration_s, "seconds to simulate [as the scene says]")
        ->check(within(0.0, 1e30))
        ->option_text("S");
    option("--step", o.changes.step_s, "longest time step in seconds [as the scene says]")
        ->check(within(1e-30, 1e30))
        ->option_text("S");
    option("--integrator", o.changes.integrator, "implicit or explicit [as the scene says]")
        ->check(CLI::IsMember({"implicit", "explicit"}))
        ->option_text("NAME");
    option("--frames", o.frames, "write the transforms of all frames: binary, or JSON Lines if the name ends in .jsonl")
        ->option_text("FILE");
    option("--meshes", o.meshes, "write every body in every frame as a mesh")->option_text("DIR");
    option("--mesh-format", o.mesh_format, "ply or obj [ply]")
        ->check(CLI::IsMember({"ply", "obj"}))
        ->option_text("NAME");
    option("--checkpoint", o.checkpoint, "keep the state in this file, to continue from")->option_text("FILE");
    option("--resume", o.resume, "continue from this file; the frames become the bytes of one uninterrupted run")
        ->option_text("FILE");
    option("--every", o.every, "frames from checkpoint to checkpoint [10]")
        ->check(CLI::Range(1, 1000000))
        ->option_text("N");
    option("--threads", o.threads, "threads [all cores]; the results are the same")
        ->check(CLI::Range(1, 1024))
        ->option_text("N");
    command.add_flag("--explain", o.explain, wrapped("say what was left out, and how often each effect was called"));
    command.add_flag("--energies", o.energies, wrapped("a record of every body in every frame too"));
    command.add_flag("--schema", o.schema,
                     wrapped("print the JSON schema of scenes, data/scenes/schema.json, instead of running one"));
    add_output(command, o.output, Draws::nothing);
    command.footer(R"(Examples:
  cinch simulate brain-pull --explain
  cinch simulate santa-ring-3 --frames ring.frames --checkpoint ring.state
  cinch simulate santa-ring-3 --frames ring.frames --resume ring.state
  cinch simulate twist-180 --meshes twist --mesh-format obj

An implicit step is solved when no acceleration is off by more than 'tolerance'
(of the scene's integrator, 1e-5) times the greatest one.

Until a run is whole its frames stand in FILE.part, where --resume goes on.

Exit status: 0 done, 1 a step could not be solved (the state before it is kept),
2 bad usage or scene, 130 interrupted (what is done is kept).)");
}

void add_collide(CLI::App& app, Run& run)
{
    const auto options = std::make_shared<CollideOptions>();
    CollideOptions& o = *options;
    CLI::App& command = *app.add_subcommand("collide", "collision detection (Tables 2 to 4, Fig. 7)");
    command.callback([options, &run] { run = [options] { return collide(*options); }; });
    const auto option = options_of(command);
    option("SCENE", o.scenes,
           "scenes of several bodies, or .json files [the rings of Table 2, santa-ring-1 to -8, and fishes]")
        ->option_text("...");
    std::string names;
    for (const BackendKind& kind : backend_kinds())
        names += (names.empty() ? "" : ", ") + kind.name;
    option("--backends", o.backends,
           fmt::format("which to measure, of {} [all]; times are over the first one's", names))
        ->delimiter(',')
        ->option_text("NAME,...");
    option("--frames", o.frames, "the last so many of the scene [60]")->check(CLI::Range(1, 1000000))->option_text("N");
    option("--rounds", o.rounds,
           "through all frames, backends taking turns; those over 100 ms a frame go once through every fourth of 40 "
           "and more [3]")
        ->check(CLI::Range(1, 1000))
        ->option_text("N");
    option("--threads", o.threads, "threads [1, on one core]; pairs are the same, in the same order")
        ->check(CLI::Range(1, 1024))
        ->option_text("N");
    option("--seed", o.seed, "seed of everything random [0]")->option_text("N");
    command.add_flag("--cold", o.cold,
                     wrapped("evict the caches before every frame, as an application's other work does"));
    add_shards(command, o.shards);
    add_output(command, o.output);
    std::string about = "Backends:\n";
    for (const BackendKind& kind : backend_kinds()) {
        const std::string text = folded(kind.what, 62);
        about += fmt::format("  {:<14}", kind.name);
        for (const char c : text)
            about += c == '\n' ? std::string("\n                ") : std::string(1, c);
        about += "\n";
    }
    command.footer(about + R"(
Examples:
  cinch collide                          everything, about eleven minutes
  cinch collide santa-ring-3 --backends cinch,refit-16,embree
  cinch collide fishes --json > fishes.jsonl
  cinch collide santa-ring-7 --cold --plot cold.svg

All backends find all intersecting pairs of triangles, by the same exact test.
Exit status: 0 done, 1 this project's own found different pairs, 2 bad usage or
scene, 130 interrupted (results so far are printed).)");
}

#ifdef CINCH_EXACT
void add_tightness(CLI::App& app, Run& run)
{
    const auto options = std::make_shared<TightnessOptions>();
    TightnessOptions& o = *options;
    CLI::App& command = *app.add_subcommand("tightness", "looseness by BVH level and node count (Fig. 5)");
    command.callback([options, &run] { run = [options] { return tightness(*options); }; });
    add_input(command, o.input, &o.lists);
    command
        .add_option_function<std::vector<std::string>>(
            "--methods",
            [&o](const std::vector<std::string>& texts) {
                for (const std::string& text : texts) {
                    const auto named = named_methods(text);
                    if (!named)
                        throw CLI::ValidationError(
                            "--methods", fmt::format("expected names of {}, or several joined by '+', found '{}'",
                                                     fmt::join(method_names(), ", "), text));
                    o.methods.push_back(*named);
                }
            },
            wrapped("which to compare [sphere,eq12,limited,local,support,linear,best]"))
        ->delimiter(',')
        ->option_text("NAME,...");
    command
        .add_option("--sweep", o.nodes,
                    wrapped("numbers of simulation nodes for the root's ratio [8,16,32,65,128,225,512]"))
        ->delimiter(',')
        ->check(CLI::Range(1, 100000))
        ->option_text("N,...");
    add_arithmetic(command, o.precision, o.passes);
    command.add_option("--leaf", o.leaf, wrapped("most triangles per leaf [1]"))
        ->check(CLI::Range(1, 1000000))
        ->option_text("N");
    command.add_option("--threads", o.threads, wrapped("threads [all cores]"))
        ->check(CLI::Range(1, 1024))
        ->option_text("N");
    add_shards(command, o.shards);
    add_output(command, o.output);
    command.footer(R"(Without --motion a shape or mesh is measured under 'strong' and 'mild'.
Several inputs, several --nodes ("8,65", "1-20", or "16..512", doubled) or seeds
are a study: a row for each level of each, and means over the seeds.

Examples:
  cinch tightness                               the brain, about two minutes
  cinch tightness hand.ply --nodes 200 --methods eq12,best --plot hand.svg
  cinch tightness robot.glb --clip Robot_Dance --csv > robot.csv
  cinch tightness a.ply b.ply --seed 1-20 --nodes 16..512 --motion strong,mild

Exit status: 0 done, 1 a bound violated, 2 bad usage or input, 130 interrupted
(results so far are printed).)");
}

void add_cost(CLI::App& app, Run& run)
{
    const auto options = std::make_shared<CostOptions>();
    const auto of_simulation = std::make_shared<CostSimulationOptions>();
    CostOptions& o = *options;
    CostSimulationOptions& s = *of_simulation;
    CLI::App& command = *app.add_subcommand("cost", "what accuracy costs in time");
    command.callback([options, of_simulation, &run] {
        of_simulation->output = options->output;
        of_simulation->seconds = options->seconds;
        run = [options, of_simulation] {
            if (!of_simulation->scene.empty() && !options->shards.folder.empty())
                throw InputError("--out is of methods and arithmetics; not with --simulation");
            return of_simulation->scene.empty() ? cost(*options) : cost_simulation(*of_simulation);
        };
    });
    add_input(command, o.input);
    command
        .add_option("--kdops", o.kdops, wrapped(fmt::format("directions of the bounds [{}]", fmt::join(kdops, ","))))
        ->delimiter(',')
        ->check(CLI::IsMember(std::vector(kdops.begin(), kdops.end())))
        ->option_text("K,...");
    command.add_option("--seconds", o.seconds, wrapped("of measuring per k [2]"))
        ->check(within(0.001, 1e6))
        ->option_text("X");
    command.add_option("--leaf", o.leaf, wrapped("most triangles per leaf [16]"))
        ->check(CLI::Range(1, 1000000))
        ->option_text("N");
    command
        .add_option("--budget", o.anytime.budgets_ns,
                    wrapped(fmt::format("bounds of the root that tighten for so many nanoseconds [{:g}]",
                                        fmt::join(o.anytime.budgets_ns, ","))))
        ->delimiter(',')
        ->check(within(0, 1e12))
        ->option_text("NS,...");
    command
        .add_option("--tolerance", o.anytime.tolerances,
                    wrapped(fmt::format("bounds of the root that tighten until they are so near to a vertex, in widths "
                                        "[{}]",
                                        fmt::join(o.anytime.tolerances, ","))))
        ->delimiter(',')
        ->check(within(0, 1e6))
        ->option_text("X,...");
    command
        .add_option("--simulation", s.scene,
                    wrapped("of this scene instead: step size, integrator and energy against error and time"))
        ->option_text("SCENE");
    command.add_option("--duration", s.duration_s, wrapped("of the scene to simulate, at most [0.25]"))
        ->check(within(0.001, 1e4))
        ->option_text("S");
    command.add_flag_callback(
        "--this-input-only", [&o] { o.all_scenes = false; },
        wrapped("the gap of the dual evaluation for the input alone, not for every shipped shape"));
    add_shards(command, o.shards);
    add_output(command, o.output);
    command.footer(R"(Examples:
  cinch cost                             the brain; about a minute
  cinch cost santa --kdops 6 --plot cost.svg
  cinch cost robot.glb --this-input-only --json > cost.jsonl
  cinch cost --kdops 6 --budget 2e3,1e4,5e4 --this-input-only
  cinch cost --simulation twist-180      what accuracy costs in simulation

Exit status: 0 measured, 2 bad usage or input, 130 interrupted (results so far
are printed).)");
}
#endif

} // namespace cinch
