// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

namespace cinch {

/// An unevaluated sum of two doubles, about 106 bits [Dekker 1971; Knuth's TwoSum; Ogita, Rump, Oishi 2005]. Rounds to
/// nearest, about; no bound is proven with it.
struct DoubleDouble {
    double high = 0, low = 0;

    DoubleDouble() = default;
    DoubleDouble(double x) : high(x) {}
    DoubleDouble(double h, double l) : high(h), low(l) {}
};

inline DoubleDouble quick_sum(double a, double b)
{
    const double s = a + b;
    return {s, b - (s - a)};
}
inline DoubleDouble operator+(const DoubleDouble& a, const DoubleDouble& b)
{
    const double s = a.high + b.high, part = s - a.high;
    return quick_sum(s, ((a.high - (s - part)) + (b.high - part)) + (a.low + b.low));
}
inline DoubleDouble operator-(const DoubleDouble& a) { return {-a.high, -a.low}; }
inline DoubleDouble operator-(const DoubleDouble& a, const DoubleDouble& b) { return a + -b; }
inline DoubleDouble operator*(const DoubleDouble& a, const DoubleDouble& b)
{
    const double p = a.high * b.high;
    return quick_sum(p, std::fma(a.high, b.high, -p) + (a.high * b.low + a.low * b.high));
}
inline bool operator<(const DoubleDouble& a, const DoubleDouble& b)
{
    return a.high < b.high || (a.high == b.high && a.low < b.low);
}

} // namespace cinch
