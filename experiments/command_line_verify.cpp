// SPDX-License-Identifier: GPL-3.0-or-later
#include "cinch/bounds.hpp"
#include "experiments/command_line.hpp"
#include "experiments/command_line_options.hpp"
#include "experiments/verify.hpp"

namespace cinch {

void add_verify(CLI::App& app, Run& run)
{
    const auto options = std::make_shared<VerifyOptions>();
    VerifyOptions& o = *options;
    CLI::App& command = *app.add_subcommand("verify", "prove every bound in exact arithmetic");
    command.callback([options, &run] {
        run = [options] { return options->all_times ? verify_all_times(*options) : verify(*options); };
    });
    add_input(command, o.input);
    const auto option = options_of(command);
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
    option("--times", o.all_times,
           "what is proven: frames (at each of them), or all (at all real times of every clip, or of --clip) [frames]")
        ->transform(one_of<bool>({{"frames", false}, {"all", true}}))
        ->option_text("WHICH");
    option("--morphs", o.input.morphs,
           "with --times all: weights that morph targets may have at any time: any, from 0 to 1, or other limits [as "
           "the clips say]")
        ->option_text("any|LEAST..GREATEST");
    option("--leaf", o.leaf, "most triangles per leaf [1; 16 with --update or --times all]")
        ->check(CLI::Range(1, 1000000))
        ->option_text("N");
    option("--threads", o.threads, "threads [all cores]")->check(CLI::Range(1, 1024))->option_text("N");
    add_shards(command, o.shards);
    add_output(command, o.output);
    option(
        "--certificate", o.certificate,
        "write a proof of every bound, for experiments/check_certificate.py; compressed if it ends in .gz; with --out "
        "a folder in DIR, of a file per frame, which 'cinch merge DIR' ends; with --times all over each whole clip")
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
    command.footer(R"(Examples:
  cinch verify                               the 30,000-vertex brain, 509 nodes
  cinch verify hand.ply --nodes 200          a mesh of yours, standard motion
  cinch verify robot.glb --clip Robot_Dance  a skinned character
  cinch verify rest.off --weights w.txt --transforms t.txt --json
  cinch verify fish --certificate fish.jsonl.gz
  cinch verify robot.glb --out rows --certificate proof --shard 0/8
  cinch verify santa-ring-3 --update lazy    the bounds that collision reads
  cinch verify robot.glb --times all         all clips, between frames too

Text form of weights and transforms ('#' starts a comment):
  weights     'V J'; then per vertex 'n j1 w1 ... jn wn': nodes from 0, weights
              >= 0, normalised on load
  transforms  number of clips; per clip 'name K J', then K lines: time, and for
              every node its row-major 3x4 matrix. Vertex k moves to the sum of
              w_j M_j (x, y, z, 1).

Exit status: 0 all proven, 1 a bound violated, 2 bad usage or input,
130 interrupted (results so far are printed; a certificate is not written).)");
}

} // namespace cinch
