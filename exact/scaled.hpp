// SPDX-License-Identifier: GPL-3.0-or-later
// Internal to exact/: a weight space in integers.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <stdexcept>
#include <vector>

#include <gmpxx.h>

#include "toolkit/bounds/weight_space.hpp"

namespace cinch::exact {

__extension__ typedef __int128 Int128;

/// x·2^shift as an integer; x is a double for which that is one.
template <class Int> Int scaled(double x, int shift)
{
    int exponent = 0;
    const double mantissa = std::frexp(x, &exponent); // x = mantissa·2^exponent, mantissa·2^53 an integer
    const auto digits = static_cast<std::int64_t>(mantissa * 0x1p53);
    const int up = exponent - 53 + shift;
    Int out;
    if constexpr (std::is_same_v<Int, mpz_class>) {
        mpz_set_si(out.get_mpz_t(), digits); // digits fit a long where GMP is built for 64 bits
        if (up >= 0)
            mpz_mul_2exp(out.get_mpz_t(), out.get_mpz_t(), static_cast<mp_bitcnt_t>(up));
        else
            mpz_tdiv_q_2exp(out.get_mpz_t(), out.get_mpz_t(), static_cast<mp_bitcnt_t>(-up)); // exact by assumption
    } else {
        out = static_cast<Int>(digits);
        out = up >= 0 ? static_cast<Int>(out * (Int{1} << std::min(up, 126)))
                      : static_cast<Int>(out >> std::min(-up, 63));
    }
    return out;
}

/// The smallest shift ≥ 0 that makes every x·2^shift an integer.
inline int common_shift(WeightSpace space)
{
    int shift = 0;
    for (auto values : {space.l, space.h})
        for (double x : values) {
            if (x == 0)
                continue;
            int exponent = 0;
            const auto digits = static_cast<std::uint64_t>(std::frexp(x, &exponent) * 0x1p53); // x > 0
            shift = std::max(shift, 53 - std::countr_zero(digits) - exponent);
        }
    return shift;
}

/// Ranges h − l > 0, widest first, and the slack 1 − Σ l, in units of 2^-shift.
template <class Int> struct Ranges {
    std::vector<Int> range;
    std::vector<std::uint32_t> order; // original indices
    Int slack;
};

template <class Int> Ranges<Int> ranges_of(WeightSpace space, int shift)
{
    Ranges<Int> out;
    out.slack = scaled<Int>(1.0, shift);
    std::vector<Int> range;
    for (std::size_t j = 0; j < space.l.size(); ++j) {
        const Int l = scaled<Int>(space.l[j], shift);
        out.slack -= l;
        range.push_back(scaled<Int>(space.h[j], shift) - l);
        if (range.back() > 0)
            out.order.push_back(static_cast<std::uint32_t>(j));
    }
    std::stable_sort(out.order.begin(), out.order.end(),
                     [&](std::uint32_t i, std::uint32_t j) { return range[i] > range[j]; });
    for (std::uint32_t j : out.order)
        out.range.push_back(range[j]);
    return out;
}

/// Calls f with a value of the narrowest integer type in which every sum of the space's weights fits.
template <class F> auto with_integers(WeightSpace space, F&& f)
{
    const int shift = common_shift(space);
    const int bits = shift + 2 + static_cast<int>(std::bit_width(space.l.size())); // sums of n weights ≤ 1, and a sign
    if (bits <= 63)
        return f(std::int64_t{}, shift);
    if (bits <= 126)
        return f(Int128{}, shift);
    return f(mpz_class{}, shift);
}

} // namespace cinch::exact
