// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cinch {

/// One experiment of `cinch reproduce`: a command of this program, whose JSON Lines are stored as NAME.jsonl.
struct Stage {
    std::string name;
    std::string what;                   ///< for people
    std::vector<std::string> arguments; ///< all of it; --json and --seed are added
    std::vector<std::string> quick;     ///< the same on less data; empty: not part of --quick
    double seconds, quick_seconds;      ///< to expect on two cores; for the time left only

    /// Whether its command keeps what is finished with --out, and is no measurement of times.
    bool runs_in_cells() const;
};

/// In the order in which they run: those that say most come first.
std::vector<Stage> stages();

/// Arguments of a stage's run, --json and --seed included.
std::vector<std::string> arguments_of(const Stage& stage, bool quick, std::uint64_t seed);

} // namespace cinch
