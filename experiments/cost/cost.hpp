// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "cinch/bounds.hpp"
#include "cinch/refit.hpp"
#include "experiments/input.hpp"
#include "experiments/records/run_campaign.hpp"
#include "experiments/report/record_output.hpp"

namespace cinch {

/// Where a bound of the root that tightens stops.
struct AnytimeLimits {
    std::vector<double> budgets_ns{5e3, 1e4, 2e4, 5e4, 1e5, 2e5, 5e5};
    std::vector<double> tolerances{0.01, 0}; ///< of its width
};

struct CostOptions {
    InputOptions input;
    std::vector<int> kdops{cinch::kdops.begin(), cinch::kdops.end()};
    double seconds = 2;    ///< of measuring per k
    std::size_t leaf = 16; ///< triangles
    AnytimeLimits anytime;
    bool all_scenes = true; ///< the gap of the dual evaluation on every shipped shape, not on the input alone
    ShardOptions shards;
    OutputOptions output;
};

/// What accuracy costs in time: every method in every arithmetic, with looseness and what is guaranteed; and how far
/// the dual evaluation stays from the optimum. Returns the exit status.
int cost(const CostOptions& options);
/// The same of rows that shards have measured (`cinch merge`).
int print_cost(const Merged& all, const OutputOptions& options);

/// BVs on which arithmetics are compared: one of each level, in one frame.
struct CostSample {
    const DeformableSurface& surface;
    const Bvh& bvh;
    std::span<const AffineMap> maps;
    std::vector<std::size_t> bvs;
};

/// A method in an arithmetic, as something to run: bounds all BVs of the sample, k supports each.
struct CostContestant {
    std::string method, arithmetic, guarantee;
    bool proven = false;
    std::function<void(std::span<double> supports)> bound;
};
/// Methods over the BV's own box (convex, eq12, limited) in scalar arithmetics from float to lazy exact numbers;
/// "rational" is the exact value of each method.
std::vector<CostContestant> scalar_contestants(const CostSample& sample, int kdop);
/// All methods with kernels, in float and double, proven and not.
std::vector<CostContestant> kernel_contestants(const CostSample& sample, int kdop);
/// Of the root alone: one bound, ever tighter ones, and all vertices.
std::vector<CostContestant> anytime_contestants(const CostSample& sample, int kdop, const AnytimeLimits& limits);

/// How far D after so many passes lies above the optimum, in per cent of the bound's width: means over directions and
/// frames.
struct DualGap {
    std::string input;
    Method method;
    std::size_t least_n, most_n; ///< BVs with so many simulation nodes
    std::size_t bounds;
    double gap[5];          ///< after 0 to 4 passes
    std::size_t frames = 0; ///< of the clip
};
std::vector<DualGap> dual_gaps(const Input& input, std::size_t leaf);

} // namespace cinch
