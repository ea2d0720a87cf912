// SPDX-License-Identifier: Apache-2.0
// No #pragma once: compiled anew for every target.
// Keeps a bound from exceeding Eq. 12 by more than 1 % of its width, without computing Eq. 12 where that is certain. Eq. 12 is D of the
// extrema b_j of the BV's own box, so at least Σ w_j b_j for every w in W′, and what a *floor* is: any lower bound on it. A bound no
// further above its floors than a share of their distance is not clearly looser than Eq. 12; others are intersected with it.
// Floors carry rounding errors of at most 24u N (rounding.hpp), as Eq. 12 does below its real value, and the errors of the nodes, of 48u N
// or more, which Eq. 12 has on top, make up for both.
#if defined(CINCH_GUARD_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CINCH_GUARD_INL
#undef CINCH_GUARD_INL
#else
#define CINCH_GUARD_INL
#endif

#include "toolkit/bounds/kernel/rows-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {

/// Half of what is promised: λ is sought with sums that are rounded.
inline constexpr double clearly_looser = 0.005;

/// Along and against every axis what the map reaches over the BV's box: for a map q, θ of every axis q·c + θ ± |q|·e.
template <class T> HWY_INLINE Rows<T> box_reach(const PackedBv<T>& bv, const Rows<T>& map)
{
    HWY_ALIGN const T centre[4] = {bv.centre[0], bv.centre[1], bv.centre[2], 1}, half[4] = {bv.half[0], bv.half[1], bv.half[2], 0};
    const auto position = map * Rows<T>::each_row(centre), radius = magnitude(map) * Rows<T>::each_row(half);
    return row_sums(radius + position, radius - position);
}

/// The mean map's reach: w = the means, |q̄| ≤ Σ m|q|.
template <class T, std::size_t kAxes> HWY_INLINE void floor_of_mean(const PackedBv<T>& bv, const AxisMap<T, kAxes>& mean, Sides<T, kAxes>& floor)
{
    for (std::size_t c = 0; c < row_chunks<kAxes>; ++c) {
        const auto reach = box_reach(bv, mean.chunk[c]);
        floor.chunk[0][c] = column<0>(reach);
        floor.chunk[1][c] = column<1>(reach);
    }
}

/// Whether a bound, the errors of its nodes included, lies close enough above its floors; false where one of them is no number.
template <class T> bool close_to(double bound, T floor, T opposite_floor)
{
    const double low = static_cast<double>(floor), width = low + static_cast<double>(opposite_floor);
    return bound <= low + clearly_looser * (width > 0 ? width : 0);
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
