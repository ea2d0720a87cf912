// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cinch/bounds.hpp"
#include "cinch/bvh.hpp"

namespace cinch {

/// Reused from call to call, so that bounding allocates nothing once warm.
struct BoundScratch {
    std::vector<double> plus, minus; // extrema b̂_j along the axis and against it
    std::vector<std::pair<double, double>> select;
};

/// The paper's k-DOP refit (§5.4) in O(n): 2·axes.size() supports of the deformed BV, place 2a along axis a and 2a + 1
/// against it. With Rounding::proven each is an upper bound for every exactly deformed and every computed vertex
/// (evaluate.hpp), and in doubles limited ≤ eq12 ≤ convex. A transform that is not finite makes them all +∞, and so
/// does overflow those concerned. `method` is convex, corners, eq12 or limited; there is at least one simulation node.
/// The readable form of what kernel/ does fast.
void bound_box(const RestBv& bv, std::span<const AffineMap> maps, Method method, Rounding rounding,
               std::span<const Axis> axes, BoundScratch& scratch, std::span<double> supports);

} // namespace cinch
