// SPDX-License-Identifier: Apache-2.0
// No #pragma once: compiled anew for every target.
#if defined(CINCH_SIMD_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CINCH_SIMD_INL
#undef CINCH_SIMD_INL
#else
#define CINCH_SIMD_INL
#endif

#include <cmath>
#include <cstddef>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// N values of T as however many vectors the target needs, none of over kBytes. What is done to them is the same, value
/// by value, everywhere: results do not depend on the target.
template <class T, std::size_t N, std::size_t kBytes = 64> struct Simd {
    using D = hn::CappedTag<T, (N * sizeof(T) < kBytes ? N : kBytes / sizeof(T))>;
    using V = hn::Vec<D>;
    static constexpr std::size_t width = hn::MaxLanes(D()), vectors = N / width;

    V v[vectors];

    static HWY_INLINE Simd load(const T* p)
    {
        Simd x;
        for (std::size_t i = 0; i < vectors; ++i)
            x.v[i] = hn::LoadU(D(), p + i * width);
        return x;
    }
    static HWY_INLINE Simd all(T value)
    {
        Simd x;
        for (std::size_t i = 0; i < vectors; ++i)
            x.v[i] = hn::Set(D(), value);
        return x;
    }
    /// The same four values over and over.
    static HWY_INLINE Simd fours(const T* p)
    {
        Simd x;
        for (std::size_t i = 0; i < vectors; ++i) {
            if constexpr (width == 1)
                x.v[i] = hn::Set(D(), p[i % 4]);
            else if constexpr (sizeof(T) == 4)
                x.v[i] = hn::LoadDup128(D(), p);
#if HWY_TARGET != HWY_SCALAR
            else if constexpr (width == 8)
                x.v[i] = hn::Combine(D(), hn::LoadU(hn::Half<D>(), p), hn::LoadU(hn::Half<D>(), p));
#endif
            else
                x.v[i] = hn::LoadU(D(), p + i * width % 4);
        }
        return x;
    }
    HWY_INLINE void store(T* p) const
    {
        for (std::size_t i = 0; i < vectors; ++i)
            hn::StoreU(v[i], D(), p + i * width);
    }
};

