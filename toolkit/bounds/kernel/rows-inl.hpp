// SPDX-License-Identifier: Apache-2.0
// No #pragma once: compiled anew for every target.
#if defined(CINCH_ROWS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CINCH_ROWS_INL
#undef CINCH_ROWS_INL
#else
#define CINCH_ROWS_INL
#endif

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

#include <hwy/highway.h>

#include "toolkit/bounds/kernel/extrema-inl.hpp"
#include "toolkit/bounds/kernel/next-inl.hpp"
#include "toolkit/bounds/packed_bv.hpp"
#include "toolkit/bounds/projected_maps.hpp"
#include "toolkit/deform/kernel/simd-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {

/// 4 rows of 4 values of T: of a projected map the rows q₀ q₁ q₂ θ of four axes. For BVs of few simulation nodes, which
/// it takes as they stand.
template <class T> using Rows = Simd<T, 16>;

/// The same four values in every row.
template <class T> HWY_INLINE Rows<T> each_row(const T* p) { return Rows<T>::fours(p); }
/// The a-th of four values all over row a.
template <class T> HWY_INLINE Rows<T> each_column(const T* p)
{
    using D = typename Rows<T>::D;
    [[maybe_unused]] constexpr std::size_t width = Rows<T>::width, vectors = Rows<T>::vectors;
    Rows<T> x;
#if HWY_TARGET != HWY_SCALAR
    if constexpr (width == 16) {
        HWY_ALIGN constexpr std::int32_t column[16] = {0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};
        x.v[0] = hn::TableLookupLanes(hn::LoadDup128(D(), p), hn::SetTableIndices(D(), column));
        return x;
    } else if constexpr (width == 8) {
        const hn::Half<D> half;
        for (std::size_t i = 0; i < vectors; ++i)
            x.v[i] = hn::Combine(D(), hn::Set(half, p[2 * i + 1]), hn::Set(half, p[2 * i]));
        return x;
    }
#endif
    for (std::size_t i = 0; i < vectors; ++i) // no vector has more than a row
        x.v[i] = hn::Set(D(), p[i * width / 4]);
    return x;
}
/// x, with the fourth lane of every row from y.
template <class T> HWY_INLINE Rows<T> with_fourth(const Rows<T>& x, const Rows<T>& y)
{
    HWY_ALIGN static constexpr T fourth[4] = {0, 0, 0, 1};
    const auto where = each_row<T>(fourth);
    Rows<T> out;
    for (std::size_t i = 0; i < Rows<T>::vectors; ++i)
        out.v[i] = hn::IfThenElse(hn::Gt(where.v[i], hn::Zero(typename Rows<T>::D())), y.v[i], x.v[i]);
    return out;
}

/// In every lane the sum of its row, (0 + 1) + (2 + 3).
template <class T> HWY_INLINE Rows<T> row_sum(const Rows<T>& x)
{
#if HWY_TARGET != HWY_SCALAR
    if constexpr (sizeof(T) == 4) {
        const auto pairs = each(x, [](auto v) { return hn::Add(v, hn::Shuffle2301(v)); });
        return each(pairs, [](auto v) { return hn::Add(v, hn::Shuffle1032(v)); });
    } else if constexpr (Rows<T>::width >= 4) {
        const auto pairs = each(x, [](auto v) { return hn::Add(v, hn::Shuffle01(v)); });
        return each(pairs, [](auto v) { return hn::Add(v, hn::SwapAdjacentBlocks(v)); });
    }
#endif
    HWY_ALIGN T lane[16];
    x.store(lane);
    for (std::size_t a = 0; a < 16; a += 4) {
        const T sum = (lane[a] + lane[a + 1]) + (lane[a + 2] + lane[a + 3]);
        for (std::size_t s = 0; s < 4; ++s)
            lane[a + s] = sum;
    }
    return Rows<T>::load(lane);
}

