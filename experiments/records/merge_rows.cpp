// SPDX-License-Identifier: GPL-3.0-or-later
// The other half of row_folder.hpp: what shards were to compute, found again.
#include <algorithm>

#include <fmt/format.h>

#include "cinch/surface.hpp"
#include "experiments/records/shard_text.hpp"

namespace cinch {
namespace fs = std::filesystem;
namespace {

// "0-3,7", for sbatch --array.
std::string ranges(const std::vector<std::size_t>& ascending)
{
    std::string out;
    for (std::size_t i = 0; i < ascending.size();) {
        std::size_t end = i;
        while (end + 1 < ascending.size() && ascending[end + 1] == ascending[end] + 1)
            ++end;
        out += (out.empty() ? "" : ",") + std::to_string(ascending[i]) +
               (end > i ? "-" + std::to_string(ascending[end]) : "");
        i = end + 1;
    }
    return out;
}

} // namespace

Merged merge(const fs::path& folder)
{
    std::error_code error;
    if (!fs::is_directory(folder, error))
        throw InputError::in_file(folder.string(), "is no folder of rows (--out)");
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.path().extension() == ".jsonl" && entry.path().filename().string().starts_with("shard-"))
            files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    if (files.empty())
        throw InputError::in_file(folder.string(), "has no shards; were they written with --out of this folder?");
    Merged out;
    std::optional<std::size_t> shards;
    std::vector<std::size_t> unfinished;
    std::vector<std::string> why;
    std::vector<char> seen;
    for (const fs::path& file : files) {
        auto content = read_shard(file);
        if (!content)
            continue; // counted as missing
        if (!shards) {
            shards = content->shard.count;
            out.campaign = content->campaign;
            out.cells.resize(out.campaign.cells);
            seen.assign(*shards, 0);
        }
        if (const std::string what = difference(content->campaign, out.campaign); !what.empty())
            throw InputError::in_file(
                file.string(), fmt::format("has rows of {} ({}); remove one of the two", what, files[0].string()));
        if (content->shard.count != *shards)
            throw InputError::in_file(
                file.string(),
                fmt::format("is one of {} shards, {} of {}: cells would be there twice; remove one of the two",
                            content->shard.count, files[0].string(), *shards));
        if (seen[content->shard.index]++)
            throw InputError::in_file(
                file.string(), fmt::format("is shard {} again: it is there twice; remove one", content->shard.index));
        const std::size_t wanted = content->shard.of(out.campaign.cells);
        if (content->cells.size() < wanted) {
            unfinished.push_back(content->shard.index);
            why.push_back(fmt::format("shard {} has {} of {} cells{}", content->shard.index, content->cells.size(),
                                      wanted, content->is_torn ? ", and a torn line" : ""));
        }
        for (auto& [cell, rows] : content->cells)
            out.cells[cell] = std::move(rows);
    }
    if (!shards)
        throw InputError::in_file(folder.string(), "has no shard with a whole first line; run them again");
    for (std::size_t i = 0; i < *shards; ++i)
        if (!seen[i] && Shard{i, *shards}.of(out.campaign.cells) > 0) {
            unfinished.push_back(i);
            why.push_back(fmt::format("shard {} is missing", i));
        }
    if (unfinished.empty())
        return out;
    std::sort(unfinished.begin(), unfinished.end());
    const std::size_t shown = std::min<std::size_t>(why.size(), 5);
    throw InputError::in_file(
        folder.string(),
        fmt::format("{}{}. Run --shard I/{} for I = {}, or sbatch --array={} --export=ALL,CINCH_SHARDS={}",
                    fmt::join(why.begin(), why.begin() + static_cast<std::ptrdiff_t>(shown), "; "),
                    why.size() > shown ? fmt::format("; and {} more", why.size() - shown) : "", *shards,
                    ranges(unfinished), ranges(unfinished), *shards));
}

} // namespace cinch