template <class T, std::size_t N, std::size_t B, class F> HWY_INLINE Simd<T, N, B> each(const Simd<T, N, B>& a, F&& f)
{
    Simd<T, N, B> x;
    for (std::size_t i = 0; i < Simd<T, N, B>::vectors; ++i)
        x.v[i] = f(a.v[i]);
    return x;
}
template <class T, std::size_t N, std::size_t B, class F>
HWY_INLINE Simd<T, N, B> each(const Simd<T, N, B>& a, const Simd<T, N, B>& b, F&& f)
{
    Simd<T, N, B> x;
    for (std::size_t i = 0; i < Simd<T, N, B>::vectors; ++i)
        x.v[i] = f(a.v[i], b.v[i]);
    return x;
}
template <class T, std::size_t N, std::size_t B>
HWY_INLINE Simd<T, N, B> operator+(const Simd<T, N, B>& a, const Simd<T, N, B>& b)
{
    return each(a, b, [](auto x, auto y) { return hn::Add(x, y); });
}
template <class T, std::size_t N, std::size_t B>
HWY_INLINE Simd<T, N, B> operator-(const Simd<T, N, B>& a, const Simd<T, N, B>& b)
{
    return each(a, b, [](auto x, auto y) { return hn::Sub(x, y); });
}
template <class T, std::size_t N, std::size_t B>
HWY_INLINE Simd<T, N, B> operator*(const Simd<T, N, B>& a, const Simd<T, N, B>& b)
{
    return each(a, b, [](auto x, auto y) { return hn::Mul(x, y); });
}
template <class T, std::size_t N, std::size_t B>
HWY_INLINE Simd<T, N, B> operator/(const Simd<T, N, B>& a, const Simd<T, N, B>& b)
{
    return each(a, b, [](auto x, auto y) { return hn::Div(x, y); });
}
template <class T, std::size_t N, std::size_t B> HWY_INLINE Simd<T, N, B> magnitude(const Simd<T, N, B>& a)
{
    return each(a, [](auto x) { return hn::Abs(x); });
}
template <class T, std::size_t N, std::size_t B> HWY_INLINE Simd<T, N, B> root(const Simd<T, N, B>& a)
{
    return each(a, [](auto x) { return hn::Sqrt(x); });
}
/// Of numbers: where one is none, the result depends on the target.
template <class T, std::size_t N, std::size_t B>
HWY_INLINE Simd<T, N, B> greater(const Simd<T, N, B>& a, const Simd<T, N, B>& b)
{
    return each(a, b, [](auto x, auto y) { return hn::Max(x, y); });
}
template <class T, std::size_t N, std::size_t B>
HWY_INLINE Simd<T, N, B> less(const Simd<T, N, B>& a, const Simd<T, N, B>& b)
{
    return each(a, b, [](auto x, auto y) { return hn::Min(x, y); });
}
/// x where x < y, else y: y where x is not a number.
template <class T, std::size_t N, std::size_t B>
HWY_INLINE Simd<T, N, B> lesser(const Simd<T, N, B>& x, const Simd<T, N, B>& y)
{
    return each(x, y, [](auto a, auto b) { return hn::IfThenElse(hn::Lt(a, b), a, b); });
}
/// x where a > 0, else 0.
template <class T, std::size_t N, std::size_t B>
HWY_INLINE Simd<T, N, B> where_positive(const Simd<T, N, B>& a, const Simd<T, N, B>& x)
{
    return each(a, x,
                [](auto p, auto y) { return hn::IfThenElseZero(hn::Gt(p, hn::Zero(typename Simd<T, N, B>::D())), y); });
}
/// Whether every value of x is at most that of y, and all are numbers.
template <class T, std::size_t N, std::size_t B> HWY_INLINE bool at_most(const Simd<T, N, B>& x, const Simd<T, N, B>& y)
{
    bool all = true;
    for (std::size_t i = 0; i < Simd<T, N, B>::vectors; ++i)
        all &= hn::AllTrue(typename Simd<T, N, B>::D(), hn::Le(x.v[i], y.v[i]));
    return all;
}

/// a·b + c, rounded once: part of the definition of every result.
template <class T, std::size_t N, std::size_t B>
HWY_INLINE Simd<T, N, B> fma(const Simd<T, N, B>& a, const Simd<T, N, B>& b, const Simd<T, N, B>& c)
{
    using X = Simd<T, N, B>;
    X x;
    for (std::size_t i = 0; i < X::vectors; ++i)
#if HWY_NATIVE_FMA
        x.v[i] = hn::MulAdd(a.v[i], b.v[i], c.v[i]);
#else // the emulation would round twice
        x.v[i] = hn::Set(typename X::D(), std::fma(hn::GetLane(a.v[i]), hn::GetLane(b.v[i]), hn::GetLane(c.v[i])));
    static_assert(X::width == 1);
#endif
    return x;
}
/// a·b − c, rounded once.
template <class T, std::size_t N, std::size_t B>
HWY_INLINE Simd<T, N, B> fms(const Simd<T, N, B>& a, const Simd<T, N, B>& b, const Simd<T, N, B>& c)
{
    using X = Simd<T, N, B>;
    X x;
    for (std::size_t i = 0; i < X::vectors; ++i)
#if HWY_NATIVE_FMA
        x.v[i] = hn::MulSub(a.v[i], b.v[i], c.v[i]);
#else
        x.v[i] = hn::Set(typename X::D(), std::fma(hn::GetLane(a.v[i]), hn::GetLane(b.v[i]), -hn::GetLane(c.v[i])));
#endif
    return x;
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
