// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "toolkit/bounds/bound_moments.hpp"
#include "toolkit/bounds/packed_bv.hpp"
#include "toolkit/bounds/projected_maps.hpp"
#include "toolkit/deform/aligned.hpp"

namespace cinch {

/// Appends points, head and simulation nodes of a BV of the kind moments to `value`, and sets what else `bv` has of
/// them. `means` are in T and sum to 1. Where T does not hold the centre or a place, the bound will be infinite.
template <class T> void pack_moments(const RestBv& rest, const RestMoments& moments, std::span<const double> means,
                                     const RestExtent& extent, PackedBv<T>& bv, AlignedVector<T>& value);

} // namespace cinch
