// SPDX-License-Identifier: Apache-2.0
// No #pragma once: compiled anew for every target.
#if defined(CINCH_SUPPORT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CINCH_SUPPORT_INL
#undef CINCH_SUPPORT_INL
#else
#define CINCH_SUPPORT_INL
#endif

#include "toolkit/bounds/kernel/extrema-inl.hpp"
#include "toolkit/bounds/kernel/rows-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {

// Values of a node of the support kind: centre (3), half (3), l, r, mean.
inline constexpr std::size_t support_half = 3, support_l = 6, support_r = 7, support_mean = 8;

/// Per axis along it in the even lanes of its row, against it in the odd ones.
template <class T, std::size_t kAxes> using SidesInRows = Rows<T>[row_chunks<kAxes>];

/// What one pass over the extrema leaves, and D(λ) in parts.
template <class T, std::size_t kAxes> struct RowExtrema {
    SidesInRows<T, kAxes> greatest, mean;
};
template <class T, std::size_t kAxes> struct RowDual {
    SidesInRows<T, kAxes> lower, upper, mass;
};

/// b̂_j of every simulation node, with the reference map taken off, along and against the axes, into b: per chunk and
/// node 16. b̂± = Σ_s (|dq_s| e_s ± dq_s c_s), so b̂₊ ≥ −b̂₋ whatever is rounded.
template <class T, std::size_t kAxes>
HWY_INLINE void support_extrema(const PackedBv<T>& bv, const ProjectedMaps<T>& maps, const std::uint32_t* node,
                                const T* value, const AxisMap<T, kAxes>& reference, T* b, RowExtrema<T, kAxes>& out)
{
    constexpr std::size_t stride = PackedBv<T>::values(Method::support);
    for (std::size_t c = 0; c < row_chunks<kAxes>; ++c) {
        const auto one = Rows<T>::all(1), zero = Rows<T>::all(0);
        auto most = Rows<T>::all(-infinity_of<T>), mean = zero;
        for (std::size_t j = 0; j < bv.count; ++j, b += 16) {
            const auto d = Rows<T>::load(map_of<T, kAxes>(maps, node[j]) + 16 * c) - reference.chunk[c];
            const auto position = d * with_fourth(each_row<T>(value + j * stride), one),
                       radius = magnitude(d) * with_fourth(each_row<T>(value + j * stride + support_half), zero);
            const auto sides = row_sums(radius + position, radius - position);
            sides.store(b);
            most = greater(sides, most);
            mean = fma(Rows<T>::all(value[j * stride + support_r]), sides, mean);
        }
        out.greatest[c] = most;
        out.mean[c] = bv.sum_r > 0 ? mean * Rows<T>::all(1 / bv.sum_r) : most;
    }
}

/// Where l and r of the simulation nodes stand.
template <class T> struct RowInterval {
    const T *l, *r;
    std::size_t stride;
};

/// D(λ) in parts; with kMass, Σ r over b > λ too. Nodes alternately in two sums.
template <class T, std::size_t kAxes, bool kMass>
HWY_INLINE void support_dual(const PackedBv<T>& bv, const RowInterval<T>& interval, const T* b,
                             const SidesInRows<T, kAxes>& lambda, RowDual<T, kAxes>& out)
{
    const auto zero = Rows<T>::all(0);
    for (std::size_t c = 0; c < row_chunks<kAxes>; ++c, b += 16 * std::size_t{bv.count}) {
        Rows<T> lower[2] = {zero, zero}, upper[2] = {zero, zero}, mass[2] = {zero, zero};
        auto add = [&](std::size_t j, std::size_t to) HWY_ATTR {
            const auto l = Rows<T>::all(interval.l[j * interval.stride]),
                       r = Rows<T>::all(interval.r[j * interval.stride]);
            const auto above = Rows<T>::load(b + 16 * j) - lambda[c];
            lower[to] = fma(l, above, lower[to]);
            upper[to] = fma(r, greater(above, zero), upper[to]);
            if constexpr (kMass)
                mass[to] = mass[to] + where_positive(above, r);
        };
        std::size_t j = 0;
        for (; j + 1 < bv.count; j += 2) {
            add(j, 0);
            add(j + 1, 1);
        }
        if (j < bv.count)
            add(j, 0);
        out.lower[c] = lower[0] + lower[1];
        out.upper[c] = upper[0] + upper[1];
        out.mass[c] = mass[0] + mass[1];
    }
}

/// Values per side and axis as an array, and back.
template <class T, std::size_t kAxes>
HWY_INLINE void to_array(const SidesInRows<T, kAxes>& rows, PerSide<T, kAxes>& out)
{
    for (std::size_t c = 0; c < row_chunks<kAxes>; ++c) {
        HWY_ALIGN T lane[16];
        rows[c].store(lane);
        for (std::size_t a = 4 * c; a < std::min(4 * c + 4, kAxes); ++a)
            for (std::size_t s = 0; s < 2; ++s)
                out[s][a] = lane[4 * (a % 4) + s];
    }
    out.repeat_last();
}
template <class T, std::size_t kAxes>
HWY_INLINE void from_array(const PerSide<T, kAxes>& in, SidesInRows<T, kAxes>& rows)
{
    for (std::size_t c = 0; c < row_chunks<kAxes>; ++c) {
        HWY_ALIGN T lane[16] = {};
        for (std::size_t a = 4 * c; a < std::min(4 * c + 4, kAxes); ++a)
            for (std::size_t s = 0; s < 4; ++s)
                lane[4 * (a % 4) + s] = in[s % 2][a];
        rows[c] = Rows<T>::load(lane);
    }
}

/// The lesser of the greatest b and D(λ), λ at mean b + start·(greatest b − mean b): one pass, all in rows. See
/// proven_dual_value.
template <class T, std::size_t kAxes>
HWY_INLINE void support_in_one_pass(const PackedBv<T>& bv, const RowInterval<T>& interval, const T* b,
                                    const RowExtrema<T, kAxes>& e, Rounding rounding, Sides<T, kAxes>& bound)
{
    const auto factor = Rows<T>::all(dual_sum_factor<T>(row_depth(bv.count))),
               underflow = Rows<T>::all(dual_sum_underflow<T>(bv.count));
    SidesInRows<T, kAxes> lambda;
    for (std::size_t c = 0; c < row_chunks<kAxes>; ++c)
        lambda[c] = e.mean[c] + Rows<T>::all(bv.start) * (e.greatest[c] - e.mean[c]);
    RowDual<T, kAxes> d;
    support_dual<T, kAxes, false>(bv, interval, b, lambda, d);
    for (std::size_t c = 0; c < row_chunks<kAxes>; ++c) {
        const auto at = lambda[c], most = e.greatest[c], both = d.lower[c] + d.upper[c];
        auto dual = at + both;
        if (rounding == Rounding::proven) {
            const auto width = greater(most - at, at + exchange_sides(most));
            dual = next(at + next(both + next(factor * (width + d.upper[c]) + underflow)));
        }
        const auto least = lesser(dual, most);
        bound.chunk[0][c] = column<0>(least);
        bound.chunk[1][c] = column<1>(least);
    }
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
