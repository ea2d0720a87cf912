// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cinch/refit.hpp"
#include "experiments/input.hpp"
#include "experiments/records/run_campaign.hpp"
#include "experiments/report/record_output.hpp"

namespace cinch {

/// Damage done on purpose, to see the verifier find it.
enum class Sabotage { none, no_rounding, swap_interval, lower_h, stale };
void damage(Bvh& bvh, Sabotage sabotage);

/// Whose bounds are proven.
enum class VerifiedUpdate {
    refit, ///< all BVs by the methods
    lazy,  ///< LazyRefit's at the end of a collision query: those on its cut and below by the methods, above it merged,
           ///< leaves from vertices
    full,  ///< the same with all leaves from their vertices, and all else merged
    front, ///< the same with every BV that the query wants by the methods
};

struct VerifyOptions {
    InputOptions input;
    Methods methods = Method::best;
    Precision precision = Precision::float32;
    int passes = 1;
    bool remember = false;
    RestShape rest_shape = RestShape::aabb;
    bool stats = false; ///< memory too
    int kdop = 6;
    VerifiedUpdate update = VerifiedUpdate::refit;
    std::size_t leaf = 0; ///< most triangles; 0: 1 for refit, else 16
    int threads = 0;      ///< 0: as many as the machine has
    OutputOptions output;
    ShardOptions shards;
    std::string certificate; ///< file to write; empty: none
    std::string vipr;        ///< folder for single bounds as VIPR files; empty: none
    bool volume = false;     ///< exact volume ratios too
    Sabotage sabotage = Sabotage::none;
    bool all_times = false; ///< of clips, in place of frames
};

/// Updates BVs in every frame and proves every bound. Returns the exit status: 0 all proven, 1 a check failed, 130
/// interrupted.
int verify(const VerifyOptions& options);

/// The same of bounds of whole clips, for all of their times (bake). Throws InputError for options of frames.
int verify_all_times(const VerifyOptions& options);

} // namespace cinch
