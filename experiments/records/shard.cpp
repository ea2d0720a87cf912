// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/records/shard.hpp"

#include <charconv>
#include <cstdlib>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "cinch/surface.hpp"

namespace cinch {
namespace {

constexpr std::size_t most_shards = 1000000;

std::optional<std::size_t> whole_number(std::string_view text)
{
    std::size_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || error != std::errc() || end != text.data() + text.size())
        return std::nullopt;
    return value;
}

std::optional<std::size_t> variable(const char* name)
{
    const char* const value = std::getenv(name);
    if (!value)
        return std::nullopt;
    const auto number = whole_number(value);
    if (!number)
        throw InputError(fmt::format("--shard slurm: {}='{}' is no whole number", name, value));
    return number;
}

Shard of_array()
{
    const auto task = variable("SLURM_ARRAY_TASK_ID"), last = variable("SLURM_ARRAY_TASK_MAX"),
               count = variable("CINCH_SHARDS");
    if (!task)
        throw InputError("--shard slurm: there is no SLURM_ARRAY_TASK_ID; is this a task of 'sbatch --array=0-N'?");
    if (!count && !last)
        throw InputError("--shard slurm: set CINCH_SHARDS to the number of shards");
    return {*task, count ? *count : *last + 1};
}

} // namespace

Shard parse_shard(const std::string& text)
{
    Shard shard;
    if (text == "slurm") {
        shard = of_array();
    } else {
        const std::size_t slash = text.find('/');
        const auto index = whole_number(std::string_view(text).substr(0, slash)),
                   count = slash == std::string::npos ? std::nullopt
                                                      : whole_number(std::string_view(text).substr(slash + 1));
        if (!index || !count)
            throw InputError(fmt::format("--shard: expected I/N, as 0/7, or slurm, found '{}'", text));
        shard = {*index, *count};
    }
    if (shard.count == 0 || shard.count > most_shards || shard.index >= shard.count)
        throw InputError(fmt::format("--shard: shards are 0/N to N-1/N, with N from 1 to {}; there is no {}/{}",
                                     most_shards, shard.index, shard.count));
    return shard;
}

} // namespace cinch
