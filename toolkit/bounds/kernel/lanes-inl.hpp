// SPDX-License-Identifier: Apache-2.0
// No #pragma once: compiled anew for every target.
#if defined(CINCH_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CINCH_LANES_INL
#undef CINCH_LANES_INL
#else
#define CINCH_LANES_INL
#endif

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include <hwy/highway.h>

#include "toolkit/bounds/kernel/extrema-inl.hpp"
#include "toolkit/bounds/kernel/next-inl.hpp"
#include "toolkit/bounds/packed_bv.hpp"
#include "toolkit/bounds/projected_maps.hpp"
#include "toolkit/deform/kernel/simd-inl.hpp"

// On lambdas whose captures must stay in registers.
#ifndef CINCH_FLATTEN
#define CINCH_FLATTEN __attribute__((always_inline))
#endif

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {

/// 8 virtual lanes of T, in one vector where the target has one of that width. NaN occurs only where the error of a
/// simulation node is infinite, which decides the result.
template <class T> using Lanes = Simd<T, block_lanes>;

template <class D, class V, class F> HWY_INLINE hn::TFromD<D> fold_vector(D, V v, [[maybe_unused]] F&& f)
{
#if HWY_TARGET != HWY_SCALAR
    if constexpr (hn::MaxLanes(D()) > 1) {
        const hn::Half<D> half;
        return fold_vector(half, f(hn::LowerHalf(half, v), hn::UpperHalf(half, v)), f);
    }
#endif
    return hn::GetLane(v);
}

/// Halves upon each other until one value is left: lanes (0, 4), (1, 5), (2, 6), (3, 7), then (0, 2), (1, 3), then the
/// last two.
template <class T, class F> HWY_INLINE T fold(const Lanes<T>& a, F&& f)
{
    typename Lanes<T>::V v[Lanes<T>::vectors];
    for (std::size_t i = 0; i < Lanes<T>::vectors; ++i)
        v[i] = a.v[i];
    for (std::size_t half = Lanes<T>::vectors / 2; half > 0; half /= 2)
        for (std::size_t i = 0; i < half; ++i)
            v[i] = f(v[i], v[i + half]);
    return fold_vector(typename Lanes<T>::D(), v[0], f);
}
/// That of each of eight.
template <class T, class F> HWY_INLINE Lanes<T> fold(const Lanes<T> (&x)[block_lanes], F&& f)
{
#if HWY_TARGET != HWY_SCALAR
    using D = typename Lanes<T>::D;
    const D d;
    [[maybe_unused]] Lanes<T> out;
    if constexpr (sizeof(T) == 4 && Lanes<T>::width == 8) {
        const hn::Repartition<double, D> pairs;
        auto halves = [&](std::size_t a, std::size_t b) CINCH_FLATTEN {
            const auto v =
                f(hn::ConcatLowerLower(d, x[b].v[0], x[a].v[0]), hn::ConcatUpperUpper(d, x[b].v[0], x[a].v[0]));
            return hn::BitCast(pairs, v);
        };
        auto quarters = [&](std::size_t a, std::size_t b) CINCH_FLATTEN { // of x[a], x[b], x[a + 4], x[b + 4]
            const auto one = halves(a, a + 4), two = halves(b, b + 4);
            const auto v = f(hn::BitCast(d, hn::InterleaveLower(pairs, one, two)),
                             hn::BitCast(d, hn::InterleaveUpper(pairs, one, two)));
            return f(v, hn::Shuffle2301(v));
        };
        out.v[0] = hn::OddEven(quarters(1, 3), quarters(0, 2));
        return out;
    } else if constexpr (sizeof(T) == 8 && Lanes<T>::width == 8) {
        auto halves = [&](std::size_t a, std::size_t b) CINCH_FLATTEN {
            return f(hn::ConcatLowerLower(d, x[b].v[0], x[a].v[0]), hn::ConcatUpperUpper(d, x[b].v[0], x[a].v[0]));
        };
        auto quarters = [&](std::size_t i) CINCH_FLATTEN { // of x[i], x[i + 2], x[i + 4], x[i + 6], two lanes of each
            const auto one = halves(i, i + 4), two = halves(i + 2, i + 6);
            return f(hn::OddEvenBlocks(hn::SwapAdjacentBlocks(two), one),
                     hn::OddEvenBlocks(two, hn::SwapAdjacentBlocks(one)));
        };
        const auto even = quarters(0), odd = quarters(1);
        out.v[0] = f(hn::InterleaveLower(d, even, odd), hn::InterleaveUpper(d, even, odd));
        return out;
    } else if constexpr (sizeof(T) == 8 && Lanes<T>::width == 4) {
        auto quarters = [&](std::size_t a, std::size_t b) CINCH_FLATTEN {
            const auto one = f(x[a].v[0], x[a].v[1]), two = f(x[b].v[0], x[b].v[1]);
            const auto v = f(hn::ConcatLowerLower(d, two, one), hn::ConcatUpperUpper(d, two, one));
            return f(v, hn::Shuffle01(v));
        };
        for (std::size_t h = 0; h < 2; ++h)
            out.v[h] = hn::OddEven(quarters(4 * h + 1, 4 * h + 3), quarters(4 * h, 4 * h + 2));
        return out;
    }
#endif
    T value[block_lanes];
    for (std::size_t n = 0; n < block_lanes; ++n)
        value[n] = fold(x[n], f);
    return Lanes<T>::load(value);
}
/// ((0 + 4) + (2 + 6)) + ((1 + 5) + (3 + 7)).
template <class T> HWY_INLINE T sum(const Lanes<T>& a)
{
    return fold(a, [](auto x, auto y) { return hn::Add(x, y); });
}
template <class T> HWY_INLINE T greatest(const Lanes<T>& a)
{
    return fold(a, [](auto x, auto y) { return hn::Max(x, y); });
}

/// Lanes i to i + 7 of both sides, i < 2·room.
template <class T, std::size_t kAxes> HWY_INLINE Lanes<T> lanes_of(const PerSide<T, kAxes>& x, std::size_t i)
{
    return Lanes<T>::load(x.value + i);
}
/// The same lanes of the other side.
template <class T, std::size_t kAxes> HWY_INLINE Lanes<T> opposite_lanes(const PerSide<T, kAxes>& x, std::size_t i)
{
    constexpr std::size_t room = PerSide<T, kAxes>::room;
    if constexpr (room % block_lanes == 0) {
        return Lanes<T>::load(x.value + (i + room) % (2 * room));
    } else {
        const auto both = Lanes<T>::load(x.value + i);
        Lanes<T> out;
#if HWY_TARGET != HWY_SCALAR
        if constexpr (Lanes<T>::vectors == 1) {
            out.v[0] = hn::ConcatLowerUpper(typename Lanes<T>::D(), both.v[0], both.v[0]);
            return out;
        }
#endif
        for (std::size_t n = 0; n < Lanes<T>::vectors; ++n)
            out.v[n] = both.v[(n + Lanes<T>::vectors / 2) % Lanes<T>::vectors];
        return out;
    }
}
/// fold() of every side and axis.
template <class T, std::size_t kAxes, class F>
HWY_INLINE void fold(const Lanes<T> (&x)[2][kAxes], PerSide<T, kAxes>& out, F&& f)
{
    constexpr std::size_t room = PerSide<T, kAxes>::room;
    for (std::size_t i = 0; i < 2 * room; i += block_lanes) {
        Lanes<T> in[block_lanes];
        for (std::size_t n = 0; n < block_lanes; ++n)
            in[n] = x[(i + n) / room][std::min((i + n) % room, kAxes - 1)];
        fold(in, f).store(out.value + i);
    }
}
template <class T, std::size_t kAxes> HWY_INLINE void sum(const Lanes<T> (&x)[2][kAxes], PerSide<T, kAxes>& out)
{
    fold(x, out, [](auto a, auto b) { return hn::Add(a, b); });
}
template <class T, std::size_t kAxes> HWY_INLINE void greatest(const Lanes<T> (&x)[2][kAxes], PerSide<T, kAxes>& out)
{
    fold(x, out, [](auto a, auto b) { return hn::Max(a, b); });
}
/// The two greatest of each lane on the way, of each side and axis in the end.
template <class T, std::size_t kAxes> struct TwoGreatest {
    Lanes<T> first[2][kAxes], other[2][kAxes];

    HWY_INLINE TwoGreatest()
    {
        for (std::size_t s = 0; s < 2; ++s)
            for (std::size_t a = 0; a < kAxes; ++a)
                first[s][a] = other[s][a] = Lanes<T>::all(-infinity_of<T>);
    }
    HWY_INLINE void take(std::size_t s, std::size_t a, const Lanes<T>& x)
    {
        other[s][a] = greater(less(x, first[s][a]), other[s][a]);
        first[s][a] = greater(x, first[s][a]);
    }
    /// Of one value itself.
    void second(std::size_t count, PerSide<T, kAxes>& out) const
    {
        for (std::size_t s = 0; s < 2; ++s)
            for (std::size_t a = 0; a < kAxes; ++a) {
                T x[2 * block_lanes];
                first[s][a].store(x);
                other[s][a].store(x + block_lanes);
                T top = -infinity_of<T>, second = top;
                for (const T value : x) {
                    const T less = value < top ? value : top;
                    second = less > second ? less : second;
                    top = value > top ? value : top;
                }
                out[s][a] = count > 1 ? second : top;
            }
        out.repeat_last();
    }
};
/// 0, and −∞ where the last block repeats its last node.
template <class T> HWY_INLINE Lanes<T> repeated_lanes(const PackedBv<T>& bv)
{
    T repeats[block_lanes];
    for (std::size_t n = 0; n < block_lanes; ++n)
        repeats[n] = n < (bv.count - 1) % block_lanes + 1 ? T(0) : -infinity_of<T>;
    return Lanes<T>::load(repeats);
}
template <class T, std::size_t kAxes> HWY_INLINE void fill(PerSide<T, kAxes>& out, T value)
{
    for (std::size_t i = 0; i < 2 * out.room; i += block_lanes)
        Lanes<T>::all(value).store(out.value + i);
}

/// Turns 4 values each of 8 records into 4 × 8: row[s] has the s-th value of every record.
template <class T> HWY_INLINE void transpose(const T* const (&record)[block_lanes], std::size_t offset, Lanes<T>* row)
{
#if HWY_TARGET != HWY_SCALAR
    using D = typename Lanes<T>::D;
    if constexpr (sizeof(T) == 4 && Lanes<T>::width == 8) {
        const D d;
        const hn::Half<D> half;
        const hn::Repartition<double, D> pairs;
        hn::Vec<D> v[4];
        for (std::size_t i = 0; i < 4; ++i)
            v[i] = hn::Combine(d, hn::LoadU(half, record[i + 4] + offset), hn::LoadU(half, record[i] + offset));
        const auto a = hn::BitCast(pairs, hn::InterleaveLower(d, v[0], v[1])),
                   b = hn::BitCast(pairs, hn::InterleaveLower(d, v[2], v[3]));
        const auto e = hn::BitCast(pairs, hn::InterleaveUpper(d, v[0], v[1])),
                   f = hn::BitCast(pairs, hn::InterleaveUpper(d, v[2], v[3]));
        row[0].v[0] = hn::BitCast(d, hn::InterleaveLower(pairs, a, b));
        row[1].v[0] = hn::BitCast(d, hn::InterleaveUpper(pairs, a, b));
        row[2].v[0] = hn::BitCast(d, hn::InterleaveLower(pairs, e, f));
        row[3].v[0] = hn::BitCast(d, hn::InterleaveUpper(pairs, e, f));
    } else if constexpr (sizeof(T) == 8 && Lanes<T>::width == 8) {
        const D d;
        const hn::Half<D> half;
        hn::Vec<D> v[4];
        for (std::size_t i = 0; i < 4; ++i)
            v[i] = hn::Combine(d, hn::LoadU(half, record[i + 4] + offset), hn::LoadU(half, record[i] + offset));
        const auto a = hn::InterleaveLower(d, v[0], v[1]), b = hn::InterleaveLower(d, v[2], v[3]);
        const auto e = hn::InterleaveUpper(d, v[0], v[1]), f = hn::InterleaveUpper(d, v[2], v[3]);
        row[0].v[0] = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(b), a);
        row[1].v[0] = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(f), e);
        row[2].v[0] = hn::OddEvenBlocks(b, hn::SwapAdjacentBlocks(a));
        row[3].v[0] = hn::OddEvenBlocks(f, hn::SwapAdjacentBlocks(e));
    } else if constexpr (sizeof(T) == 8 && Lanes<T>::width == 4) {
        const D d;
        for (std::size_t h = 0; h < 2; ++h) {
            hn::Vec<D> v[4];
            for (std::size_t i = 0; i < 4; ++i)
                v[i] = hn::LoadU(d, record[4 * h + i] + offset);
            const auto a = hn::InterleaveLower(d, v[0], v[1]), b = hn::InterleaveLower(d, v[2], v[3]);
            const auto e = hn::InterleaveUpper(d, v[0], v[1]), f = hn::InterleaveUpper(d, v[2], v[3]);
            row[0].v[h] = hn::ConcatLowerLower(d, b, a);
            row[1].v[h] = hn::ConcatLowerLower(d, f, e);
            row[2].v[h] = hn::ConcatUpperUpper(d, b, a);
            row[3].v[h] = hn::ConcatUpperUpper(d, f, e);
        }
    } else
