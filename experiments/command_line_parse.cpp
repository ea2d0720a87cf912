// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstdio>
#include <numeric>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "experiments/command_line.hpp"
#include "experiments/report/provenance.hpp"

namespace cinch {
namespace {

constexpr int bad_usage = 2;

// Levenshtein's.
std::size_t distance(const std::string& a, const std::string& b)
{
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), 0);
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t diagonal = row[0]++;
        for (std::size_t j = 0; j < b.size(); ++j) {
            const std::size_t above = row[j + 1];
            row[j + 1] = std::min({diagonal + (a[i] != b[j]), above + 1, row[j] + 1});
            diagonal = above;
        }
    }
    return row.back();
}

// "; did you mean 'verify'?", where one of them is near.
std::string nearest(const std::string& word, const std::vector<std::string>& known)
{
    const auto best = std::min_element(known.begin(), known.end(), [&](const std::string& a, const std::string& b) {
        return distance(word, a) < distance(word, b);
    });
    return best != known.end() && distance(word, *best) <= std::max<std::size_t>(1, word.size() / 3)
               ? fmt::format("; did you mean '{}'?", *best)
               : "";
}

std::vector<std::string> names_of(const CLI::App& app)
{
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
        names.push_back(command->get_name());
    return names;
}

// For the first of the words that looks like an option of the command and is none.
std::string hint(const CLI::App& command, int argc, char** argv)
{
    std::vector<std::string> known;
    for (const CLI::Option* option : command.get_options())
        for (const std::string& name : option->get_lnames())
            known.push_back("--" + name);
    for (int i = 2; i < argc; ++i) {
        const std::string word = std::string(argv[i]).substr(0, std::string(argv[i]).find('='));
        if (word.starts_with("--") && word.size() > 2 && std::find(known.begin(), known.end(), word) == known.end())
            return nearest(word, known);
    }
    return "";
}

int refuse(const std::string& why)
{
    fmt::print(stderr, "cinch: {}\n", why);
    return bad_usage;
}

} // namespace

std::optional<int> parse_command_line(int argc, char** argv, std::span<const AddCommand> commands, Run& run)
{
    CLI::App app{"cinch: tight, proven bounds for surfaces deformed by few simulation nodes", "cinch"};
    app.require_subcommand(1);
    const std::string program = describe(provenance(0, 0));
    app.set_version_flag("--version", program.substr(0, program.find(',')));
    app.footer("'cinch COMMAND --help' or 'cinch help COMMAND' says more, with examples.\n"
               "CINCH_TARGET=NAME forces the instruction set of the kernels, for example\n"
               "CINCH_TARGET=AVX2.\n"
               "\n"
               "Exit status:\n"
               "  0    done, and all that was checked holds\n"
               "  1    a verdict: a bound is refuted, or a check or a step failed; nothing else\n"
               "  2    no verdict: bad usage or input, a full disk, too little memory\n"
               "  130  interrupted (Ctrl-C; 143 by SIGTERM): results so far are printed and say\n"
               "       that they are not all; a second Ctrl-C ends the command at once\n"
               "An output appears when it is whole; until then it is NAME.XXXXXX.part beside it.");
    for (const AddCommand add : commands)
        add(app, run);
    if (argc == 1)
        return refuse("no command given (see 'cinch --help')");
    const std::vector<std::string> known = names_of(app);
    std::vector<std::string> words(argv + 1, argv + argc);
    if (words[0] == "help") {
        if (words.size() > 2)
            return refuse(fmt::format("'cinch help' takes one command, found '{}' too", words[2]));
        words = words.size() == 1 ? std::vector<std::string>{"--help"} : std::vector<std::string>{words[1], "--help"};
    }
    const bool of_command = !words[0].starts_with('-');
    if (of_command && std::find(known.begin(), known.end(), words[0]) == known.end())
        return refuse(fmt::format("unknown command '{}'{} (see 'cinch --help')", words[0], nearest(words[0], known)));
    try {
        app.parse(std::vector<std::string>(words.rbegin(), words.rend())); // which takes them from the end
    } catch (const CLI::Success& success) {                                // --help, --version
        return app.exit(success);
    } catch (const CLI::ParseError& error) {
        return refuse(fmt::format("{}{} (see 'cinch {}--help')", error.what(),
                                  of_command ? hint(*app.get_subcommand(words[0]), argc, argv) : "",
                                  of_command ? words[0] + " " : ""));
    }
    return std::nullopt;
}

} // namespace cinch
