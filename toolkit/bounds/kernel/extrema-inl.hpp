// SPDX-License-Identifier: Apache-2.0
// No #pragma once: compiled anew for every target.
#if defined(CINCH_EXTREMA_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CINCH_EXTREMA_INL
#undef CINCH_EXTREMA_INL
#else
#define CINCH_EXTREMA_INL
#endif

#include <cstddef>
#include <limits>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {

template <class T> inline constexpr T infinity_of = std::numeric_limits<T>::infinity();

/// What one pass over the extrema leaves, per side and axis: the greatest, the second-greatest or the mean weighted by r.
template <class T, std::size_t kAxes> struct Extrema {
    T greatest[2][kAxes], second[2][kAxes], mean[2][kAxes];
};

/// D(λ) in parts: Σ l (b − λ), Σ r max(b − λ, 0) and, where asked for, Σ r over b > λ.
template <class T, std::size_t kAxes> struct Dual {
    T lower[2][kAxes], upper[2][kAxes], mass[2][kAxes];
};

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
