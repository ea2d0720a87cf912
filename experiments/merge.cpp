// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/merge.hpp"

#include <fmt/format.h>

#include "cinch/surface.hpp"
#include "experiments/collide/collide.hpp"
#include "experiments/records/row_folder.hpp"
#include "experiments/report/reproduce.hpp"
#include "experiments/scaling/scaling.hpp"
#include "experiments/study/study.hpp"
#ifdef CINCH_EXACT
#include "experiments/audit/audit.hpp"
#include "experiments/bake/bake.hpp"
#include "experiments/bake/verify_times.hpp"
#include "experiments/cost/cost.hpp"
#include "experiments/fuzz/fuzz_rows.hpp"
#include "experiments/tightness/tightness.hpp"
#include "experiments/verify_rows.hpp"
#endif

namespace cinch {

int merge_shards(const MergeOptions& options)
{
    if (holds_results(options.folder))
        return merge_results(options.folder);
    const Merged all = merge(options.folder);
    if (all.campaign.command == "study") {
        print_study(all, options.output);
        return 0;
    }
    if (all.campaign.command == "scaling")
        return print_scaling(all, options.output);
    if (all.campaign.command == "collide")
        return print_collide(all, options.output);
#ifdef CINCH_EXACT
    if (all.campaign.command == "audit")
        return print_audit(all, options.output);
    if (all.campaign.command == "bake")
        return print_bake(all, options.output);
    if (all.campaign.command == "verify --times all")
        return print_verify_times(all, options.output);
    if (all.campaign.command == "verify")
        return print_verify(all, options.output, options.folder);
    if (all.campaign.command == "cost")
        return print_cost(all, options.output);
    if (all.campaign.command == "tightness")
        return print_tightness(all, options.output);
    if (all.campaign.command == "fuzz")
        return print_fuzz(all, options.output, options.folder);
#endif
    throw InputError::in_file(
        options.folder, fmt::format("has rows of 'cinch {}', which this program cannot print", all.campaign.command));
}

} // namespace cinch
