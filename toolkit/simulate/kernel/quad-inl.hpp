// SPDX-License-Identifier: Apache-2.0
// No #pragma once: compiled anew for every target.
#if defined(CINCH_QUAD_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CINCH_QUAD_INL
#undef CINCH_QUAD_INL
#else
#define CINCH_QUAD_INL
#endif

#include <cmath>
#include <cstddef>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// 4 doubles (x, y, z and a pad), as however many vectors the target needs. The same lane by lane everywhere.
struct Quad {
    using D = hn::CappedTag<double, 4>;
    using V = hn::Vec<D>;
    static constexpr std::size_t width = hn::MaxLanes(D()), vectors = 4 / width;

    V v[vectors];

    static HWY_INLINE Quad load(const double* p)
    {
        Quad q;
        for (std::size_t i = 0; i < vectors; ++i)
            q.v[i] = hn::Load(D(), p + i * width); // fields are aligned
        return q;
    }
    static HWY_INLINE Quad zero() { return all(0); }
    static HWY_INLINE Quad all(double value)
    {
        Quad q;
        for (std::size_t i = 0; i < vectors; ++i)
            q.v[i] = hn::Set(D(), value);
        return q;
    }
    HWY_INLINE void store(double* p) const
    {
        for (std::size_t i = 0; i < vectors; ++i)
            hn::StoreU(v[i], D(), p + i * width);
    }
};
template <class F> HWY_INLINE Quad each(const Quad& a, const Quad& b, F&& f)
{
    Quad q;
    for (std::size_t i = 0; i < Quad::vectors; ++i)
        q.v[i] = f(a.v[i], b.v[i]);
    return q;
}
HWY_INLINE Quad operator+(const Quad& a, const Quad& b) { return each(a, b, [](auto x, auto y) { return hn::Add(x, y); }); }
HWY_INLINE Quad operator-(const Quad& a, const Quad& b) { return each(a, b, [](auto x, auto y) { return hn::Sub(x, y); }); }
HWY_INLINE Quad operator*(const Quad& a, const Quad& b) { return each(a, b, [](auto x, auto y) { return hn::Mul(x, y); }); }
HWY_INLINE Quad times(const Quad& a, double s) { return a * Quad::all(s); }
/// a s + b, rounded once.
HWY_INLINE Quad multiply_add(const Quad& a, double s, const Quad& b)
{
#if HWY_NATIVE_FMA
    return each(a, b, [s](auto x, auto y) { return hn::MulAdd(x, hn::Set(Quad::D(), s), y); });
#else // the emulation would round twice
    return each(a, b, [s](auto x, auto y) { return hn::Set(Quad::D(), std::fma(hn::GetLane(x), s, hn::GetLane(y))); });
#endif
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
