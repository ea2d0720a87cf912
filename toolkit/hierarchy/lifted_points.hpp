// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "toolkit/bounds/bound_moments.hpp"

namespace cinch {

/// Few of many lifted vectors whose hull comes near all of them.
struct LiftedPoints {
    std::vector<std::uint32_t> chosen; ///< places in `all`
    /// For what is not chosen, coefficients of the chosen ones: multiples of 2^-53 that sum to exactly 1.
    std::vector<std::vector<double>> combination; ///< parallel to `all`; empty for the chosen
};

/// At most `most` ≥ 6 of them, all where there are no more. Greedy: first the extremes of the first three components,
/// then what is farthest from the hull of those before it, distances measured in components times `scale` by pairwise
/// Frank-Wolfe. They need not be exact, as nothing relies on them: the combinations are what counts.
LiftedPoints choose_lifted(std::span<const Lifted> all, const Lifted& scale, std::size_t most);

} // namespace cinch
