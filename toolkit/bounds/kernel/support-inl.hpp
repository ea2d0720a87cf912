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

// Values of a node of the support kind: centre (3), 1, half (3), 0, l, r, mean.
inline constexpr std::size_t support_l = 8, support_r = 9, support_mean = 10;

/// What one pass over the extrema leaves, each axis all over its row.
template <class T, std::size_t kAxes> struct RowExtrema {
    Rows<T> greatest[2][row_chunks<kAxes>], mean[2][row_chunks<kAxes>];
};
template <class T, std::size_t kAxes> struct RowDual {
    Rows<T> lower[2][row_chunks<kAxes>], upper[2][row_chunks<kAxes>], mass[2][row_chunks<kAxes>];
};

/// b̂_j of every simulation node, with the reference map taken off, along and against the axes, into b: per chunk and node 16 along, then 16
/// against, each axis all over its row. b̂± = Σ_s (|dq_s| e_s ± dq_s c_s), so b̂₊ ≥ −b̂₋ whatever is rounded.
template <class T, std::size_t kAxes>
HWY_INLINE void support_extrema(const PackedBv<T>& bv, const ProjectedMaps<T>& maps, const std::uint32_t* node, const T* value, const AxisMap<T, kAxes>& reference, T* b,
                                RowExtrema<T, kAxes>& out)
{
    constexpr std::size_t stride = PackedBv<T>::values(Method::support);
    for (std::size_t c = 0; c < row_chunks<kAxes>; ++c) {
        Rows<T> most[2] = {Rows<T>::all(-infinity_of<T>), Rows<T>::all(-infinity_of<T>)}, mean[2] = {Rows<T>::all(0), Rows<T>::all(0)};
        for (std::size_t j = 0; j < bv.count; ++j, b += 32) {
            const auto d = Rows<T>::load(map_of<T, kAxes>(maps, node[j]) + 16 * c) - reference.chunk[c];
            const auto position = d * Rows<T>::each_row(value + j * stride), radius = magnitude(d) * Rows<T>::each_row(value + j * stride + 4);
            const Rows<T> side[2] = {row_sum(radius + position), row_sum(radius - position)};
            const auto r = Rows<T>::all(value[j * stride + support_r]);
            for (std::size_t s = 0; s < 2; ++s) {
                side[s].store(b + 16 * s);
                most[s] = greater(side[s], most[s]);
                mean[s] = fma(r, side[s], mean[s]);
            }
        }
        for (std::size_t s = 0; s < 2; ++s) {
            out.greatest[s][c] = most[s];
            out.mean[s][c] = bv.sum_r > 0 ? mean[s] * Rows<T>::all(1 / bv.sum_r) : most[s];
        }
    }
}

/// D(λ) in parts; with kMass, Σ r over b > λ too. Nodes alternately in two sums.
template <class T, std::size_t kAxes, bool kMass>
HWY_INLINE void support_dual(const PackedBv<T>& bv, const T* value, const T* b, const Rows<T> (&lambda)[2][row_chunks<kAxes>], RowDual<T, kAxes>& out)
{
    constexpr std::size_t stride = PackedBv<T>::values(Method::support);
    const auto zero = Rows<T>::all(0);
    for (std::size_t c = 0; c < row_chunks<kAxes>; ++c) {
        Rows<T> lower[2][2], upper[2][2], mass[2][2]; // [side][sum]
        for (std::size_t s = 0; s < 2; ++s)
            for (std::size_t to = 0; to < 2; ++to)
                lower[s][to] = upper[s][to] = mass[s][to] = zero;
        auto add = [&](std::size_t j, std::size_t to) HWY_ATTR {
            const auto l = Rows<T>::all(value[j * stride + support_l]), r = Rows<T>::all(value[j * stride + support_r]);
            for (std::size_t s = 0; s < 2; ++s) {
                const auto above = Rows<T>::load(b + 32 * j + 16 * s) - lambda[s][c];
                lower[s][to] = fma(l, above, lower[s][to]);
                upper[s][to] = fma(r, greater(above, zero), upper[s][to]);
                if constexpr (kMass)
                    mass[s][to] = mass[s][to] + where_positive(above, r);
            }
        };
        std::size_t j = 0;
        for (; j + 1 < bv.count; j += 2) {
            add(j, 0);
            add(j + 1, 1);
        }
        if (j < bv.count)
            add(j, 0);
        b += 32 * std::size_t{bv.count};
        for (std::size_t s = 0; s < 2; ++s) {
            out.lower[s][c] = lower[s][0] + lower[s][1];
            out.upper[s][c] = upper[s][0] + upper[s][1];
            if constexpr (kMass)
                out.mass[s][c] = mass[s][0] + mass[s][1];
        }
    }
}