#endif
    {
        for (std::size_t s = 0; s < 4; ++s) {
            T x[block_lanes];
            for (std::size_t i = 0; i < block_lanes; ++i)
                x[i] = record[i][offset + s];
            row[s] = Lanes<T>::load(x);
        }
    }
}

/// The projected maps of 8 simulation nodes: rows() gives places offset … offset + 3 of their records, errors() the
/// last ones.
template <class T, std::size_t kAxes> struct ScatteredMaps {
    const T* record[block_lanes];
    HWY_INLINE void rows(std::size_t offset, Lanes<T>* row) const { transpose(record, offset, row); }
    HWY_INLINE Lanes<T> errors() const
    {
        T x[block_lanes];
        for (std::size_t i = 0; i < block_lanes; ++i)
            x[i] = record[i][4 * projected_rows(kAxes) - 1];
        return Lanes<T>::load(x);
    }
};
/// Of nodes 8i to 8i + 7, which stand side by side already.
template <class T, std::size_t kAxes> struct OctetOfMaps {
    const T* first;
    HWY_INLINE Lanes<T> errors() const { return Lanes<T>::load(first + (4 * projected_rows(kAxes) - 1) * block_lanes); }
    HWY_INLINE void rows(std::size_t offset, Lanes<T>* row) const
    {
        for (std::size_t s = 0; s < 4; ++s)
            row[s] = Lanes<T>::load(first + (offset + s) * block_lanes);
    }
};
template <std::size_t kAxes, class T, class F>
HWY_INLINE void with_maps(const ProjectedMaps<T>& maps, const std::uint32_t* node, F&& f)
{
    // Eight different nodes (a repeated one would be the last two) in ascending order, so a difference of 7 leaves no
    // gaps.
    if (!maps.octet.empty() && node[0] % block_lanes == 0 && node[block_lanes - 1] - node[0] == block_lanes - 1 &&
        node[block_lanes - 2] != node[block_lanes - 1])
        return f(OctetOfMaps<T, kAxes>{maps.octet.data() + node[0] * (4 * projected_rows(kAxes))});
    ScatteredMaps<T, kAxes> scattered;
    for (std::size_t i = 0; i < block_lanes; ++i)
        scattered.record[i] = maps.value.data() + node[i] * (4 * projected_rows(kAxes));
    f(scattered);
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
