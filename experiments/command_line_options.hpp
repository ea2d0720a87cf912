// SPDX-License-Identifier: GPL-3.0-or-later
// Options that several commands have, and checks of values.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "cinch/bounds.hpp"
#include "experiments/input.hpp"
#include "experiments/records/run_campaign.hpp"
#include "experiments/report/record_output.hpp"

namespace cinch {

/// A description that begins in column 31, broken for terminals 80 wide: CLI11 does not break lines.
std::string wrapped(const std::string& text);

/// option(name, value, description) adds one to the command, with its description wrapped.
inline auto options_of(CLI::App& command)
{
    return [&command](const char* name, auto& value, const std::string& description) {
        return command.add_option(name, value, wrapped(description));
    };
}

/// Accepts one of the names and nothing else, and says which there are.
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

/// Real numbers; NaN, which CLI::Range lets through, is none of them.
CLI::Validator within(double low, double high);

enum class Draws { charts, nothing };

/// --json, --csv, --plot and --report.
void add_output(CLI::App& command, OutputOptions& o, Draws draws = Draws::charts);
/// --out and --shard.
void add_shards(CLI::App& command, ShardOptions& o);
/// --precision and --passes.
void add_arithmetic(CLI::App& command, Precision& precision, int& passes);
/// --method, one or several.
void add_methods(CLI::App& command, Methods& methods);
/// INPUT, and which part and frames of it; with lists INPUT, --nodes, --motion and --seed go there.
void add_input(CLI::App& command, InputOptions& o, InputLists* lists = nullptr);

} // namespace cinch
