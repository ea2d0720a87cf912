// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>

namespace CLI {
class App;
}

namespace cinch {

/// What a parsed command line asks for; returns the exit status.
using Run = std::function<int()>;

/// Each adds a subcommand with its options and its help; when the command line names it, `run` is set.
void add_scaling(CLI::App& app, Run& run);
void add_simulate(CLI::App& app, Run& run);
void add_collide(CLI::App& app, Run& run);
void add_view(CLI::App& app, Run& run);
void add_reproduce(CLI::App& app, Run& run);
void add_report(CLI::App& app, Run& run);
void add_study(CLI::App& app, Run& run);
void add_merge(CLI::App& app, Run& run);
void add_schema(CLI::App& app, Run& run);
#ifdef CINCH_EXACT
void add_verify(CLI::App& app, Run& run);
void add_audit(CLI::App& app, Run& run);
void add_bake(CLI::App& app, Run& run);
void add_tightness(CLI::App& app, Run& run);
void add_cost(CLI::App& app, Run& run);
void add_corners(CLI::App& app, Run& run);
void add_stability(CLI::App& app, Run& run);
void add_fuzz(CLI::App& app, Run& run);
#endif

/// A command as a program has it: one of the above.
using AddCommand = void (*)(CLI::App& app, Run& run);

/// The command line of a program of these commands: sets `run`, and returns nothing; or the exit status where that is
/// all there is to do, with what --help or --version print, or one line on standard error.
std::optional<int> parse_command_line(int argc, char** argv, std::span<const AddCommand> commands, Run& run);

/// The whole program: parses, runs, and returns the exit status; one line on standard error where there is no result.
int run_program(int argc, char** argv, std::span<const AddCommand> commands);

} // namespace cinch
