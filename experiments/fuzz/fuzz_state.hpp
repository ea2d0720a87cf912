// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>

#include "experiments/report/file_lock.hpp"

namespace cinch {

/// All that decides which cases a run of `cinch fuzz` draws and what it makes of them.
struct FuzzSettings {
    std::string version, commit; ///< of the program
    std::uint64_t seed = 0;
    std::string family; ///< empty: all in turn
    std::uint64_t shard = 0, shards = 1;
    std::string sabotage; ///< empty: none
};

/// What is done so far. Cases [0, next) of the shard are finished, each once.
struct FuzzState {
    std::uint64_t next = 0, violations = 0;
    double seconds = 0;
    std::set<std::string> shrunk; ///< families of which a failure has been reported

    bool operator==(const FuzzState&) const = default;
};

/// A state as the text of its file, and back: one line of JSON with the settings, the state and a checksum of them.
/// Reading throws InputError, which names `file` and the field, for anything but what was written with these settings.
std::string fuzz_state_text(const FuzzSettings& settings, const FuzzState& state);
FuzzState parse_fuzz_state(const std::string& text, const std::string& file, const FuzzSettings& settings);

/// The file of one run's state. While it is there no other process has it.
class FuzzStateFile {
public:
    /// Takes the lock, FILE.lock, and reads the state, or saves one of nothing done if there is no file.
    FuzzStateFile(const std::string& file, const FuzzSettings& settings);

    const FuzzState& found() const { return found_; }
    /// At any moment the file holds one whole state, this one or the one before.
    void save(const FuzzState& state) const;

private:
    std::string file_;
    FuzzSettings settings_;
    FileLock lock_;
    FuzzState found_;
};

} // namespace cinch