/// Even and odd lanes change places, two by two.
template <class T> HWY_INLINE Rows<T> exchange_sides(const Rows<T>& x)
{
#if HWY_TARGET != HWY_SCALAR
    if constexpr (sizeof(T) == 4)
        return each(x, [](auto v) { return hn::Shuffle2301(v); });
    else if constexpr (Rows<T>::width >= 4)
        return each(x, [](auto v) { return hn::Shuffle01(v); });
#endif
    HWY_ALIGN T lane[16];
    x.store(lane);
    for (std::size_t i = 0; i < 16; i += 2)
        std::swap(lane[i], lane[i + 1]);
    return Rows<T>::load(lane);
}

/// In the even lanes of every row its sum in x, in the odd ones that in y, (0 + 1) + (2 + 3).
template <class T> HWY_INLINE Rows<T> row_sums(const Rows<T>& x, const Rows<T>& y)
{
#if HWY_TARGET != HWY_SCALAR
    if constexpr (sizeof(T) == 4 || Rows<T>::width >= 4) {
        const auto pairs =
            each(x + exchange_sides(x), y + exchange_sides(y), [](auto a, auto b) { return hn::OddEven(b, a); });
        if constexpr (sizeof(T) == 4)
            return each(pairs, [](auto v) { return hn::Add(v, hn::Shuffle1032(v)); });
        else
            return each(pairs, [](auto v) { return hn::Add(v, hn::SwapAdjacentBlocks(v)); });
    }
#endif
    HWY_ALIGN T in[2][16], out[16];
    x.store(in[0]);
    y.store(in[1]);
    for (std::size_t i = 0; i < 16; ++i) {
        const T* row = in[i % 2] + i / 4 * 4;
        out[i] = (row[0] + row[1]) + (row[2] + row[3]);
    }
    return Rows<T>::load(out);
}

#if HWY_TARGET != HWY_SCALAR
template <class T> inline constexpr bool whole_in_one = Rows<T>::width == 16;
#else
template <class T> inline constexpr bool whole_in_one = false;
#endif

/// Column s of x as every row: what belongs to the axis of row a comes to lane a.
template <std::size_t s, class T> HWY_INLINE Rows<T> column(const Rows<T>& x)
{
    if constexpr (whole_in_one<T>) {
        HWY_ALIGN constexpr std::int32_t from[16] = {s, 4 + s, 8 + s, 12 + s, s, 4 + s, 8 + s, 12 + s,
                                                     s, 4 + s, 8 + s, 12 + s, s, 4 + s, 8 + s, 12 + s};
        return {{hn::TableLookupLanes(x.v[0], hn::SetTableIndices(typename Rows<T>::D(), from))}};
    }
#if HWY_TARGET != HWY_SCALAR
    // Interleaved, rows 0 and 2 stand alternately in one half of a vector, 1 and 3 in the other.
    [[maybe_unused]] const typename Rows<T>::D d;
    [[maybe_unused]] auto interleaved = [&](auto a, auto b) HWY_ATTR {
        constexpr bool upper = sizeof(T) == 4 ? s >= 2 : s % 2 == 1;
        if constexpr (upper)
            return hn::InterleaveUpper(d, a, b);
        else
            return hn::InterleaveLower(d, a, b);
    };
    if constexpr (Rows<T>::width == 8) {
        using Index = std::conditional_t<sizeof(T) == 4, std::int32_t, std::int64_t>;
        constexpr Index o = sizeof(T) == 4 ? s % 2 * 2 : s / 2 * 2;
        HWY_ALIGN constexpr Index from[8] = {o, o + 4, o + 1, o + 5, o, o + 4, o + 1, o + 5};
        const auto row = hn::TableLookupLanes(interleaved(x.v[0], x.v[1]), hn::SetTableIndices(d, from));
        return {{row, row}};
    } else if constexpr (sizeof(T) == 8 && Rows<T>::width == 4) {
        const auto low = interleaved(x.v[0], x.v[1]), high = interleaved(x.v[2], x.v[3]);
        const auto row = s < 2 ? hn::ConcatLowerLower(d, high, low) : hn::ConcatUpperUpper(d, high, low);
        return {{row, row, row, row}};
    }
#endif
    HWY_ALIGN T lane[16], out[16];
    x.store(lane);
    for (std::size_t i = 0; i < 16; ++i)
        out[i] = lane[4 * (i % 4) + s];
    return Rows<T>::load(out);
}

