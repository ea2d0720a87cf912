// SPDX-License-Identifier: GPL-3.0-or-later
// The methods over the BV's own box, written once for any arithmetic.
#include <algorithm>
#include <cmath>
#include <limits>

#include <CGAL/Gmpq.h>
#include <CGAL/Interval_nt.h>
#include <CGAL/Lazy_exact_nt.h>
#include <boost/multiprecision/mpfr.hpp>
#include <gmpxx.h>

#include "experiments/cost/cost.hpp"
#include "experiments/cost/numbers.hpp"
#include "toolkit/bounds/bound_box.hpp"
#include "toolkit/bounds/rounding.hpp"
#include "toolkit/bounds/weight_space.hpp"

namespace cinch {
namespace {

using Interval = CGAL::Interval_nt<false>;
using Mpfr =
    boost::multiprecision::number<boost::multiprecision::mpfr_float_backend<38, boost::multiprecision::allocate_stack>,
                                  boost::multiprecision::et_off>; // 128 bits
using Lazy = CGAL::Lazy_exact_nt<CGAL::Gmpq>;

// The upper end as a double: the least one that is not below; for float the number itself.
double upper(float x) { return static_cast<double>(x); }
double upper(const Mpfr& x)
{
    const double d = static_cast<double>(x);
    return Mpfr(d) < x ? std::nextafter(d, infinite) : d;
}
double upper(const Interval& x) { return x.sup(); }
double upper(const DoubleDouble& x) { return x.low > 0 ? std::nextafter(x.high, infinite) : x.high; }
double upper(const mpq_class& x)
{
    const double d = x.get_d(); // truncated
    return mpq_class(d) < x ? std::nextafter(d, infinite) : d;
}
double upper(const Lazy& x) { return x.approx().sup(); }

template <class N> double about(const N& x) { return upper(x); }
double about(const Interval& x) { return 0.5 * (x.inf() + x.sup()); }

template <class N> N greater_of(const N& a, const N& b) { return a < b ? b : a; }
Interval greater_of(const Interval& a, const Interval& b)
{
    return {std::max(a.inf(), b.inf()), std::max(a.sup(), b.sup())};
}
template <class N> N less_of(const N& a, const N& b) { return -greater_of(N(-a), N(-b)); }
template <class N> N magnitude(const N& x) { return greater_of(x, N(-x)); }
Interval magnitude(const Interval& x) { return CGAL::abs(x); }

template <class N> struct Bounder {
    std::vector<N> b[2];
    std::vector<std::pair<double, double>> select;

    void extrema(const RestBv& rest, std::span<const AffineMap> maps, const Axis& axis)
    {
        b[0].clear();
        b[1].clear();
        for (std::uint32_t node : rest.node) {
            N p(0), r(0);
            for (int s = 0; s < 4; ++s) {
                N g(0);
                for (std::size_t row = 0; row < 3; ++row)
                    if (axis[row] != 0)
                        g = axis[row] > 0 ? N(g + N(maps[node].m[row][s])) : N(g - N(maps[node].m[row][s]));
                p = s < 3 ? N(p + g * N(rest.box.centre[s])) : N(p + g);
                if (s < 3)
                    r = r + magnitude(g) * N(rest.box.half[s]);
            }
            b[0].push_back(r + p);
            b[1].push_back(r - p);
        }
    }
    N dual(WeightSpace space, const std::vector<N>& x, const N& lambda) const
    {
        N sum = lambda;
        for (std::size_t j = 0; j < x.size(); ++j) {
            const N above = x[j] - lambda;
            sum = sum + N(space.l[j]) * above + (N(space.h[j]) - N(space.l[j])) * greater_of(above, N(0));
        }
        return sum;
    }
    N value(WeightSpace space, const std::vector<N>& x, Method method)
    {
        N first = x[0], second = x[0];
        for (std::size_t j = 1; j < x.size(); ++j) {
            second = j == 1 ? less_of(first, x[j]) : greater_of(second, less_of(first, x[j]));
            first = greater_of(first, x[j]);
        }
        if (method == Method::convex)
            return first;
        if (method == Method::eq12)
            return dual(space, x, second);
        std::vector<double> rough; // λ may be as sloppy as it likes
        for (const N& y : x)
            rough.push_back(about(y));
        return dual(space, x, N(best_lambda(space, rough, select)));
    }
};

template <class N> void bound_in(const CostSample& sample, int kdop, Method method, std::span<double> supports)
{
    Bounder<N> bounder;
    std::size_t place = 0;
    for (std::size_t bv : sample.bvs) {
        const RestBv rest = sample.bvh.rest(bv);
        for (const Axis& axis : axes_of(kdop)) {
            bounder.extrema(rest, sample.maps, axis);
            for (const auto& side : bounder.b)
                supports[place++] = upper(bounder.value(rest.space, side, method));
        }
    }
}

// Proven extrema in double, rounded up to a grid of 2^-60 of the largest; from there on 128-bit integers, which are
// exact: weights have 53 bits, extrema 61, sums of up to 2^11 nodes 11 more.
void bound_on_grid(const CostSample& sample, int kdop, Method method, std::span<double> supports)
{
    using Integer = __int128;
    BoundScratch scratch;
    std::vector<double> convex(2);
    std::vector<Integer> b;
    std::vector<std::pair<double, double>> select;
    std::size_t place = 0;
    for (std::size_t bv : sample.bvs) {
        const RestBv rest = sample.bvh.rest(bv);
        for (const Axis& axis : axes_of(kdop)) {
            bound_box(rest, sample.maps, Method::convex, Rounding::proven, {&axis, 1}, scratch, convex);
            for (std::size_t side = 0; side < 2; ++side) {
                const std::vector<double>& x = side == 0 ? scratch.plus : scratch.minus;
                const double slack = convex[side] - *std::max_element(x.begin(), x.end()); // what the proof added
                double most = 0;
                for (double y : x)
                    most = std::max(most, std::abs(y));
                const int exponent = most > 0 ? std::ilogb(most) - 59 : -1000;
                b.clear();
                for (double y : x)
                    b.push_back(static_cast<Integer>(std::ceil(std::ldexp(y, -exponent))));
                Integer value = *std::max_element(b.begin(), b.end());
                if (method != Method::convex) {
                    const double at = method == Method::eq12 ? second_largest(x) : best_lambda(rest.space, x, select);
                    const Integer lambda = static_cast<Integer>(std::ceil(std::ldexp(at, -exponent)));
                    Integer sum = lambda << 53;
                    for (std::size_t j = 0; j < b.size(); ++j) {
                        const Integer above = b[j] - lambda;
                        sum += static_cast<Integer>((above > 0 ? rest.space.h[j] : rest.space.l[j]) * 0x1p53) * above;
                    }
                    value = (sum + ((Integer{1} << 53) - 1)) >> 53;
                }
                supports[place++] = succ(succ(std::ldexp(static_cast<double>(value), exponent)) + succ(slack));
            }
        }
    }
}

} // namespace

std::vector<CostContestant> scalar_contestants(const CostSample& sample, int kdop)
{
    std::vector<CostContestant> all;
    for (const Method method : ladder_methods) {
        auto add = [&](const char* arithmetic, const char* guarantee, bool proven, auto&& bound) {
            all.push_back(
                {std::string(name_of(method)), arithmetic, guarantee, proven, std::forward<decltype(bound)>(bound)});
        };
        auto in_double = [&sample, kdop, method](Rounding rounding) {
            return [&sample, kdop, method, rounding, scratch = BoundScratch()](std::span<double> supports) mutable {
                const auto k = static_cast<std::size_t>(kdop);
                for (std::size_t i = 0; i < sample.bvs.size(); ++i)
                    bound_box(sample.bvh.rest(sample.bvs[i]), sample.maps, method, rounding, axes_of(kdop), scratch,
                              supports.subspan(i * k, k));
            };
        };
        add("float", "none", false,
            [&sample, kdop, method](std::span<double> s) { bound_in<float>(sample, kdop, method, s); });
        add("double", "none", false, in_double(Rounding::plain));
        add("double, proven", "proven", true, in_double(Rounding::proven));
        add("interval", "proven", true, [&sample, kdop, method](std::span<double> s) {
            const CGAL::Protect_FPU_rounding<true> upward;
            bound_in<Interval>(sample, kdop, method, s);
        });
        add("double-double", "1e-31", false,
            [&sample, kdop, method](std::span<double> s) { bound_in<DoubleDouble>(sample, kdop, method, s); });
        add("MPFR 128", "1e-38", false,
            [&sample, kdop, method](std::span<double> s) { bound_in<Mpfr>(sample, kdop, method, s); });
        add("int128 grid", "proven", true,
            [&sample, kdop, method](std::span<double> s) { bound_on_grid(sample, kdop, method, s); });
        add("rational", "exact", true,
            [&sample, kdop, method](std::span<double> s) { bound_in<mpq_class>(sample, kdop, method, s); });
        add("lazy exact", "exact", true,
            [&sample, kdop, method](std::span<double> s) { bound_in<Lazy>(sample, kdop, method, s); });
    }
    return all;
}

} // namespace cinch
