// SPDX-License-Identifier: GPL-3.0-or-later
// The commands that go past one run and one machine.
#include "experiments/command_line.hpp"
#include "experiments/command_line_options.hpp"
#include "experiments/merge.hpp"
#include "experiments/records/schema.hpp"
#include "experiments/study/study.hpp"

namespace cinch {

void add_study(CLI::App& app, Run& run)
{
    const auto options = std::make_shared<StudyOptions>();
    StudyOptions& o = *options;
    CLI::App& command = *app.add_subcommand("study", "tightness of many inputs, nodes, seeds and methods");
    command.callback([options, &run] { run = [options] { return study(*options); }; });
    const auto option = options_of(command);
    option("PLAN", o.plan, "what to study, a JSON file, see below; - for standard input")
        ->required()
        ->option_text("FILE");
    add_shards(command, o.shards);
    option("--threads", o.threads, "threads [all cores]; the rows are the same")
        ->check(CLI::Range(1, 1024))
        ->option_text("N");
    add_output(command, o.output);
    command.footer(R"(A plan has any of these fields; each may be one value or a list:
  inputs      shapes, files, patterns ("meshes/*.off"), scenes  ["brain"]
  nodes       simulation nodes                                  [as usual]
  seeds       of everything random                              [0]
  motions     scripted motions, or those of a text file         [the first]
  clips       of characters                                     [the first]
  methods     as for --method of 'cinch verify'                 ["best"]
  precisions  "float", "double"                                 ["float"]
  kdops       6, 14, 18, 26                                     [6]
and of these, one value each:
  frames      how many, evenly spread                           [all]
  leaf        most triangles per leaf                           [1]
  passes      evaluations of the dual function                  [1]
  support     reach of a simulation node, in fill distances     [2]
  fps         frames per second sampled from a character's clip [30]
  partial     bound what is modelled of characters              [false]
  detail      "run", or rows of "levels", "frames", "bvs" too   ["run"]
Whole numbers may be ranges: "1-20" is all of them, "16..512" is doubled.

Examples:
  cinch study plan.json --out rows           kept; run again, it goes on
  cinch study plan.json --out rows --shard 0/7   a seventh of it
  cinch merge rows --csv                     all of it, whoever computed it
  echo '{"inputs": ["brain-3500", "santa"], "nodes": "16..256", "seeds": "1-5",
         "methods": ["eq12", "best"]}' | cinch study -

Exit status: 0 done, 2 bad usage or input, 130 interrupted (with --out, rows so
far are kept).)");
}

void add_merge(CLI::App& app, Run& run)
{
    const auto options = std::make_shared<MergeOptions>();
    MergeOptions& o = *options;
    CLI::App& command = *app.add_subcommand("merge", "one result from the shards of a run");
    command.callback([options, &run] { run = [options] { return merge_shards(*options); }; });
    command.add_option("DIR", o.folder, wrapped("the folder that the shards were given (--out)"))
        ->required()
        ->option_text("");
    add_output(command, o.output, Draws::nothing);
    command.footer(R"(Prints what the same command prints without --shard, to the last byte. All
shards must be of one plan, one program and one number of shards, and be whole:
else it names the odd one, or those to run, and how.

Examples:
  cinch merge rows
  cinch merge rows --json > rows.jsonl

Exit status: 0 done, 1 a bound is refuted, 2 shards are missing, damaged or do
not fit together.)");
}

void add_schema(CLI::App& app, Run& run)
{
    CLI::App& command = *app.add_subcommand("schema", "what the fields of records are, as JSON Schema");
    command.callback([&run] { run = print_schema; });
    command.footer(R"(Every line that a command prints with --json, and every row of --csv, is a
record of this schema; the corners that 'cinch corners --list' prints are not.

Examples:
  cinch schema > record.schema.json
  cinch schema | jq '.properties.mean_ratio'

Exit status: 0.)");
}

} // namespace cinch
