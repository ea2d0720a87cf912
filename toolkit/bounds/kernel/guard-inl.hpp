// SPDX-License-Identifier: Apache-2.0
// No #pragma once: compiled anew for every target.
// Keeps a bound from exceeding Eq. 12 by more than 1 % of its width, without computing Eq. 12 where that is certain.
// Eq. 12 is D of the extrema c_j of the BV's own box, so at least Σ w_j c_j for every w in W′ and, where every l is 0,
// at least the second-greatest c_j: *floors*. A bound no further above its floor than a share of their distance is not
// clearly looser than Eq. 12; else
//  - the kinds for few are intersected with Eq. 12;
//  - local takes D at its own second-greatest b_j too, which is never above Eq. 12: b_j ≤ c_j for every j, so if b and
//  c
//    are greatest at the same node m, with λ the second-greatest, (1 − Σ l − r_m) λ + r_m b_m + Σ l_j b_j is at most
//    the same of c, 1 − Σ l − r_m being the room that the others leave (at least 0); and if not, every b_j is at most
//    the second-greatest c, and D at most that of b_j in its place.
// Floors carry rounding errors of at most 24u N (rounding.hpp), as Eq. 12 does below its real value, and the errors of
// the nodes, of 48u N or more, which Eq. 12 has on top, make up for both.
#if defined(CINCH_GUARD_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CINCH_GUARD_INL
#undef CINCH_GUARD_INL
#else
#define CINCH_GUARD_INL
#endif

#include <algorithm>

#include "toolkit/bounds/kernel/lanes-inl.hpp"
#include "toolkit/bounds/kernel/rows-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {

/// Half of what is promised: λ is sought with sums that are rounded.
inline constexpr double clearly_looser = 0.005;

/// The mean map's reach over the BV's box along and against every axis, q̄·c + θ̄ ± |q̄|·e: w = the means, |q̄| ≤ Σ m|q|.
template <class T, std::size_t kAxes>
HWY_INLINE void floor_of_mean(const PackedBv<T>& bv, const AxisMap<T, kAxes>& mean, Sides<T, kAxes>& floor)
{
    const auto centre = each_row<T>(bv.centre), half = each_row<T>(bv.half);
    for (std::size_t c = 0; c < row_chunks<kAxes>; ++c) {
        const auto position = mean.chunk[c] * centre, radius = magnitude(mean.chunk[c]) * half;
        const auto reach = row_sums(radius + position, radius - position);
        floor.chunk[0][c] = column<0>(reach);
        floor.chunk[1][c] = column<1>(reach);
    }
}

/// What the simulation nodes in a lane of all blocks reach at least over the BV's box, along and against every axis.
template <class T, std::size_t kAxes> struct LaneFloors {
    Lanes<T> side[2][kAxes];

    /// The greatest c_j of the first blocks that are full: two nodes of many, far apart, mostly reach far enough.
    LaneFloors(const PackedBv<T>& bv, const ProjectedMaps<T>& maps, const std::uint32_t* node)
    {
        for (auto& all : side)
            std::fill_n(all, kAxes, Lanes<T>::all(-infinity_of<T>));
        Lanes<T> c[3], e[3];
        for (std::size_t s = 0; s < 3; ++s) {
            c[s] = Lanes<T>::all(bv.centre[s]);
            e[s] = Lanes<T>::all(bv.half[s]);
        }
        for (std::size_t i = 0; i < std::min<std::size_t>(bv.count / block_lanes, 2); ++i, node += block_lanes)
            with_maps<kAxes>(maps, node, [&](const auto& map) CINCH_FLATTEN {
#pragma GCC unroll 3
                for (std::size_t a = 0; a < kAxes; ++a) {
                    Lanes<T> q[4];
                    map.rows(4 * a, q);
                    const auto p = fma(q[0], c[0], fma(q[1], c[1], fma(q[2], c[2], q[3])));
                    const auto w = fma(magnitude(q[0]), e[0], fma(magnitude(q[1]), e[1], magnitude(q[2]) * e[2]));
                    side[0][a] = greater(w + p, side[0][a]);
                    side[1][a] = greater(w - p, side[1][a]);
                }
            });
    }
    /// By the greatest of all blocks whose lanes are different nodes: b_j ≤ c_j.
    HWY_INLINE void raise(const Lanes<T> (&greatest)[2][kAxes])
    {
        for (std::size_t s = 0; s < 2; ++s)
            for (std::size_t a = 0; a < kAxes; ++a)
                side[s][a] = greater(greatest[s][a], side[s][a]);
    }
    /// The second-greatest lane.
    HWY_INLINE void second(PerSide<T, kAxes>& out) const
    {
        T lane[2][kAxes][block_lanes];
        for (std::size_t s = 0; s < 2; ++s)
            for (std::size_t a = 0; a < kAxes; ++a)
                side[s][a].store(lane[s][a]);
        for (std::size_t i = 0; i < 2 * out.room; i += block_lanes) {
            const T* record[block_lanes];
            for (std::size_t n = 0; n < block_lanes; ++n)
                record[n] = lane[(i + n) / out.room][std::min((i + n) % out.room, kAxes - 1)];
            Lanes<T> row[block_lanes];
            transpose(record, 0, row);
            transpose(record, block_lanes / 2, row + block_lanes / 2);
            auto most = greater(row[0], row[1]), next = less(row[0], row[1]);
            for (std::size_t n = 2; n < block_lanes; ++n) {
                next = greater(less(row[n], most), next);
                most = greater(row[n], most);
            }
            next.store(out.value + i);
        }
    }
};

/// The second-greatest b_j of each side and axis; of one node its own.
template <class T, std::size_t kAxes> void second_greatest(const PackedBv<T>& bv, const T* b, PerSide<T, kAxes>& out)
{
    TwoGreatest<T, kAxes> two;
    const std::size_t blocks = blocks_of(bv.count);
    const auto repeated = repeated_lanes(bv);
    for (std::size_t i = 0; i < blocks; ++i)
        for (std::size_t a = 0; a < kAxes; ++a)
            for (std::size_t s = 0; s < 2; ++s, b += block_lanes) {
                const auto own = Lanes<T>::load(b);
                two.take(s, a, i + 1 < blocks ? own : own + repeated);
            }
    two.second(bv.count, out);
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
