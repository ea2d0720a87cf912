// SPDX-License-Identifier: Apache-2.0
// No #pragma once: compiled anew for every target.
#if defined(CINCH_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CINCH_LANES_INL
#undef CINCH_LANES_INL
#else
#define CINCH_LANES_INL
#endif

#include <cmath>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// `kLanes` values of T, one per axis of a k-DOP, as however many vectors the target needs.
template <class T, std::size_t kLanes> struct Lanes {
    using D = hn::CappedTag<T, kLanes == 12 ? 4 : kLanes>;
    using V = hn::Vec<D>;
    static constexpr std::size_t step = hn::MaxLanes(D());
    static constexpr std::size_t vectors = kLanes / step;

    static HWY_INLINE V load(const T* p, std::size_t i) { return hn::LoadU(D(), p + i * step); }
    static HWY_INLINE void store(V x, T* p, std::size_t i) { hn::StoreU(x, D(), p + i * step); }
    static HWY_INLINE V all(T x) { return hn::Set(D(), x); }

    /// a·b + c, rounded once: part of the definition of every result.
    static HWY_INLINE V fma(V a, V b, V c)
    {
#if HWY_NATIVE_FMA
        return hn::MulAdd(a, b, c);
#else
        T x[step], y[step], z[step];
        hn::StoreU(a, D(), x);
        hn::StoreU(b, D(), y);
        hn::StoreU(c, D(), z);
        for (std::size_t i = 0; i < step; ++i)
            z[i] = std::fma(x[i], y[i], z[i]);
        return hn::LoadU(D(), z);
#endif
    }
    /// a if a < b, else b; so b where a is NaN.
    static HWY_INLINE V less(V a, V b) { return hn::IfThenElse(hn::Lt(a, b), a, b); }
    static HWY_INLINE V greater(V a, V b) { return hn::IfThenElse(hn::Lt(b, a), a, b); }
    /// x rounded up by one or two steps, as succ() of rounding.hpp.
    static HWY_INLINE V up(V x)
    {
        constexpr T u = static_cast<T>(unit_roundoff_of<T>);
        return hn::Add(x, hn::Add(hn::Mul(all(u * (1 + 2 * u)), hn::Abs(x)), all(static_cast<T>(smallest_subnormal_of<T>))));
    }
};

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
