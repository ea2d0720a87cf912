// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <vector>

#include "cinch/bvh.hpp"

namespace cinch::exact {

/// A k-DOP as the polytope { x : axis·x ≤ support } of its k half-spaces, in exact arithmetic.
struct Polytope {
    std::string volume = "0/1"; ///< exact, "p/q" in lowest terms; 0 for flat or empty sets
    double approximate_volume = 0;
    std::size_t vertices = 0; ///< distinct; 0 for flat or empty sets
    std::vector<int>
        redundant; ///< places (as in axes_of) of half-spaces without a facet; not determined for flat or empty sets
};

/// Of double supports, as refit() gives them; all finite. Both throw std::length_error for one over 2^1000.
Polytope polytope(int kdop, std::span<const double> supports);

/// The true k-DOP of one BV: exact supports of its exactly deformed vertices.
Polytope true_polytope(const DeformableSurface& surface, const Bvh& bvh, std::size_t bv,
                       std::span<const AffineMap> maps, int kdop);

} // namespace cinch::exact
