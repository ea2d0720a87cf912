// SPDX-License-Identifier: GPL-3.0-or-later
// The commands whose results are pages.
#include <fmt/format.h>

#include "cinch/bounds.hpp"
#include "experiments/baselines/engines/engine_formula.hpp"
#include "experiments/command_line.hpp"
#include "experiments/command_line_options.hpp"
#include "experiments/report/reproduce.hpp"
#include "experiments/shipped.hpp"
#include "experiments/view.hpp"
#include "toolkit/surface/shapes.hpp"

namespace cinch {

void add_view(CLI::App& app, Run& run)
{
    const auto options = std::make_shared<ViewOptions>();
    ViewOptions& o = *options;
    CLI::App& command = *app.add_subcommand("view", "a page to look at: surface, nodes, bounds (Figs. 1, 6, 7)");
    command.callback([options, &run] {
        options->request.formula_first = !options->request.formulas.empty();
        if (options->request.formula_first)
            options->request.level = 0;
        run = [options] { return view(*options); };
    });
    const auto option = options_of(command);
    std::vector<std::string> formulas;
    for (const EngineFormula& formula : engine_formulas())
        formulas.push_back(formula.name);
    CLI::Option* scene = option("SCENE", o.request.scene,
                                fmt::format("a scene ({}, or a .json file), a shape ({}), a mesh or a skinned "
                                            "character [the paper's figures: brain-pull, santa-ring-6 and fishes]",
                                            fmt::join(shipped_scenes(), ", "), fmt::join(shape_names(), ", ")))
                             ->option_text("");
    option("--report", o.report, "the page to write; it needs nothing else, and no network")->option_text("FILE.html");
    command.add_flag("--json", o.json, wrapped("the views as JSON Lines on standard output and nothing else"));
    option("--frames", o.request.frames, "how many at most, evenly spread, the first and the last included [60]")
        ->check(CLI::Range(1, 10000))
        ->option_text("N")
        ->needs(scene);
    option("--levels", o.request.levels, "levels of the BVH, from the root [8]")
        ->check(CLI::Range(1, 16))
        ->option_text("N")
        ->needs(scene);
    option("--kdop", o.request.kdop, "greatest k to choose from on the page: " + kdop_names() + " [6]")
        ->check(CLI::IsMember(std::vector(kdops.begin(), kdops.end())))
        ->option_text("K")
        ->needs(scene);
    command
        .add_option_function<std::vector<std::string>>(
            "--methods",
            [&o](const std::vector<std::string>& names) {
                o.request.methods.clear();
                for (const std::string& name : names) {
                    const auto method = named_method(name);
                    if (!method || *method == Method::vertices)
                        throw CLI::ValidationError(
                            "--methods",
                            fmt::format("expected names of {}, found '{}'",
                                        fmt::join(method_names(all_methods.without(Method::vertices)), ", "), name));
                    o.request.methods.push_back(*method);
                }
                o.request.method = o.request.methods.front();
            },
            wrapped("to choose from on the page, the first one shown first [all; best]; beside each, the vertices' own "
                    "bound"))
        ->delimiter(',')
        ->option_text("NAME,...")
        ->needs(scene);
    command
        .add_flag("--swept", o.request.swept,
                  wrapped("bounds of intervals too, each for all of its times, as 'cinch bake' has them; a character "
                          "with its morph targets"))
        ->needs(scene);
    option("--formula", o.request.formulas,
           fmt::format("formulas of engines for the whole surface too, the first one shown first: {}",
                       fmt::join(formulas, ", ")))
        ->delimiter(',')
        ->option_text("NAME,...")
        ->needs(scene);
    option("--bits", o.request.bits, "of the grid that positions are rounded to [16]; fewer make a smaller page")
        ->check(CLI::Range(8, 16))
        ->option_text("N")
        ->needs(scene);
    option("--nodes", o.request.nodes, "simulation nodes per body, where they are sampled [as usual]")
        ->check(CLI::Range(1, 100000))
        ->option_text("N")
        ->needs(scene);
    option("--weights", o.request.weights, "weights of a mesh's vertices as text, as 'cinch verify' takes them")
        ->option_text("FILE")
        ->needs(scene);
    option("--transforms", o.request.transforms, "transforms of the simulation nodes as text")
        ->option_text("FILE")
        ->needs(scene);
    option("--clip", o.request.clip, "which clip of a character or of --transforms [the first]")
        ->option_text("NAME")
        ->needs(scene);
    option("--seed", o.request.seed, "seed of everything random [0]")->option_text("N");
    command
        .add_flag("--partial", o.request.partial,
                  wrapped("of a character: what is modelled, saying what is missing [refused]"))
        ->needs(scene);
    command
        .add_option_function<std::vector<double>>(
            "--camera",
            [&o](const std::vector<double>& degrees) {
                o.request.azimuth = degrees[0];
                o.request.elevation = degrees[1];
            },
            wrapped("where it is at first: degrees from +x towards +y, and up [35,20]"))
        ->delimiter(',')
        ->expected(2)
        ->option_text("A,E")
        ->needs(scene);
    option("--threads", o.threads, "threads [all cores]; the page is the same")
        ->check(CLI::Range(1, 1024))
        ->option_text("N");
    command.footer(R"(Examples:
  cinch view --report figures.html      Figs. 1, 6 and 7, about a minute
  cinch view brain-pull --report brain.html --kdop 26
  cinch view santa-ring-6 --report ring.html --methods best,eq12,convex
  cinch view fishes --report fishes.html --frames 30 --levels 5 --bits 14
  cinch view robot.glb --report robot.html
  cinch view robot.glb --clip Robot_Dance --swept --report dance.html
  cinch view robot.glb --formula rest-box --report outside.html

Bounds are rounded outward to the grid of the vertices, so that what is drawn
of a bound contains what is drawn of the surface.
Exit status: 0 done, 2 bad usage or input, 130 interrupted (the page has the
views and methods that were done).)");
}

void add_reproduce(CLI::App& app, Run& run)
{
    const auto options = std::make_shared<ReproduceOptions>();
    ReproduceOptions& o = *options;
    CLI::App& command = *app.add_subcommand("reproduce", "all of the paper's tables and figures, as a page");
    command.callback([options, &run] { run = [options] { return reproduce(*options); }; });
    command.add_flag(
        "--quick", o.quick,
        wrapped("fewer scenes, frames and repetitions: under three minutes on two cores, instead of under 45"));
    command.add_option("--out", o.out, wrapped("folder for the results and report.html [results]"))->option_text("DIR");
    command
        .add_option("--shard", o.shard,
                    wrapped("every N-th experiment, from the I-th on, and no page, which 'cinch merge DIR' writes; "
                            "slurm: that of the array job's task"))
        ->option_text("I/N");
    command.add_option("--seed", o.seed, wrapped("seed of everything random [0]"))->option_text("N");
    command.footer(R"(Runs the experiments that are not in DIR yet, for this commit and these options,
each by a command of this program, whose JSON Lines become DIR/NAME.jsonl. Then
writes DIR/report.html: the paper's figures beside these, one file to send
around. Stopped or killed, the same command continues.

Examples:
  cinch reproduce --quick --out quick    a first look
  cinch reproduce                        everything
  cinch reproduce --shard 2/5            a fifth of it, on one of five machines
  cinch report results                   the page again

Exit status: 0 done, 1 a check of an experiment failed, 2 bad usage, an
experiment that could not run, or a damaged result (the rest is done),
130 interrupted (what is finished is kept).)");
}

void add_report(CLI::App& app, Run& run)
{
    const auto options = std::make_shared<ReportOptions>();
    ReportOptions& o = *options;
    CLI::App& command = *app.add_subcommand("report", "the page of 'cinch reproduce', from stored results");
    command.callback([options, &run] { run = [options] { return report(*options); }; });
    command.add_option("DIR", o.folder, wrapped("folder that 'cinch reproduce --out DIR' wrote"))
        ->required()
        ->option_text("");
    command.add_option("--page", o.page, wrapped("file to write [DIR/report.html]"))->option_text("FILE.html");
    command.footer(R"(A file that is truncated or damaged is named, with the line, and left out.

Examples:
  cinch report results
  cinch report results --page paper.html

Exit status: 0 done, 2 bad usage, no results, or a file is damaged (the page has
the rest).)");
}

} // namespace cinch
