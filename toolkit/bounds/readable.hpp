// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "cinch/bvh.hpp"

namespace cinch {

/// A kind that `best` chooses among as its formula, in doubles as they come: what the kernels do fast, in other orders,
/// over data that is rounded outward, and with their errors on top. Gives 2·axes.size() supports, place 2a along axis a
/// and 2a + 1 against it. `x` are the rest vertices. Maps are finite; there is at least one simulation node. `start`: λ
/// lies at mean b + start·(greatest b − mean b), the mean weighted by r = h − l (the greatest b where every r is 0).
/// Throws std::invalid_argument for a method without such a formula; bound_box has those over the boxes of BVs.
void readable_bound(Method kind, const RestBv& bv, std::span<const Vec3> x, std::span<const AffineMap> maps,
                    double start, std::span<const Axis> axes, std::span<double> supports);

} // namespace cinch
