// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "cinch/bvh.hpp"
#include "toolkit/bounds/rounding.hpp"

namespace cinch {

/// A coordinate about the rest origin in T, and a bound on how far it is off. x − o is exact for o = 0.
template <class T> struct Shifted {
    T value;
    double off;
};
template <class T> Shifted<T> shifted(double x, double origin)
{
    const double d = x - origin;
    const T value = static_cast<T>(d);
    const double lost = origin == 0 || d == 0 ? 0 : succ(unit_roundoff * std::abs(d));
    const double off = std::abs(d - static_cast<double>(value)); // exact: 0, or a difference of neighbours
    return {value, off == 0 ? lost : succ(off + lost)};
}

/// At least a + b, for b ≥ 0.
inline double sum_up(double a, double b) { return b == 0 ? a : a == 0 ? b : succ(a + b); }

/// A box about the rest origin that holds the given one.
template <class T> void put_box(const RestBox& box, const Vec3& origin, T* centre, T* half)
{
    for (int s = 0; s < 3; ++s) {
        const Shifted<T> c = shifted<T>(box.centre[s], origin[s]);
        centre[s] = c.value;
        half[s] = round_up<T>(sum_up(box.half[s], c.off));
    }
}

/// The interval [l, l + r] of a weight, which is dyadic: h − l is exact. And the BV's sums of them.
template <class T> void put_interval(double least, double greatest, T& l, T& r, T& sum_l, T& sum_r)
{
    l = round_down<T>(least);
    r = round_up<T>(greatest - static_cast<double>(l));
    sum_l += l;
    sum_r += r;
}

} // namespace cinch
