// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>

#include "cinch/bounds.hpp"
#include "cinch/bvh.hpp"

namespace cinch::exact {

/// One finite bound of one BV: direction as in axes_of(kdop), 2a along axis a, 2a + 1 against it.
struct OneBound {
    const DeformableSurface& surface;
    const Bvh& bvh;
    std::span<const AffineMap> maps;
    Methods methods;
    int kdop;
    std::size_t bv;
    int direction;
    double bound;
};

/// What the bound gives away, and why, as exact fractions that add up to `total` = bound − true support, along the axis
/// as it is (not scaled to unit length). For methods other than the box_methods all of it counts as rounding.
struct ExactLoss {
    std::string box;      ///< true support → rest boxes deformed with the vertices' actual weights
    std::string interval; ///< actual weights → the maximum over W'
    std::string corner;   ///< maximum over W' → the method's formula in exact arithmetic
    std::string rounding; ///< the formula → the double
    std::string total;
};
ExactLoss exact_loss(const OneBound& place);

/// The bound as a linear program with its proof, in the VIPR 1.0 format of `viprchk`: maximise Σ w_j b_j over W', at
/// most `bound`, derived as one combination of Σ w = 1 with multiplier λ and of the weight intervals. For the
/// box_methods.
std::string vipr(const OneBound& place);

} // namespace cinch::exact
