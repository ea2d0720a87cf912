// SPDX-License-Identifier: Apache-2.0
// No #pragma once: compiled anew for every target.
#if defined(CINCH_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CINCH_LANES_INL
#undef CINCH_LANES_INL
#else
#define CINCH_LANES_INL
#endif

#include <cmath>
#include <limits>

#include <hwy/highway.h>

#include "toolkit/bounds/kernel/extrema-inl.hpp"
#include "toolkit/bounds/packed_bv.hpp"
#include "toolkit/bounds/projected_maps.hpp"
#include "toolkit/bounds/rounding.hpp"

// On lambdas whose captures must stay in registers.
#ifndef CINCH_FLATTEN
#define CINCH_FLATTEN __attribute__((always_inline))
#endif

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// 8 virtual lanes of T, as however many vectors the target needs. What is done to them is the same, lane by lane, everywhere.
template <class T> struct Lanes {
    using D = hn::CappedTag<T, 32 / sizeof(T)>; // 256 bits at most
    using V = hn::Vec<D>;
    static constexpr std::size_t width = hn::MaxLanes(D()), vectors = block_lanes / width;

    V v[vectors];

    static HWY_INLINE Lanes load(const T* p)
    {
        Lanes x;
        for (std::size_t i = 0; i < vectors; ++i)
            x.v[i] = hn::LoadU(D(), p + i * width);
        return x;
    }
    static HWY_INLINE Lanes all(T value)
    {
        Lanes x;
        for (std::size_t i = 0; i < vectors; ++i)
            x.v[i] = hn::Set(D(), value);
        return x;
    }
    HWY_INLINE void store(T* p) const
    {
        for (std::size_t i = 0; i < vectors; ++i)
            hn::StoreU(v[i], D(), p + i * width);
    }
};

template <class T, class F> HWY_INLINE Lanes<T> each(const Lanes<T>& a, F&& f)
{
    Lanes<T> x;
    for (std::size_t i = 0; i < Lanes<T>::vectors; ++i)
        x.v[i] = f(a.v[i]);
    return x;
}
template <class T, class F> HWY_INLINE Lanes<T> each(const Lanes<T>& a, const Lanes<T>& b, F&& f)
{
    Lanes<T> x;
    for (std::size_t i = 0; i < Lanes<T>::vectors; ++i)
        x.v[i] = f(a.v[i], b.v[i]);
    return x;
}
template <class T> HWY_INLINE Lanes<T> operator+(const Lanes<T>& a, const Lanes<T>& b) { return each(a, b, [](auto x, auto y) { return hn::Add(x, y); }); }
template <class T> HWY_INLINE Lanes<T> operator-(const Lanes<T>& a, const Lanes<T>& b) { return each(a, b, [](auto x, auto y) { return hn::Sub(x, y); }); }
template <class T> HWY_INLINE Lanes<T> operator*(const Lanes<T>& a, const Lanes<T>& b) { return each(a, b, [](auto x, auto y) { return hn::Mul(x, y); }); }
template <class T> HWY_INLINE Lanes<T> magnitude(const Lanes<T>& a) { return each(a, [](auto x) { return hn::Abs(x); }); }
/// Of numbers; NaN occurs only where the node's error is infinite, which decides the result.
template <class T> HWY_INLINE Lanes<T> greater(const Lanes<T>& a, const Lanes<T>& b) { return each(a, b, [](auto x, auto y) { return hn::Max(x, y); }); }
template <class T> HWY_INLINE Lanes<T> less(const Lanes<T>& a, const Lanes<T>& b) { return each(a, b, [](auto x, auto y) { return hn::Min(x, y); }); }
/// x where a > 0, else 0.
template <class T> HWY_INLINE Lanes<T> where_positive(const Lanes<T>& a, const Lanes<T>& x)
{
    return each(a, x, [](auto p, auto y) { return hn::IfThenElseZero(hn::Gt(p, hn::Zero(typename Lanes<T>::D())), y); });
}

/// a·b + c, rounded once: part of the definition of every result.
template <class T> HWY_INLINE Lanes<T> fma(const Lanes<T>& a, const Lanes<T>& b, const Lanes<T>& c)
{
    Lanes<T> x;
#if HWY_NATIVE_FMA
    for (std::size_t i = 0; i < Lanes<T>::vectors; ++i)
        x.v[i] = hn::MulAdd(a.v[i], b.v[i], c.v[i]);
#else
    T p[block_lanes], q[block_lanes], r[block_lanes];
    a.store(p);
    b.store(q);
    c.store(r);
    for (std::size_t i = 0; i < block_lanes; ++i)
        r[i] = std::fma(p[i], q[i], r[i]);
    x = Lanes<T>::load(r);
#endif
    return x;
}

/// ((0 + 4) + (2 + 6)) + ((1 + 5) + (3 + 7)).
template <class T> HWY_INLINE T sum(const Lanes<T>& a)
{
    T x[block_lanes];
    a.store(x);
    return ((x[0] + x[4]) + (x[2] + x[6])) + ((x[1] + x[5]) + (x[3] + x[7]));
}
template <class T> HWY_INLINE T greatest(const Lanes<T>& a)
{
    T x[block_lanes];
    a.store(x);
    for (std::size_t half = block_lanes / 2; half > 0; half /= 2)
        for (std::size_t i = 0; i < half; ++i)
            x[i] = x[i + half] > x[i] ? x[i + half] : x[i];
    return x[0];
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
        const auto a = hn::BitCast(pairs, hn::InterleaveLower(d, v[0], v[1])), b = hn::BitCast(pairs, hn::InterleaveLower(d, v[2], v[3]));
        const auto e = hn::BitCast(pairs, hn::InterleaveUpper(d, v[0], v[1])), f = hn::BitCast(pairs, hn::InterleaveUpper(d, v[2], v[3]));
        row[0].v[0] = hn::BitCast(d, hn::InterleaveLower(pairs, a, b));
        row[1].v[0] = hn::BitCast(d, hn::InterleaveUpper(pairs, a, b));
        row[2].v[0] = hn::BitCast(d, hn::InterleaveLower(pairs, e, f));
        row[3].v[0] = hn::BitCast(d, hn::InterleaveUpper(pairs, e, f));
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

/// The projected maps of 8 simulation nodes: rows() gives places offset … offset + 3 of their records, errors() the last ones.
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
template <std::size_t kAxes, class T, class F> HWY_INLINE void with_maps(const ProjectedMaps<T>& maps, const std::uint32_t* node, F&& f)
{
    // Eight different nodes (a repeated one would be the last two) in ascending order, so a difference of 7 leaves no gaps.
    if (!maps.octet.empty() && node[0] % block_lanes == 0 && node[block_lanes - 1] - node[0] == block_lanes - 1 && node[block_lanes - 2] != node[block_lanes - 1])
        return f(OctetOfMaps<T, kAxes>{maps.octet.data() + node[0] * (4 * projected_rows(kAxes))});
    ScatteredMaps<T, kAxes> scattered;
    for (std::size_t i = 0; i < block_lanes; ++i)
        scattered.record[i] = maps.value.data() + node[i] * (4 * projected_rows(kAxes));
    f(scattered);
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
