// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "experiments/records/shard.hpp"

namespace cinch {

using Rows = std::vector<nlohmann::ordered_json>;

/// What decides the rows of a run, whoever computes them and in how many shards. Its cells are numbered; each is
/// computed by itself and has rows of its own.
struct Campaign {
    std::string command;
    nlohmann::ordered_json plan; ///< all that the rows depend on
    std::size_t cells = 0;
    std::string version, commit, compiler, flags; ///< of the program

    bool operator==(const Campaign&) const = default;
};

/// The file of one shard in a folder: a line that says of what campaign it is, then a line per finished cell, each with
/// a checksum. Lines are appended when they are whole. Another process that has the file is refused; what a kill or a
/// full disk left of a last line is cut off, and its cell is computed again.
class ShardFile {
public:
    /// Makes the folder and the file, or goes on where it ended. Throws InputError for a file of another campaign, one
    /// that is damaged, and what cannot be written.
    ShardFile(const std::filesystem::path& folder, const Campaign& campaign, const Shard& shard);
    ~ShardFile();
    ShardFile(ShardFile&&) noexcept;

    /// Those that are finished, by their numbers.
    const std::map<std::size_t, Rows>& cells() const;
    void add(std::size_t cell, const Rows& rows);

private:
    struct Handle;
    std::unique_ptr<Handle> handle_;
};

/// All of a campaign, whatever shards computed it.
struct Merged {
    Campaign campaign;
    std::vector<Rows> cells;
};

/// Reads a folder. Throws InputError, which says what to run, where shards are missing, unfinished, torn, doubled or of
/// another program or plan.
Merged merge(const std::filesystem::path& folder);

} // namespace cinch
