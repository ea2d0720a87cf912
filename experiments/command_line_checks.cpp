// SPDX-License-Identifier: GPL-3.0-or-later
// The commands that prove, or look for what cannot be proven.
#include <algorithm>
#include <cstdio>
#include <limits>

#include <fmt/format.h>

#include "cinch/bounds.hpp"
#include "experiments/command_line.hpp"
#include "experiments/command_line_options.hpp"
#include "experiments/corners.hpp"
#include "experiments/fuzz/fuzz.hpp"
#include "experiments/stability/stability.hpp"

namespace cinch {

void add_corners(CLI::App& app, Run& run)
{
    const auto options = std::make_shared<CornersOptions>();
    CornersOptions& o = *options;
    CLI::App& command = *app.add_subcommand("corners", "true corners of a weight space, and maxima");
    command.callback([options, &run] { run = [options] { return corners(*options); }; });
    const auto option = options_of(command);
    option("CASE", o.files, "case files, see below, names of shipped cases (data/cases), or - for standard input")
        ->required()
        ->option_text("FILE...");
    add_output(command, o.output, Draws::nothing);
    command.add_flag("--list", o.list, wrapped("print every corner, as fractions p/q, as they are found"));
    option("--limit", o.limit, "most corners to list per file [all]")
        ->check(CLI::Range(1, std::numeric_limits<int>::max()))
        ->option_text("N");
    command.footer(R"(A case file is {"n":3,"l":[...],"h":[...],"b":[[...],...]}: weight intervals
with 0 <= l <= h <= 1 and rows of extrema. Numbers are JSON numbers, or
strings that are decimal or hexadecimal floating point ("0x1.8p-1").

Examples:
  cinch corners space.json          count, exact maximum, Eq. 12, bound per row
  cinch corners *.json --json       the same as JSON Lines
  cinch corners space.json --list --limit 10
  cinch corners 038_hyper_n5        a case that comes with the program

Exit status: 0 done, 1 a toolkit bound lies below the exact maximum, 2 bad
usage or input (other files are still answered), 130 interrupted.)");
}

void add_stability(CLI::App& app, Run& run)
{
    const auto options = std::make_shared<StabilityOptions>();
    StabilityOptions& o = *options;
    CLI::App& command = *app.add_subcommand("stability", "hard cases: expected, observed, and their bounds");
    command.callback([options, &run] { run = [options] { return stability(*options); }; });
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
    command.footer(R"(Examples:
  cinch stability                       all cases, about ten seconds
  cinch stability --case inverted,flat
  cinch stability --without completion  what the safeguard is for

Exit status: 0 all pass, 1 a case fails, 2 bad usage, 130 interrupted.)");
}

void add_fuzz(CLI::App& app, Run& run)
{
    const auto options = std::make_shared<FuzzOptions>();
    FuzzOptions& o = *options;
    CLI::App& command = *app.add_subcommand("fuzz", "every method against the exact side, random cases");
    command.callback([options, &run] {
        if (!options->seconds && !options->cases)
            options->cases = 100000;
        if (options->corpus.empty() && options->defect == Defect::none && options->shards.folder.empty())
            options->corpus = "data/hard";
        run = [options] { return fuzz(*options); };
    });
    const auto option = options_of(command);
    option("--seconds", o.seconds, "stop after so many seconds; 0 runs nothing")
        ->check(within(0.0, 1e9))
        ->option_text("X");
    option("--cases", o.cases, "stop after so many cases [100,000 if no --seconds]")
        ->check(CLI::NonNegativeNumber)
        ->option_text("N");
    option("--seed", o.seed, "case i of a seed is always the same [0]")->option_text("N");
    option("--family", o.family,
           fmt::format("only this family: {} [all but the last in turn]", fmt::join(fuzz_families(), ", ")))
        ->check(CLI::Validator(
            [](std::string& text) {
                const auto known = fuzz_families();
                return std::find(known.begin(), known.end(), text) != known.end() ? ""
                                                                                  : "there is no family '" + text + "'";
            },
            ""))
        ->option_text("NAME");
    option("--out", o.shards.folder,
           "keep what is finished in this folder; the same command goes on from there; of a number of --cases")
        ->option_text("DIR");
    option("--shard", o.shards.shard,
           "one part of N, I from 0 to N - 1 (slurm: that of the array job's task); with --out for 'cinch merge DIR', "
           "without every N-th case, beginning with the I-th")
        ->option_text("I/N");
    option(
        "--resume", o.resume,
        "keep the state in this file, and continue from it if it is there; it must be of the same program and options")
        ->option_text("FILE");
    option("--corpus", o.corpus, "where shrunk failures are saved [data/hard, or DIR/failures]")->option_text("DIR");
    option("--threads", o.threads, "threads [all cores]")->check(CLI::Range(1, 1024))->option_text("N");
    add_output(command, o.output, Draws::nothing);
    option("--sabotage", o.defect,
           "for tests: plant a defect: no-rounding, lower-h and small-box must be found, wrong-lambda and sum-order "
           "must prove harmless; of times no-remainder, half-bump, skip-key and still-morphs must be found; nothing is "
           "saved")
        ->transform(one_of<Defect>({defects.begin() + 1, defects.end()}))
        ->option_text("KIND");
    command.footer(R"(Examples:
  cinch fuzz --seconds 600                 ten minutes, all families
  cinch fuzz --cases 1000000 --resume s    can be stopped and continued
  cinch fuzz --family times --seconds 60   clips, bounded for all times
  cinch fuzz --shard 0/4 --seconds 600     one of four machines
  cinch fuzz --cases 1000000000 --out rows --shard slurm   one of a cluster's

A failure is shrunk to the smallest case that still fails and saved as JSON.
Exit status: 0 no violation, 1 a violation, 2 bad usage, 130 interrupted (the
summary is printed).)");
}

} // namespace cinch
