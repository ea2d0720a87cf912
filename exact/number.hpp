// SPDX-License-Identifier: GPL-3.0-or-later
// Internal to exact/: the two number types. Only .cpp files of exact/ and its tests include this.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <string>

#include <CGAL/Gmpzf.h>
#include <CGAL/Interval_nt.h>
#include <gmpxx.h>

namespace cinch::exact {

/// m·2^e with unlimited m: sums, differences and products of doubles are exact. There is no division on this side.
using Exact = CGAL::Gmpzf;
/// Encloses the exact value; needs upward rounding, see DirectedRounding.
using Interval = CGAL::Interval_nt<false>;
/// While one of these lives, the thread rounds upward, as Interval requires. No toolkit function may be called
/// meanwhile.
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

using CGAL::certainly; // false where an interval comparison leaves it open

inline double middle(const Interval& x) { return x.inf() + 0.5 * (x.sup() - x.inf()); }

/// z·2^exponent as "p/q" in lowest terms, q > 0.
inline std::string as_fraction(const mpz_t z, long exponent)
{
    mpq_class q;
    mpz_set(q.get_num_mpz_t(), z);
    if (exponent >= 0)
        mpz_mul_2exp(q.get_num_mpz_t(), q.get_num_mpz_t(), static_cast<mp_bitcnt_t>(exponent));
    else
        mpz_mul_2exp(q.get_den_mpz_t(), q.get_den_mpz_t(), static_cast<mp_bitcnt_t>(-exponent));
    q.canonicalize();
    return q.get_num().get_str() + "/" + q.get_den().get_str();
}
inline std::string as_fraction(const Exact& x) { return as_fraction(x.man(), x.exp()); }

} // namespace cinch::exact
