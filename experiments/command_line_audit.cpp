// SPDX-License-Identifier: GPL-3.0-or-later
#include "cinch/surface.hpp"
#include "experiments/audit/audit.hpp"
#include "experiments/audit/crowd.hpp"
#include "experiments/command_line.hpp"
#include "experiments/command_line_options.hpp"

namespace cinch {

void add_audit(CLI::App& app, Run& run)
{
    const auto options = std::make_shared<AuditOptions>();
    AuditOptions& o = *options;
    const auto outside = std::make_shared<std::vector<std::string>>();
    CLI::App& command = *app.add_subcommand("audit", "what the bounds of engines do on your files");
    const auto crowd = std::make_shared<CrowdAuditOptions>();
    command.callback([options, crowd, outside, &run] {
        crowd->output = options->output;
        run = [options, crowd, outside] {
            for (const std::string& text : *outside)
                options->outside.push_back(parse_outside(text));
            if (options->inputs.empty() == (crowd->bodies == 0))
                throw InputError("audit needs files, or --crowd N");
            if (crowd->bodies > 0 && !options->shards.folder.empty())
                throw InputError("--out is of files; not with --crowd");
            return crowd->bodies > 0 ? audit_crowd(*crowd) : audit(*options);
        };
    });
    const auto option = options_of(command);
    command
        .add_option(
            "FILE", o.inputs,
            wrapped("characters (.glb, .gltf, .vrm), scenes, shapes, or a mesh with --weights and --transforms"))
        ->option_text("...");
    option("--clip", o.input.clip, "of a character, the only one to audit [all]")->option_text("NAME");
    option("--weights", o.input.weights, "weights of a mesh's vertices as text, as 'cinch verify' takes them")
        ->option_text("FILE");
    option("--transforms", o.input.transforms, "transforms of the simulation nodes as text")->option_text("FILE");
    command.add_flag("--partial", o.input.partial,
                     wrapped("of a character: what is modelled, saying what is missing [refused]"));
    option("--samples", o.samples, "instants between two keys [4]")->check(CLI::Range(0, 100000))->option_text("N");
    option("--seconds", o.seconds, "of measuring times, per clip [0.2]")->check(within(0.001, 1e6))->option_text("X");
    option("--outside", *outside, "another method, a shell command: frames in, bounds out (data/README.md)")
        ->option_text("NAME=COMMAND...");
    option("--show", o.show, "print the counterexample of this number in place of the table")
        ->check(CLI::Range(1, 1000000000))
        ->option_text("K");
    option("--crowd", crowd->bodies,
           "no files, but this many bodies of 22 and of 70 simulation nodes: what a box each, and 64, cost")
        ->check(CLI::Range(1, 1000000))
        ->option_text("N");
    add_shards(command, o.shards);
    add_output(command, o.output, Draws::nothing);
    command.footer(R"(Each formula is written from its engine's documentation. It is refuted by a
vertex that is outside at an instant, in real arithmetic; proven at all real
times by the exact side, where one box stands for a whole clip or convexity
decides; else it holds at the instants that were tried. Our own bounds are in
the same table.

Examples:
  cinch audit robot.glb                    all of its clips
  cinch audit robot.glb --clip Robot_Dance --show 1
  cinch audit *.glb --json > audit.jsonl
  cinch audit *.glb --out rows             clip by clip, and on after a Ctrl-C
  cinch audit robot.glb --outside 'mine=./my-method --margin 0.01'
  cinch audit --crowd 1000                 what boxes of crowds cost

Exit status: 0 audited, whatever was found; 2 bad usage or input, 130
interrupted (results so far are printed).)");
}

} // namespace cinch
