// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "experiments/records/row_folder.hpp"

namespace cinch {

/// A shard's file as far as it is whole.
struct ShardText {
    Campaign campaign;
    Shard shard;
    std::map<std::size_t, Rows> cells;
    std::size_t whole_bytes = 0;
    bool is_torn = false; ///< bytes that are no line follow
};

/// Its lines, each with a checksum at its end: the first one, and that of a cell.
std::string first_line(const Campaign& campaign, const Shard& shard);
std::string cell_line(std::size_t cell, const Rows& rows);

/// Where a shard's file is.
std::filesystem::path file_of(const std::filesystem::path& folder, const Shard& shard);

/// Reads a file; nothing where not even the first line is whole. Throws InputError for lines before the last one that
/// are not as they were written.
std::optional<ShardText> read_shard(const std::filesystem::path& file);

/// What the first campaign differs in from the second, for people; empty if in nothing.
std::string difference(const Campaign& one, const Campaign& other);

} // namespace cinch
