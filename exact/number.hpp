// SPDX-License-Identifier: GPL-3.0-or-later
// Internal to exact/: the two number types. Only .cpp files of exact/ and its tests include this.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <string>

#include <CGAL/Gmpq.h>
#include <CGAL/Gmpzf.h>
#include <CGAL/Interval_nt.h>

namespace cinch::exact {

/// m·2^e with unlimited m: sums, differences and products of doubles are exact. There is no division on this side.
using Exact = CGAL::Gmpzf;
/// Encloses the exact value; needs upward rounding, see DirectedRounding.
using Interval = CGAL::Interval_nt<false>;
/// While one of these lives, the thread rounds upward, as Interval requires. No toolkit function may be called meanwhile.
using DirectedRounding = CGAL::Protect_FPU_rounding<true>;

inline Exact maximum(const Exact& a, const Exact& b) { return a < b ? b : a; }
inline Interval maximum(const Interval& a, const Interval& b)
{
    if (!(a.inf() <= a.sup() && b.inf() <= b.sup()))
        return Interval::largest(); // an end is NaN, after an overflow
    return Interval(std::max(a.inf(), b.inf()), std::max(a.sup(), b.sup()));
}
inline Interval minimum(const Interval& a, const Interval& b) { return -maximum(-a, -b); }
inline Exact absolute(const Exact& x) { return x < Exact(0) ? -x : x; }
inline Interval absolute(const Interval& x) { return CGAL::abs(x); }

inline double middle(const Interval& x) { return x.inf() + 0.5 * (x.sup() - x.inf()); }

/// "p/q" in lowest terms, q > 0.
inline std::string as_fraction(const Exact& x)
{
    mpq_t q;
    mpq_init(q);
    mpz_set(mpq_numref(q), x.man());
    if (x.exp() >= 0)
        mpz_mul_2exp(mpq_numref(q), mpq_numref(q), static_cast<mp_bitcnt_t>(x.exp()));
    else
        mpz_mul_2exp(mpq_denref(q), mpq_denref(q), static_cast<mp_bitcnt_t>(-x.exp()));
    mpq_canonicalize(q);
    char* text = mpq_get_str(nullptr, 10, q);
    std::string out = text;
    void (*release)(void*, size_t);
    mp_get_memory_functions(nullptr, nullptr, &release);
    release(text, out.size() + 1);
    if (mpz_cmp_ui(mpq_denref(q), 1) == 0)
        out += "/1"; // GMP leaves it out
    mpq_clear(q);
    return out;
}

} // namespace cinch::exact
