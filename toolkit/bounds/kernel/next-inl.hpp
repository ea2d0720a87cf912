// SPDX-License-Identifier: Apache-2.0
// No #pragma once: compiled anew for every target.
#if defined(CINCH_NEXT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CINCH_NEXT_INL
#undef CINCH_NEXT_INL
#else
#define CINCH_NEXT_INL
#endif

#include "toolkit/bounds/rounding.hpp"
#include "toolkit/deform/kernel/simd-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {

/// succ of rounding.hpp.
template <class T, std::size_t N, std::size_t B> HWY_INLINE Simd<T, N, B> next(const Simd<T, N, B>& x)
{
    using X = Simd<T, N, B>;
    constexpr T phi = unit_roundoff_of<T> * (1 + 2 * unit_roundoff_of<T>);
    return x + (magnitude(x) * X::all(phi) + X::all(smallest_subnormal_of<T>));
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
