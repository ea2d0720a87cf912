// SPDX-License-Identifier: Apache-2.0
// No #pragma once: compiled anew for every target.
// Keeps a bound from exceeding Eq. 12 by more than 1 % of its width, without computing Eq. 12 where that is certain.
// Eq. 12 is D of the extrema b_j of the BV's own box, so at least Σ w_j b_j for every w in W′, and what a *floor* is:
// any lower bound on it. A bound no further above its floors than a share of their distance is not clearly looser than
// Eq. 12; others are intersected with it. Floors carry rounding errors of at most 24u N (rounding.hpp), as Eq. 12 does
// below its real value, and the errors of the nodes, of 48u N or more, which Eq. 12 has on top, make up for both.
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

/// Along and against every axis what a map reaches over the BV's box: for a map q, θ of every axis q·c + θ ± |q|·e.
template <class T> struct BoxReach {
    Rows<T> centre, half;

    HWY_INLINE explicit BoxReach(const PackedBv<T>& bv)
        : centre(Rows<T>::each_row(bv.centre)), half(Rows<T>::each_row(bv.half))
    {
    }
    HWY_INLINE Rows<T> operator()(const Rows<T>& map) const
    {
        const auto position = map * centre, radius = magnitude(map) * half;
        return row_sums(radius + position, radius - position);
    }
};

/// The mean map's reach: w = the means, |q̄| ≤ Σ m|q|.
template <class T, std::size_t kAxes>
HWY_INLINE void floor_of_mean(const PackedBv<T>& bv, const AxisMap<T, kAxes>& mean, Sides<T, kAxes>& floor)
{
    const BoxReach<T> over_box(bv);
    for (std::size_t c = 0; c < row_chunks<kAxes>; ++c) {
        const auto reach = over_box(mean.chunk[c]);
        floor.chunk[0][c] = column<0>(reach);
        floor.chunk[1][c] = column<1>(reach);
    }
}

/// The second-greatest extremum over the BV's box among its probes: Eq. 12 is at least that of all nodes where every l
/// is 0.
template <class T, std::size_t kAxes> HWY_INLINE void
floor_of_probes(const PackedBv<T>& bv, const ProjectedMaps<T>& maps, const std::uint32_t* node, Sides<T, kAxes>& floor)
{
    const std::uint32_t* const probe = node + blocks_of(bv.count) * block_lanes;
    const BoxReach<T> over_box(bv);
    for (std::size_t c = 0; c < row_chunks<kAxes>; ++c) {
        auto first = Rows<T>::all(-infinity_of<T>), second = first;
        for (std::size_t n = 0; n < guard_probes; ++n) {
            const auto reach = over_box(Rows<T>::load(map_of<T, kAxes>(maps, probe[n]) + 16 * c));
            second = greater(second, lesser(first, reach));
            first = greater(first, reach);
        }
        floor.chunk[0][c] = column<0>(second);
        floor.chunk[1][c] = column<1>(second);
    }
}

/// Whether a bound, the errors of its nodes included, lies close enough above its floors; false where one of them is no
/// number.
template <class T> bool close_to(double bound, T floor, T opposite_floor)
{
    const double low = static_cast<double>(floor), width = low + static_cast<double>(opposite_floor);
    return bound <= low + clearly_looser * (width > 0 ? width : 0);
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
