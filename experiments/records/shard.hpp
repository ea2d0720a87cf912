// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>

namespace cinch {

/// The part of a run's cells that one process computes: those whose number leaves `index` when divided by `count`.
struct Shard {
    std::size_t index = 0, count = 1;

    bool has(std::size_t cell) const { return cell % count == index; }
    /// How many of so many cells it has.
    std::size_t of(std::size_t cells) const { return cells / count + (cells % count > index ? 1 : 0); }
};

/// "2/7", counted from 0; or "slurm": the task of an array job, of CINCH_SHARDS in all or, where that is not set, of as
/// many as an array from 0 on has. Throws InputError for anything else.
Shard parse_shard(const std::string& text);

} // namespace cinch
