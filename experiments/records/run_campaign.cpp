// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/records/run_campaign.hpp"

#include <cstdio>
#include <optional>

#include <fmt/format.h>

#include "cinch/surface.hpp"
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

Completeness CampaignRun::completeness() const
{
    return {0, 0, is_whole(), is_whole() ? "" : interrupted_after(done, wanted, "cells")};
}

CampaignRun run_campaign(const Campaign& campaign, const ShardOptions& options,
                         const std::function<Rows(std::size_t)>& compute)
{
    CampaignRun run{{campaign, std::vector<Rows>(campaign.cells)},
                    options.shard.empty() ? Shard{} : parse_shard(options.shard)};
    const Shard& shard = run.shard;
    if (!options.shard.empty() && options.folder.empty())
        throw InputError("--shard needs --out DIR, the folder in which the shards meet");
    std::optional<ShardFile> file;
    if (!options.folder.empty()) {
        file.emplace(options.folder, campaign, shard);
        for (const auto& [cell, rows] : file->cells())
            run.all.cells[cell] = rows;
        run.done = file->cells().size();
    }
    run.wanted = shard.of(campaign.cells);
    const std::size_t before = run.done;
    try {
        Progress progress(campaign.command, run.wanted - before);
        for (std::size_t cell = shard.index; cell < campaign.cells; cell += shard.count) {
            if (file && file->cells().contains(cell))
                continue;
            throw_if_interrupted();
            try {
                run.all.cells[cell] = compute(cell);
            } catch (const CutShort& part) {
                run.all.cells[cell] = part.rows;
                throw;
            }
            if (file)
                file->add(cell, run.all.cells[cell]);
            progress.done(++run.done - before);
        }
    } catch (const CutShort&) {
    } catch (const Interrupted&) {
        if (run.done == 0)
            throw;
    }
    return run;
}

int end_run(const CampaignRun& run, const ShardOptions& options, int verdict, const std::function<void()>& print)
{
    if (run.shard.count == 1)
        print();
    else
        fmt::print("shard {} of {}: {} of {} cells are in {}; when all shards are, run 'cinch merge {}'\n",
                   run.shard.index, run.shard.count, run.done, run.wanted, options.folder, options.folder);
    std::fflush(stdout);
    if (!run.is_whole())
        fmt::print(stderr, "cinch: {}; {}\n", run.completeness().note,
                   options.folder.empty() ? "with --out DIR they would be kept, and the same command would go on"
                                          : "the same command goes on from there");
    return verdict ? verdict : run.is_whole() ? 0 : 130;
}

} // namespace cinch
