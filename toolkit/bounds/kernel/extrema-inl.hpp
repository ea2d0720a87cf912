// SPDX-License-Identifier: Apache-2.0
// No #pragma once: compiled anew for every target.
#if defined(CINCH_EXTREMA_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CINCH_EXTREMA_INL
#undef CINCH_EXTREMA_INL
#else
#define CINCH_EXTREMA_INL
#endif

#include <algorithm>
#include <cstddef>
#include <limits>

#include <hwy/highway.h>

#include "toolkit/bounds/packed_bv.hpp"

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {

template <class T> inline constexpr T infinity_of = std::numeric_limits<T>::infinity();

/// Values along every axis, then those against it, with room behind each side for lanes and rows to take and store.
/// Lanes compute there too, so what is filled value by value repeats its last one: numbers, and no subnormal ones,
/// which are slow.
template <class T, std::size_t kAxes> struct PerSide {
    static constexpr std::size_t room =
        kAxes <= block_lanes / 2 ? block_lanes / 2 : (kAxes + block_lanes - 1) / block_lanes * block_lanes;
    alignas(64) T value[2 * room + 12];

    T* operator[](std::size_t side) { return value + side * room; }
    const T* operator[](std::size_t side) const { return value + side * room; }
    void repeat_last()
    {
        for (std::size_t s = 0; s < 2; ++s)
            std::fill((*this)[s] + kAxes, (*this)[s] + room, (*this)[s][kAxes - 1]);
    }
};

/// What one pass over the extrema leaves: the greatest, the second-greatest or the mean weighted by r.
template <class T, std::size_t kAxes> struct Extrema {
    PerSide<T, kAxes> greatest, second, mean;
};

/// D(λ) in parts: Σ l (b − λ), Σ r max(b − λ, 0) and, where asked for, Σ r over b > λ.
template <class T, std::size_t kAxes> struct Dual {
    PerSide<T, kAxes> lower, upper, mass;
};

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
