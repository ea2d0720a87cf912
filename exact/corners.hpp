// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "toolkit/bounds/weight_space.hpp"

namespace cinch::exact {

/// One vertex of W': every weight at its l or h but for at most one, which the sum to 1 decides.
struct Corner {
    std::span<const std::uint64_t>
        at_upper;     ///< bit i of word i/64: weight CornerRun::order[i] is at h; the others are at l
    int between = -1; ///< position in CornerRun::order of the weight strictly between l and h, or −1
};

/// What a visitor of corners needs to know of the run.
struct CornerRun {
    std::span<const std::uint32_t> order; ///< weights with l < h, widest first; all other weights are l = h
};

/// Return false to stop.
using CornerVisitor = std::function<bool(const CornerRun&, const Corner&)>;

/// Exactly Σ l ≤ 1 ≤ Σ h and l ≤ h. The doubles may be any, dyadic to 2^-53 or not; spans of equal length.
bool is_feasible(WeightSpace space);

/// Visits every vertex of W' once, degenerate ones too, in exact integers of the narrowest kind that holds the input.
/// Output- sensitive: every branch of the search leads to a vertex. Memory O(n). Returns how many were visited.
std::uint64_t visit_corners(WeightSpace space, const CornerVisitor& visit);

/// The weights of a corner as fractions "p/q" in lowest terms.
std::vector<std::string> weights_of(WeightSpace space, const CornerRun& run, const Corner& corner);

/// The number of vertices without listing them, or why it is not counted.
struct CornerCount {
    std::optional<std::string> count; ///< decimal
    std::string reason;               ///< set where count is not
};
/// Meet in the middle up to 44 weights with l < h, dynamic programming on coarse grids beyond; otherwise it answers at
/// once.
CornerCount count_corners(WeightSpace space);

} // namespace cinch::exact
