// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/records/run_campaign.hpp"

#include <fmt/format.h>

#include "cinch/surface.hpp"
#include "experiments/report/interrupt.hpp"
#include "experiments/report/progress.hpp"

namespace cinch {
Campaign campaign_of(std::string command, nlohmann::ordered_json plan, std::size_t cells)
{
    const Provenance here = provenance(0, 0);
    return {std::move(command), std::move(plan), cells, here.version, here.commit, here.compiler, here.flags};
}

Provenance provenance_of(const Campaign& c)
{
    return {"cinch " + c.command, c.version, c.commit, c.compiler, c.flags, "any", "any", 0, 0};
}

std::optional<Merged> run_campaign(const Campaign& campaign, const ShardOptions& options,
                                   const std::function<Rows(std::size_t)>& compute)
{
    const Shard shard = options.shard.empty() ? Shard{} : parse_shard(options.shard);
    if (!options.shard.empty() && options.folder.empty())
        throw InputError("--shard needs --out DIR, the folder in which the shards meet");
    std::optional<ShardFile> file;
    if (!options.folder.empty())
        file.emplace(options.folder, campaign, shard);
    Merged all{campaign, std::vector<Rows>(file ? 0 : campaign.cells)};
    const std::size_t wanted = shard.of(campaign.cells);
    std::size_t done = file ? file->finished() : 0;
    try {
        Progress progress(campaign.command, wanted - done);
        const std::size_t before = done;
        for (std::size_t cell = shard.index; cell < campaign.cells; cell += shard.count) {
            if (file && file->has(cell))
                continue;
            throw_if_interrupted();
            Rows rows = compute(cell);
            if (file)
                file->add(cell, rows);
            else
                all.cells[cell] = std::move(rows);
            progress.done(++done - before);
        }
    } catch (const Interrupted&) {
        fmt::print(stderr, "cinch: {}; {}\n", interrupted_after(done, wanted, "cells"),
                   file ? "the same command goes on from there" : "with --out DIR they would have been kept");
        throw;
    }
    if (!file)
        return all;
    if (shard.count == 1)
        return merge(options.folder);
    fmt::print("shard {} of {}: all of its {} cells are in {}; when all shards are, run 'cinch merge {}'\n",
               shard.index, shard.count, wanted, options.folder, options.folder);
    return std::nullopt;
}

} // namespace cinch
