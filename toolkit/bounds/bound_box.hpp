// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "toolkit/bounds/directions.hpp"
#include "toolkit/bounds/method.hpp"
#include "toolkit/bounds/weight_space.hpp"
#include "toolkit/surface/skin.hpp"

namespace cinch {

/// What one BV knows of its vertices in rest state. A view; owns nothing.
struct RestBv {
    Vec3 centre, half;                     ///< the real box centre ± half contains every rest vertex
    std::span<const std::uint32_t> node;   ///< simulation nodes that influence it
    WeightSpace space;                     ///< parallel to `node`
    std::uint32_t vertex_influences = 0;   ///< most simulation nodes of any one of its vertices
};

/// Reused from call to call, so that bounding allocates nothing once warm.
struct BoundScratch {
    std::vector<double> plus, minus; // extrema b̂_j along the axis and against it
    std::vector<std::pair<double, double>> select;
};

/// The paper's k-DOP refit (§5.4) in O(n): 2·axes.size() supports of the deformed BV, place 2a along axis a and 2a + 1 against
/// it. With Rounding::proven each is an upper bound for every exactly deformed and every computed vertex (evaluate.hpp), and
/// in doubles limited ≤ eq12 ≤ convex. Anything that is not finite gives +∞. `method` is not `vertices`; there is at least one node.
void bound_box(const RestBv& bv, std::span<const AffineMap> maps, Method method, Rounding rounding, std::span<const Axis> axes,
               BoundScratch& scratch, std::span<double> supports);

} // namespace cinch
