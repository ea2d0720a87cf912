// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/command_line_options.hpp"

#include <fmt/format.h>

#include "experiments/report/table.hpp"
#include "experiments/shipped.hpp"
#include "toolkit/deform/motion.hpp"
#include "toolkit/surface/read_mesh.hpp"
#include "toolkit/surface/shapes.hpp"

namespace cinch {

std::string wrapped(const std::string& text) { return folded(text, 49); }

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

void add_output(CLI::App& command, OutputOptions& o, Draws draws)
{
    CLI::Option* json = command.add_flag("--json", o.json, "JSON Lines on standard output and nothing else");
    command.add_flag("--csv", o.csv, "the same as comma-separated values")->excludes(json);
    if (draws == Draws::charts) {
        command
            .add_option(
                "--plot", o.plot,
                wrapped("draw charts by gnuplot, as .svg, .pdf or .png: the first as FILE, the next as FILE-2 ..."))
            ->option_text("FILE");
        command
            .add_option("--plot-data", o.plot_data, wrapped("write the points of the charts as comma-separated values"))
            ->option_text("FILE.csv");
    }
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

void add_shards(CLI::App& command, ShardOptions& o)
{
    CLI::Option* const folder =
        command
            .add_option("--out", o.folder,
                        wrapped("keep what is finished in this folder; the same command goes on from there"))
            ->option_text("DIR");
    command
        .add_option("--shard", o.shard,
                    wrapped("compute one part of N, I from 0 to N - 1, for 'cinch merge DIR'; slurm: that of the array "
                            "job's task"))
        ->option_text("I/N")
        ->needs(folder);
}

void add_input(CLI::App& command, InputOptions& o, InputLists* lists)
{
    const auto option = options_of(command);
    const std::string inputs =
        fmt::format("a shape ({}), a scene ({}, or a .json file), a mesh ({}) or a skinned character (.glb, .gltf)",
                    fmt::join(shape_names(), ", "), fmt::join(shipped_scenes(), ", "), mesh_extensions());
    const std::string nodes = "simulation nodes sampled in the volume [the paper's number for a shape, 100 for a mesh]";
    const std::string motions = fmt::format("scripted motion: {} [strong]", motion_names);
    if (lists) {
        option("INPUT", lists->inputs, inputs)->option_text("[brain]...");
        option("--nodes", lists->nodes, nodes)->option_text("LIST");
    } else {
        option("INPUT", o.input, inputs)->option_text("[brain]");
        option("--nodes", o.nodes, nodes)->check(CLI::Range(1, 100000))->option_text("N");
    }
    option("--support", o.support, "reach of a simulation node, in fill distances [2]")
        ->check(within(1e-3, 1e3))
        ->option_text("X");
    if (lists)
        option("--motion", lists->motions, motions)->delimiter(',')->option_text("NAME,...");
    else
        option("--motion", o.motion, motions)->option_text("NAME");
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
    if (lists)
        option("--seed", lists->seeds, "seed of everything random [0]")->option_text("LIST");
    else
        option("--seed", o.seed, "seed of everything random [0]")->option_text("N");
    command.add_flag("--partial", o.partial,
                     wrapped("bound what is modelled of a character that has more (morph targets, parts without a "
                             "skin, unknown extensions); every result "
                             "then says 'partial' and what is missing [refused]"));
}

} // namespace cinch
