// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>

#include "cinch/bounds.hpp"
#include "experiments/bake/bake.hpp"
#include "experiments/command_line.hpp"
#include "experiments/command_line_options.hpp"

namespace cinch {

void add_bake(CLI::App& app, Run& run)
{
    const auto options = std::make_shared<BakeOptions>();
    BakeOptions& o = *options;
    CLI::App& command = *app.add_subcommand("bake", "bounds for all times of clips, written down");
    command.callback([options, &run] { run = [options] { return bake(*options); }; });
    add_input(command, o.input);
    const auto option = options_of(command);
    add_methods(command, o.bounds.methods);
    add_arithmetic(command, o.bounds.precision, o.bounds.passes);
    option("--kdop", o.bounds.kdop, "directions of the bounds: " + kdop_names() + " [6]")
        ->check(CLI::IsMember(std::vector(kdops.begin(), kdops.end())))
        ->option_text("K");
    option("--leaf", o.leaf, "most triangles per leaf [4]")->check(CLI::Range(1, 1000000))->option_text("N");
    option("--level", o.level, "write the BVs down to this level of the tree; 0: the character's alone; -1: all [0]")
        ->check(CLI::Range(-1, std::numeric_limits<int>::max()))
        ->option_text("L");
    CLI::Option* interval =
        option("--interval", o.interval_s, "seconds of one interval [cut where it makes boxes a tenth smaller]")
            ->check(within(1e-6, 1e9))
            ->option_text("S");
    command.add_flag("--whole", o.whole, wrapped("one interval per clip"))->excludes(interval);
    option("--tolerance", o.tolerance,
           "by how much of its half diagonal a BV's box over time may exceed its boxes at instants [0.01]")
        ->check(within(1e-6, 1e6))
        ->option_text("X");
    option("--engine", o.engine.float32,
           "double: as cinch computes it; float32: also as an engine renders it in binary32, by weights as the file "
           "stores them and joint matrices rounded to it [double]")
        ->transform(one_of<bool>({{"double", false}, {"float32", true}}))
        ->option_text("KIND");
    option(
        "--joint-error", o.engine.joint_error,
        "how far an engine's joint matrices may put a point besides, as a share of the lengths of its chain of bones "
        "[0]")
        ->check(within(0, 1))
        ->option_text("X");
    command.add_flag(
        "--nlerp", o.engine.nlerp,
        wrapped("rotations between keys may be normalised sums of quaternions, as many engines have them"));
    option("--morphs", o.input.morphs,
           "weights that morph targets may have at any time, whatever the clips say: any, from 0 to 1, or other limits "
           "[as the clips say]")
        ->option_text("any|LEAST..GREATEST");
    option("--poses", o.input.poses,
           "in place of clips every pose in which each bone keeps within its limits, of this JSON file, see below")
        ->option_text("FILE");
    command.add_flag("--prove", o.prove,
                     wrapped("prove every bound at every BV, by exact intervals over time on the transforms"));
    command.add_flag("--report", o.report,
                     wrapped("figures too: what time adds, the truth, and what boxes of frames alone miss"));
    option("--samples", o.samples, "of the truth between two keys, for --report [30]")
        ->check(CLI::Range(1, 1000000))
        ->option_text("N");
    option("--npz", o.npz, "write a NumPy archive")->option_text("FILE.npz");
    option("--usd", o.usd, "write a USD layer with the character's box as time samples of extent")
        ->option_text("FILE.usda");
    option("--certificate", o.certificate,
           "write what experiments/check_certificate.py needs to prove every bound of every BV; compressed if it ends "
           "in .gz")
        ->option_text("FILE");
    add_shards(command, o.shards);
    CLI::Option* json = command.add_flag("--json", o.output.json, "JSON Lines on standard output and nothing else");
    command.add_flag("--csv", o.output.csv, "the same as comma-separated values")->excludes(json);
    option("--sabotage", o.sabotage,
           "for tests: damage the bounds, to see that it is found: no-remainder (chords alone), half-bump, first-half "
           "(the first pose of every interval), still-morphs (weights of morph targets of the clip's beginning)")
        ->transform(one_of<TimeSabotage>({{"no-remainder", TimeSabotage::no_remainder},
                                          {"half-bump", TimeSabotage::half_bump},
                                          {"first-half", TimeSabotage::first_half},
                                          {"still-morphs", TimeSabotage::still_morphs}}))
        ->option_text("KIND");
    command.footer(R"(A bound holds at every real time of its interval, keys or not: each vertex stays
below the parabola through the bounds at both ends that its acceleration allows.

Limits of bones, by the names that the file gives them:
  {"bones": {"Head": {"degrees": 40},
             "Knee": {"axis": [1, 0, 0], "degrees": [0, 130]},
             "Hips": {"degrees": 180, "move": 0.5}},
   "others": {"degrees": 5}}
degrees from the file's pose about any axis, or from one angle to another about
an axis of the bone's; move: of its joint, in the file's unit; others: of bones
that are not named [none].

Examples:
  cinch bake robot.glb                       all clips, the character's box
  cinch bake robot.glb --whole --level -1 --json > bounds.jsonl
  cinch bake robot.glb --clip Robot_Dance --interval 0.25 --npz dance.npz
  cinch bake robot.glb --usd bounds.usda     to be sublayered
  cinch bake robot.glb --level -1 --prove    and an exact proof of each
  cinch bake robot.glb --certificate robot.jsonl.gz
  cinch bake robot.glb --engine float32 --joint-error 1e-5 --nlerp
  cinch bake face.vrm --morphs any           for weights that a program sets
  cinch bake robot.glb --poses limits.json --prove   for what a program sets
  cinch bake robot.glb --report              how tight, and what frames miss
  cinch bake robot.glb --prove --out proof   clip by clip, and on after a Ctrl-C

Exit status: 0 done, 1 a bound not proven, 2 bad usage or input, 130 interrupted
(of the clips that were done there are results, but no files).)");
}

} // namespace cinch