/// Values per side and axis as an array, and back.
template <class T, std::size_t kAxes> HWY_INLINE void to_array(const Rows<T> (&rows)[2][row_chunks<kAxes>], T (&out)[2][kAxes])
{
    for (std::size_t s = 0; s < 2; ++s)
        for (std::size_t c = 0; c < row_chunks<kAxes>; ++c) {
            HWY_ALIGN T lane[16];
            rows[s][c].store(lane);
            for (std::size_t a = 4 * c; a < std::min(4 * c + 4, kAxes); ++a)
                out[s][a] = lane[4 * (a % 4)];
        }
}
template <class T, std::size_t kAxes> HWY_INLINE void from_array(const T (&in)[2][kAxes], Rows<T> (&rows)[2][row_chunks<kAxes>])
{
    for (std::size_t s = 0; s < 2; ++s)
        for (std::size_t c = 0; c < row_chunks<kAxes>; ++c) {
            HWY_ALIGN T own[4] = {0, 0, 0, 0};
            for (std::size_t a = 4 * c; a < std::min(4 * c + 4, kAxes); ++a)
                own[a % 4] = in[s][a];
            rows[s][c] = Rows<T>::each_column(own);
        }
}

/// The lesser of the greatest b and D(λ), λ at mean b + start·(greatest b − mean b): one pass, all in rows. See proven_dual_value.
template <class T, std::size_t kAxes>
HWY_INLINE void support_in_one_pass(const PackedBv<T>& bv, const T* value, const T* b, const RowExtrema<T, kAxes>& e, Rounding rounding, Sides<T, kAxes>& bound,
                                    Rows<T> (&lambda)[2][row_chunks<kAxes>])
{
    const auto factor = Rows<T>::all(dual_sum_factor<T>(row_depth(bv.count))), underflow = Rows<T>::all(dual_sum_underflow<T>(bv.count));
    for (std::size_t s = 0; s < 2; ++s)
        for (std::size_t c = 0; c < row_chunks<kAxes>; ++c)
            lambda[s][c] = e.mean[s][c] + Rows<T>::all(bv.start) * (e.greatest[s][c] - e.mean[s][c]);
    RowDual<T, kAxes> d;
    support_dual<T, kAxes, false>(bv, value, b, lambda, d);
    for (std::size_t s = 0; s < 2; ++s)
        for (std::size_t c = 0; c < row_chunks<kAxes>; ++c) {
            const auto at = lambda[s][c], most = e.greatest[s][c], both = d.lower[s][c] + d.upper[s][c];
            auto dual = at + both;
            if (rounding == Rounding::proven) {
                const auto width = greater(most - at, at + e.greatest[1 - s][c]);
                dual = next(at + next(both + next(factor * (width + d.upper[s][c]) + underflow)));
            }
            bound.chunk[s][c] = column<0>(lesser(dual, most));
            for (std::size_t i = 0; i < Rows<T>::vectors; ++i) // λ as it certifies: that of D, or the greatest b
                lambda[s][c].v[i] = hn::IfThenElse(hn::Lt(dual.v[i], most.v[i]), at.v[i], most.v[i]);
        }
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
