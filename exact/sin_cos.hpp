// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>

#include "exact/number.hpp"

namespace cinch::exact {

/// sin and cos of all of x, which lies between 0 and π/2 but for rounding; else nothing is known. Taylor's sums of y =
/// x/4 up to y¹⁵ and y¹⁴, the rest of which are less than y¹⁷/17! and y¹⁶/16! as they alternate and fall, and two
/// double angles; at both ends, as both functions are monotonic here.
struct SinCos {
    Interval sin, cos;
};
inline SinCos sin_cos_at(double x)
{
    const Interval y = Interval(x) / 4;
    Interval sine(0), cosine(0), term(1); // y^n/n!
    for (int n = 0; n < 16; ++n) {
        (n % 2 ? sine : cosine) += n / 2 % 2 ? -term : term;
        term = term * y / (n + 1);
    }
    cosine += Interval(-1, 1) * term;
    sine += Interval(-1, 1) * (term * y / 17);
    for (int i = 0; i < 2; ++i) {
        const Interval twice = 2 * sine * cosine;
        cosine = 1 - 2 * sine * sine;
        sine = twice;
    }
    return {sine, cosine};
}
inline SinCos sin_cos(const Interval& x)
{
    constexpr double most = 0x1.921fb54442d18p+0; // the greatest double below π/2
    const Interval all(-1, 1);
    if (!(x.inf() >= -0x1p-40 && x.sup() <= 1.5708))
        return {all, all};
    const SinCos low = sin_cos_at(std::max(x.inf(), 0.0)), high = sin_cos_at(x.sup());
    // A little below 0 and past π/2 the sine of the end is below the greatest, and the cosine is not monotonic.
    const double least_sin = x.inf() < 0 ? x.inf() : low.sin.inf(), most_sin = x.sup() > most ? 1 : high.sin.sup(),
                 most_cos = x.inf() <= 0 ? 1 : low.cos.sup();
    return {Interval(std::min(least_sin, high.sin.inf()), std::max(most_sin, low.sin.sup())),
            Interval(std::min(high.cos.inf(), low.cos.inf()), std::max(most_cos, high.cos.sup()))};
}

} // namespace cinch::exact