/// The greatest of each column, in all its lanes.
template <class T> HWY_INLINE Rows<T> column_greatest(const Rows<T>& x)
{
    if constexpr (whole_in_one<T>) {
        HWY_ALIGN constexpr std::int32_t by_8[16] = {8, 9, 10, 11, 12, 13, 14, 15, 0, 1, 2, 3, 4, 5, 6, 7},
                                         by_4[16] = {4, 5, 6, 7, 0, 1, 2, 3, 12, 13, 14, 15, 8, 9, 10, 11};
        const typename Rows<T>::D d;
        const auto half = hn::Max(x.v[0], hn::TableLookupLanes(x.v[0], hn::SetTableIndices(d, by_8)));
        return {{hn::Max(half, hn::TableLookupLanes(half, hn::SetTableIndices(d, by_4)))}};
    }
#if HWY_TARGET != HWY_SCALAR
    if constexpr (Rows<T>::width == 8) {
        const auto pairs = hn::Max(x.v[0], x.v[1]),
                   row = hn::Max(pairs, hn::ConcatLowerUpper(typename Rows<T>::D(), pairs, pairs));
        return {{row, row}};
    } else if constexpr (Rows<T>::width == 4) {
        const auto row = hn::Max(hn::Max(x.v[0], x.v[1]), hn::Max(x.v[2], x.v[3]));
        return {{row, row, row, row}};
    }
#endif
    HWY_ALIGN T lane[16];
    x.store(lane);
    for (std::size_t s = 0; s < 4; ++s) {
        const T a = lane[s] > lane[4 + s] ? lane[s] : lane[4 + s],
                b = lane[8 + s] > lane[12 + s] ? lane[8 + s] : lane[12 + s];
        for (std::size_t row = 0; row < 4; ++row)
            lane[4 * row + s] = a > b ? a : b;
    }
    return Rows<T>::load(lane);
}

/// The next one up, where results are to be proven.
template <class T> HWY_INLINE Rows<T> up(const Rows<T>& x, Rounding rounding)
{
    return rounding == Rounding::proven ? next(x) : x;
}

/// 4 rows of a node's projected map, from axis 4·chunk on; rows past the last axis are there but mean nothing.
template <class T, std::size_t kAxes> HWY_INLINE const T* map_of(const ProjectedMaps<T>& maps, std::uint32_t node)
{
    return maps.value.data() + std::size_t{node} * (4 * projected_rows(kAxes));
}
template <std::size_t kAxes> inline constexpr std::size_t row_chunks = (kAxes + 3) / 4;

/// A map along every axis: q in places 0 to 2, θ in place 3.
template <class T, std::size_t kAxes> struct AxisMap {
    Rows<T> chunk[row_chunks<kAxes>];
};

/// A value per side and axis: in lane a of every row that of the chunk's axis a.
template <class T, std::size_t kAxes> struct Sides {
    Rows<T> chunk[2][row_chunks<kAxes>];
};

