// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/command_line.hpp"

#include <algorithm>
#include <cstdio>
#include <limits>

#include <fmt/format.h>

#include "cinch/bounds.hpp"
#include "experiments/collide/backend.hpp"
#include "experiments/report/table.hpp"
#include "toolkit/deform/motion.hpp"
#include "toolkit/surface/read_mesh.hpp"
#include "toolkit/surface/shapes.hpp"

namespace cinch {

std::string wrapped(const std::string& text) { return folded(text, 49); }

namespace {

// Accepts one of the names and nothing else, and says which there are.
template <class Enum> CLI::Validator one_of(std::vector<std::pair<std::string, Enum>> names)
{
    return CLI::Validator(
        [names = std::move(names)](std::string& text) {
            std::string known;
            for (std::size_t i = 0; i < names.size(); ++i) {
                if (names[i].first == text) {
                    text = std::to_string(static_cast<int>(names[i].second));
                    return std::string();
                }
                known += (i == 0 ? "" : i + 1 == names.size() ? " or " : ", ") + names[i].first;
            }
            return "expected " + known + ", found '" + text + "'";
        },
        "");
}

// Real numbers; NaN, which CLI::Range lets through, is none of them.
CLI::Validator within(double low, double high)
{
    return CLI::Validator(
        [=](std::string& text) {
            double x = 0;
            if (CLI::detail::lexical_cast(text, x) && x >= low && x <= high)
                return std::string();
            return fmt::format("expected a number from {} to {}, found '{}'", low, high, text);
        },
        "");
}

enum class Draws { charts, nothing };

void add_output(CLI::App& command, OutputOptions& o, Draws draws = Draws::charts)
{
    CLI::Option* json = command.add_flag("--json", o.json, "JSON Lines on standard output and nothing else");
    command.add_flag("--csv", o.csv, "the same as comma-separated values")->excludes(json);
    if (draws == Draws::charts)
        command.add_option("--plot", o.plot, wrapped("draw charts as SVG, by gnuplot"))->option_text("FILE.svg");
    command
        .add_option("--report", o.report,
                    wrapped("write a page with the results, beside the paper's where it has them"))
        ->option_text("FILE.html");
}

void add_arithmetic(CLI::App& command, Precision& precision, int& passes)
{
    command.add_option("--precision", precision, wrapped("arithmetic of the bounds: float or double [float]"))
        ->transform(one_of<Precision>({{"float", Precision::float32}, {"double", Precision::float64}}))
        ->option_text("NAME");
    command.add_option("--passes", passes, wrapped("evaluations of the dual function for local, support and best [1]"))
        ->check(CLI::Range(0, 64))
        ->option_text("N");
}

#ifdef CINCH_EXACT
void add_input(CLI::App& command, InputOptions& o)
{
    command
        .add_option("INPUT", o.input,
                    wrapped(fmt::format(
                        "a shape ({}), a scene ({}, or a .json file), a mesh ({}) or a skinned character (.glb, .gltf)",
                        fmt::join(shape_names(), ", "), fmt::join(shipped_scenes(), ", "), mesh_extensions())))
        ->option_text("[brain]");
    auto option = [&](const char* name, auto& value, const std::string& description) {
        return command.add_option(name, value, wrapped(description));
    };
    option("--nodes", o.nodes,
           "simulation nodes sampled in the volume [the paper's number for a shape, 100 for a mesh]")
        ->check(CLI::Range(1, 100000))
        ->option_text("N");
    option("--support", o.support, "reach of a simulation node, in fill distances [2]")
        ->check(within(1e-3, 1e3))
        ->option_text("X");
    option("--motion", o.motion, fmt::format("scripted motion: {} [strong]", motion_names))->option_text("NAME");
    option("--weights", o.weights, "weights of a mesh's vertices as text, see below")->option_text("FILE");
    option("--transforms", o.transforms, "transforms of the simulation nodes as text, see below")->option_text("FILE");
    option("--body", o.body, "which body of a scene [all for verify, else the first]")->option_text("NAME");
    option("--clip", o.clip, "which clip of a character or of --transforms [the first]")->option_text("NAME");
    option("--fps", o.fps, "frames per second sampled from a character's clip [30]")
        ->check(within(1e-3, 1e6))
        ->option_text("X");
    option("--frames", o.frames, "how many frames, evenly spread, the last one included [4 if scripted, else all]")
        ->check(CLI::Range(1, 100000))
        ->option_text("N");
    option("--seed", o.seed, "seed of everything random [0]")->option_text("N");
    command.add_flag("--partial", o.partial,
                     wrapped("bound what is modelled of a character that has more (morph targets, parts without a "
                             "skin, unknown extensions); every result "
                             "then says 'partial' and what is missing [refused]"));
}
#endif

} // namespace

void add_scaling(CLI::App& app, ScalingOptions& o)
{
    CLI::App& command = *app.add_subcommand("scaling", "time by simulation nodes and vertices (Table 1)");
    command.add_option("INPUT", o.input, wrapped("a scene, mesh or character to measure instead of the brain"))
        ->option_text("");
    command.add_flag("--partial", o.partial,
                     wrapped("of a character: what is modelled, saying what is missing [refused]"));
    add_arithmetic(command, o.precision, o.passes);
    command.add_option("--seconds", o.seconds, wrapped("of measuring per size [1]"))
        ->check(within(0.001, 1e6))
        ->option_text("X");
    command.add_option("--seed", o.seed, wrapped("seed of everything random [0]"))->option_text("N");
    add_output(command, o.output);
    command.footer("Examples:\n"
                   "  cinch scaling                        table and figures, about half a minute\n"
                   "  cinch scaling --precision double --csv > table1.csv\n"
                   "  cinch scaling --plot table1.svg\n"
                   "  cinch scaling brain-pull             the simulated brain\n"
                   "\n"
                   "All methods take turns on one core. Exit status: 0 measured, 2 bad usage,\n"
                   "130 interrupted.");
}

void add_simulate(CLI::App& app, SimulateOptions& o)
{
    CLI::App& command = *app.add_subcommand("simulate", "run a scene with only the effects it names");
    auto option = [&](const char* name, auto& value, const std::string& description) {
        return command.add_option(name, value, wrapped(description));
    };
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
    command.footer("Examples:\n"
                   "  cinch simulate brain-pull --explain\n"
                   "  cinch simulate santa-ring-3 --frames ring.frames --checkpoint ring.state\n"
                   "  cinch simulate santa-ring-3 --frames ring.frames --resume ring.state\n"
                   "  cinch simulate twist-180 --meshes twist --mesh-format obj\n"
                   "\n"
                   "An implicit step is solved when no acceleration is off by more than 'tolerance'\n"
                   "(of the scene's integrator, 1e-5) times the greatest one.\n"
                   "\n"
                   "Until a run is whole its frames stand in FILE.part, where --resume goes on.\n"
                   "\n"
                   "Exit status: 0 done, 1 a step could not be solved (the state before it is kept),\n"
                   "2 bad usage or scene, 130 interrupted (what is done is kept).");
}

void add_collide(CLI::App& app, CollideOptions& o)
{
    CLI::App& command = *app.add_subcommand("collide", "collision detection (Tables 2 to 4, Fig. 7)");
    auto option = [&](const char* name, auto& value, const std::string& description) {
        return command.add_option(name, value, wrapped(description));
    };
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
    option("--rounds", o.rounds, "through all frames, backends taking turns; those over 100 ms a frame run once [3]")
        ->check(CLI::Range(1, 1000))
        ->option_text("N");
    option("--threads", o.threads, "threads [1, on one core]; pairs are the same, in the same order")
        ->check(CLI::Range(1, 1024))
        ->option_text("N");
    option("--seed", o.seed, "seed of everything random [0]")->option_text("N");
    command.add_flag("--cold", o.cold,
                     wrapped("evict the caches before every frame, as an application's other work does"));
    add_output(command, o.output);
    std::string about = "Backends:\n";
    for (const BackendKind& kind : backend_kinds()) {
        const std::string text = folded(kind.what, 62);
        about += fmt::format("  {:<14}", kind.name);
        for (const char c : text)
            about += c == '\n' ? std::string("\n                ") : std::string(1, c);
        about += "\n";
    }
    command.footer(about + "\n"
                           "Examples:\n"
                           "  cinch collide                          everything, about eleven minutes\n"
                           "  cinch collide santa-ring-3 --backends cinch,refit-16,embree\n"
                           "  cinch collide fishes --json > fishes.jsonl\n"
                           "  cinch collide santa-ring-7 --cold --plot cold.svg\n"
                           "\n"
                           "All backends find all intersecting pairs of triangles, by the same exact test.\n"
                           "Exit status: 0 done, 1 this project's own found different pairs, 2 bad usage or\n"
                           "scene, 130 interrupted (results so far are printed).");
}

#ifdef CINCH_EXACT
void add_methods(CLI::App& command, Methods& methods)
{
    command
        .add_option_function<std::string>(
            "--method",
            [&methods](const std::string& text) {
                const auto named = named_methods(text);
                if (!named)
                    throw CLI::ValidationError("--method",
                                               fmt::format("expected one or more, joined by '+', of {}, found '{}'",
                                                           fmt::join(method_names(), ", "), text));
                methods = *named;
            },
            wrapped(fmt::format("{}, or several joined by '+', whose bounds are intersected [best]",
                                fmt::join(method_names(), ", "))))
        ->option_text("NAME");
}

void add_verify(CLI::App& app, VerifyOptions& o)
{
    CLI::App& command = *app.add_subcommand("verify", "prove every bound in exact arithmetic");
    add_input(command, o.input);
    auto option = [&](const char* name, auto& value, const std::string& description) {
        return command.add_option(name, value, wrapped(description));
    };
    add_methods(command, o.methods);
    add_arithmetic(command, o.precision, o.passes);
    option("--rest", o.rest_shape, "rest boxes of convex, eq12 and limited: aabb or obb [aabb]")
        ->transform(one_of<RestShape>({{"aabb", RestShape::aabb}, {"obb", RestShape::obb}}))
        ->option_text("SHAPE");
    command.add_flag("--remember", o.remember, wrapped("begin the search for lambda where the last frame left it"));
    option("--kdop", o.kdop, "directions of the bounds: " + kdop_names() + " [6]")
        ->check(CLI::IsMember(std::vector(kdops.begin(), kdops.end())))
        ->option_text("K");
    option("--update", o.update,
           "whose bounds: refit (all BVs by the methods), or those that stand after a collision query between a "
           "scene's bodies: lazy (a cut by the methods, "
           "merged above it, on demand below), front (all on demand), full (all merged from the vertices) [refit]")
        ->transform(one_of<VerifiedUpdate>({{"refit", VerifiedUpdate::refit},
                                            {"lazy", VerifiedUpdate::lazy},
                                            {"full", VerifiedUpdate::full},
                                            {"front", VerifiedUpdate::front}}))
        ->option_text("KIND");
    option("--leaf", o.leaf, "most triangles per leaf [1; 16 with --update]")
        ->check(CLI::Range(1, 1000000))
        ->option_text("N");
    option("--threads", o.threads, "threads [all cores]")->check(CLI::Range(1, 1024))->option_text("N");
    add_output(command, o.output);
    option("--certificate", o.certificate,
           "write a proof of every bound, for experiments/check_certificate.py; compressed if it ends in .gz")
        ->option_text("FILE");
    option("--vipr", o.vipr,
           "write single bounds of the last frame (first BV of each level) as VIPR files, for viprchk")
        ->option_text("DIR");
    command.add_flag("--stats", o.stats, wrapped("memory too: what the kernels stream, and all rest data"));
    command.add_flag(
        "--volume", o.volume,
        wrapped("exact volumes too: bound over true k-DOP, and planes without a facet, on a sample of each level"));
    option("--sabotage", o.sabotage,
           "for tests: damage the bounds, to see that it is found: no-rounding (drop the error terms), swap-interval "
           "(swap one l and h), "
           "lower-h (lower one h by 2^-53), stale (with --update lazy: the bounds of the frame before)")
        ->transform(one_of<Sabotage>({{"no-rounding", Sabotage::no_rounding},
                                      {"swap-interval", Sabotage::swap_interval},
                                      {"lower-h", Sabotage::lower_h},
                                      {"stale", Sabotage::stale}}))
        ->option_text("KIND");
    command.footer("Examples:\n"
                   "  cinch verify                               the 30,000-vertex brain, 509 nodes\n"
                   "  cinch verify hand.ply --nodes 200          a mesh of yours, standard motion\n"
                   "  cinch verify robot.glb --clip Robot_Dance  a skinned character\n"
                   "  cinch verify rest.off --weights w.txt --transforms t.txt --json\n"
                   "  cinch verify fish --certificate fish.jsonl.gz\n"
                   "  cinch verify santa-ring-3 --update lazy    the bounds that collision reads\n"
                   "\n"
                   "Text form of weights and transforms ('#' starts a comment):\n"
                   "  weights     'V J'; then per vertex 'n j1 w1 ... jn wn': nodes from 0, weights\n"
                   "              >= 0, normalised on load\n"
                   "  transforms  number of clips; per clip 'name K J', then K lines: time, and for\n"
                   "              every node its row-major 3x4 matrix. Vertex k moves to the sum of\n"
                   "              w_j M_j (x, y, z, 1).\n"
                   "\n"
                   "Exit status: 0 all proven, 1 a bound violated, 2 bad usage or input,\n"
                   "130 interrupted (results so far are printed; a certificate is not written).");
}

void add_tightness(CLI::App& app, TightnessOptions& o)
{
    CLI::App& command = *app.add_subcommand("tightness", "looseness by BVH level and node count (Fig. 5)");
    add_input(command, o.input);
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
    add_output(command, o.output);
    command.footer("Without --motion a shape or mesh is measured under 'strong' and 'mild'.\n"
                   "\n"
                   "Examples:\n"
                   "  cinch tightness                               the brain, about two minutes\n"
                   "  cinch tightness hand.ply --nodes 200 --methods eq12,best --plot hand.svg\n"
                   "  cinch tightness robot.glb --clip Robot_Dance --csv > robot.csv\n"
                   "\n"
                   "Exit status: 0 done, 1 a bound violated, 2 bad usage or input, 130 interrupted\n"
                   "(results so far are printed).");
}

void add_cost(CLI::App& app, CostOptions& o, CostSimulationOptions& s)
{
    CLI::App& command = *app.add_subcommand("cost", "what accuracy costs in time");
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
        .add_option("--simulation", s.scene,
                    wrapped("of this scene instead: step size, integrator and energy against error and time"))
        ->option_text("SCENE");
    command.add_option("--duration", s.duration_s, wrapped("of the scene to simulate, at most [0.25]"))
        ->check(within(0.001, 1e4))
        ->option_text("S");
    command.add_flag("!--this-input-only", o.all_scenes,
                     wrapped("the gap of the dual evaluation for the input alone, not for every shipped shape"));
    add_output(command, o.output);
    command.footer("Examples:\n"
                   "  cinch cost                             the brain; about a minute\n"
                   "  cinch cost santa --kdops 6 --plot cost.svg\n"
                   "  cinch cost robot.glb --this-input-only --json > cost.jsonl\n"
                   "  cinch cost --simulation twist-180      what accuracy costs in simulation\n"
                   "\n"
                   "Exit status: 0 measured, 2 bad usage or input, 130 interrupted (results so far\n"
                   "are printed).");
}

void add_corners(CLI::App& app, CornersOptions& o)
{
    CLI::App& command = *app.add_subcommand("corners", "true corners of a weight space, and maxima");
    auto option = [&](const char* name, auto& value, const std::string& description) {
        return command.add_option(name, value, wrapped(description));
    };
    option("CASE", o.files, "case files, see below, or names of shipped cases (data/cases)")
        ->required()
        ->option_text("FILE...");
    add_output(command, o.output, Draws::nothing);
    command.add_flag("--list", o.list, wrapped("print every corner, as fractions p/q, as they are found"));
    option("--limit", o.limit, "most corners to list per file [all]")
        ->check(CLI::Range(1, std::numeric_limits<int>::max()))
        ->option_text("N");
    command.footer("A case file is {\"n\":3,\"l\":[...],\"h\":[...],\"b\":[[...],...]}: weight intervals\n"
                   "with 0 <= l <= h <= 1 and rows of extrema. Numbers are JSON numbers, or\n"
                   "strings that are decimal or hexadecimal floating point (\"0x1.8p-1\").\n"
                   "\n"
                   "Examples:\n"
                   "  cinch corners space.json          count, exact maximum, Eq. 12, bound per row\n"
                   "  cinch corners *.json --json       the same as JSON Lines\n"
                   "  cinch corners space.json --list --limit 10\n"
                   "  cinch corners 038_hyper_n5        a case that comes with the program\n"
                   "\n"
                   "Exit status: 0 done, 1 a toolkit bound lies below the exact maximum, 2 bad\n"
                   "usage or input (other files are still answered), 130 interrupted.");
}

void add_stability(CLI::App& app, StabilityOptions& o)
{
    CLI::App& command = *app.add_subcommand("stability", "hard cases: expected, observed, and their bounds");
    command.add_option("--case", o.cases, wrapped("only cases with one of these in their name [all]"))
        ->delimiter(',')
        ->option_text("TEXT,...");
    command.add_flag("--list", o.list, "names of the cases, and what is expected");
    command
        .add_option("--without", o.missing,
                    wrapped("take a safeguard away, to see which cases need it: hourglass, completion or projection"))
        ->transform(one_of<Missing>({{"hourglass", Missing::hourglass},
                                     {"completion", Missing::completion},
                                     {"projection", Missing::projection}}))
        ->option_text("NAME");
    add_output(command, o.output, Draws::nothing);
    command.footer("Examples:\n"
                   "  cinch stability                       all cases, about ten seconds\n"
                   "  cinch stability --case inverted,flat\n"
                   "  cinch stability --without completion  what the safeguard is for\n"
                   "\n"
                   "Exit status: 0 all pass, 1 a case fails, 2 bad usage, 130 interrupted.");
}

void add_fuzz(CLI::App& app, FuzzOptions& o)
{
    CLI::App& command = *app.add_subcommand("fuzz", "every method against the exact side, random cases");
    auto option = [&](const char* name, auto& value, const std::string& description) {
        return command.add_option(name, value, wrapped(description));
    };
    option("--seconds", o.seconds, "stop after so many seconds; 0 runs nothing")
        ->check(within(0.0, 1e9))
        ->option_text("X");
    option("--cases", o.cases, "stop after so many cases [100,000 if no --seconds]")
        ->check(CLI::NonNegativeNumber)
        ->option_text("N");
    option("--seed", o.seed, "case i of a seed is always the same [0]")->option_text("N");
    option("--family", o.family, fmt::format("only this family: {} [all in turn]", fmt::join(fuzz_families(), ", ")))
        ->check(CLI::Validator(
            [](std::string& text) {
                const auto known = fuzz_families();
                return std::find(known.begin(), known.end(), text) != known.end() ? ""
                                                                                  : "there is no family '" + text + "'";
            },
            ""))
        ->option_text("NAME");
    command
        .add_option_function<std::string>(
            "--shard",
            [&o](const std::string& text) {
                unsigned long long i = 0, n = 0;
                int used = 0;
                if (std::sscanf(text.c_str(), "%llu/%llu%n", &i, &n, &used) != 2 ||
                    used != static_cast<int>(text.size()) || n == 0 || i >= n)
                    throw CLI::ValidationError("--shard", "expected I/N with 0 <= I < N, found '" + text + "'");
                o.shard = i;
                o.shards = n;
            },
            wrapped("run every N-th case, beginning with the I-th, I from 0"))
        ->option_text("I/N");
    option(
        "--resume", o.resume,
        "keep the state in this file, and continue from it if it is there; it must be of the same program and options")
        ->option_text("FILE");
    option("--corpus", o.corpus, "where shrunk failures are saved [data/hard]")->option_text("DIR");
    option("--threads", o.threads, "threads [all cores]")->check(CLI::Range(1, 1024))->option_text("N");
    add_output(command, o.output, Draws::nothing);
    option("--sabotage", o.defect,
           "for tests: plant a defect: no-rounding, lower-h and small-box must be found, wrong-lambda and sum-order "
           "must prove harmless; nothing is saved")
        ->transform(one_of<Defect>({{"no-rounding", Defect::no_rounding},
                                    {"wrong-lambda", Defect::wrong_lambda},
                                    {"lower-h", Defect::lower_h},
                                    {"sum-order", Defect::sum_order},
                                    {"small-box", Defect::small_box}}))
        ->option_text("KIND");
    command.footer("Examples:\n"
                   "  cinch fuzz --seconds 600                 ten minutes, all families\n"
                   "  cinch fuzz --cases 1000000 --resume s    can be stopped and continued\n"
                   "  cinch fuzz --shard 0/4 --seconds 600     one of four machines\n"
                   "\n"
                   "A failure is shrunk to the smallest case that still fails and saved as JSON.\n"
                   "Exit status: 0 no violation, 1 a violation, 2 bad usage, 130 interrupted (the\n"
                   "summary is printed).");
}
#endif

} // namespace cinch