/// Σ_j m_j (q_j, θ_j), nodes alternately in two sums; m in place `mean` of each node's `stride` values. And the nodes'
/// greatest error.
template <class T, std::size_t kAxes>
HWY_INLINE void mean_map(const PackedBv<T>& bv, const ProjectedMaps<T>& maps, const std::uint32_t* node, const T* value,
                         std::size_t stride, std::size_t mean, AxisMap<T, kAxes>& out, T& error)
{
    error = 0;
    for (std::size_t j = 0; j < bv.count; ++j)
        error = std::max(error, map_of<T, kAxes>(maps, node[j])[4 * projected_rows(kAxes) - 1]);
    for (std::size_t c = 0; c < row_chunks<kAxes>; ++c) {
        auto even = Rows<T>::all(0), odd = even;
        auto add = [&](std::size_t j, Rows<T>& sum) HWY_ATTR {
            sum = fma(Rows<T>::all(value[j * stride + mean]), Rows<T>::load(map_of<T, kAxes>(maps, node[j]) + 16 * c),
                      sum);
        };
        std::size_t j = 0;
        for (; j + 1 < bv.count; j += 2) {
            add(j, even);
            add(j + 1, odd);
        }
        if (j < bv.count)
            add(j, even);
        out.chunk[c] = even + odd;
    }
}

/// Adds to `value` max q·(x − pivot) over the rest vertices x, q of `direction`, and q̄·pivot + θ̄ of `base`: the points'
/// greatest q·y + slack·‖q‖, or what the rest box reaches, where that is less. For one chunk of axes. Where q is not
/// finite, neither is slack·‖q‖, and where it is, no product overflows (rounding.hpp): no point is passed over as NaN
/// or −∞.
template <class T> HWY_INLINE void add_rest_support(const PackedBv<T>& bv, const T* point, const Rows<T>& base,
                                                    const Rows<T>& direction, Rounding rounding, Rows<T>& along,
                                                    Rows<T>& against)
{
    const auto position = column<0>(row_sum(base * each_row<T>(bv.pivot)));
    // Four points at a time, one in a row, with the axes in its lanes.
    const auto q0 = column<0>(direction), q1 = column<1>(direction), q2 = column<2>(direction), zero = Rows<T>::all(0);
    auto most = Rows<T>::all(-infinity_of<T>), most_against = most;
    for (std::size_t i = 0; i < quads_of(bv.points); ++i) {
        const T* y = point + 12 * i;
        const auto reached = fma(q0, each_column<T>(y), fma(q1, each_column<T>(y + 4), q2 * each_column<T>(y + 8)));
        most = greater(reached, most);
        most_against = greater(zero - reached, most_against);
    }
    // ‖q‖, or |q|₁ where squares may vanish or overflow.
    const auto size0 = magnitude(q0), size1 = magnitude(q1), size2 = magnitude(q2),
               most_q = greater(greater(size0, size1), size2);
    const auto root = each((q0 * q0 + q1 * q1) + q2 * q2, [](auto x) { return hn::Sqrt(x); }),
               sum = (size0 + size1) + size2;
    Rows<T> norm;
    const typename Rows<T>::D d;
    for (std::size_t i = 0; i < Rows<T>::vectors; ++i) {
        const auto safe = hn::And(hn::Gt(most_q.v[i], hn::Set(d, static_cast<T>(0x1p-40))),
                                  hn::Lt(most_q.v[i], hn::Set(d, static_cast<T>(0x1p40))));
        norm.v[i] = hn::IfThenElse(safe, root.v[i], sum.v[i]);
    }
    const auto slack = norm * Rows<T>::all(bv.slack);
    auto all = [&](int s) HWY_ATTR { return Rows<T>::all(bv.centre[s] - bv.pivot[s]); };
    const auto middle = fma(q0, all(0), fma(q1, all(1), q2 * all(2)));
    const auto radius =
        fma(size0, Rows<T>::all(bv.half[0]), fma(size1, Rows<T>::all(bv.half[1]), size2 * Rows<T>::all(bv.half[2])));
    const auto reach = lesser(radius + middle, up(column_greatest(most) + slack, rounding));
    const auto reach_against = lesser(radius - middle, up(column_greatest(most_against) + slack, rounding));
    along = up(along + up(reach + position, rounding), rounding);
    against = up(against + up(reach_against - position, rounding), rounding);
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
