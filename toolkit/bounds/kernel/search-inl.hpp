// SPDX-License-Identifier: Apache-2.0
// No #pragma once: compiled anew for every target.
// From the extrema to a bound: D at the λ of a kind.
#if defined(CINCH_SEARCH_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CINCH_SEARCH_INL
#undef CINCH_SEARCH_INL
#else
#define CINCH_SEARCH_INL
#endif

#include <algorithm>
#include <cmath>
#include <optional>

#include "toolkit/bounds/kernel/bound_kernel.hpp"
#include "toolkit/bounds/kernel/choose_lambda.hpp"
#include "toolkit/bounds/kernel/guard-inl.hpp"
#include "toolkit/bounds/kernel/lanes-inl.hpp"
#include "toolkit/bounds/weight_space.hpp"

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {

/// One BV's bound on its way.
template <class T, std::size_t kAxes> struct Bound {
    PerSide<T, kAxes> value, floor; // floors of a BV with a guard
    T error;                        // the greatest of the BV's nodes
};

template <class T, std::size_t kAxes> void store(const Sides<T, kAxes>& sides, PerSide<T, kAxes>& out)
{
    for (std::size_t s = 0; s < 2; ++s)
        for (std::size_t c = 0; c < row_chunks<kAxes>; ++c)
            sides.chunk[s][c].store(out[s] + 4 * c); // what is too much, the next one overwrites
    out.repeat_last();
}

/// What the errors of the BV's nodes add.
template <class T, std::size_t kAxes>
double widening(const KernelInput<T>& in, const PackedBv<T>& bv, const Bound<T, kAxes>& bound)
{
    const double error = static_cast<double>(bound.error);
    return in.rounding == Rounding::proven ? succ(error * static_cast<double>(bv.error_factor)) : error;
}

template <class T, std::size_t kAxes> void intersect(const KernelInput<T>& in, const PackedBv<T>& bv,
                                                     const Extrema<T, kAxes>& e, const PerSide<T, kAxes>& lambda,
                                                     const Dual<T, kAxes>& d, Bound<T, kAxes>& out)
{
    const auto factor =
        Lanes<T>::all(dual_sum_factor<T>(takes_one_by_one(bv.kind) ? row_depth(bv.count) : sum_depth(bv.count)));
    const auto underflow = Lanes<T>::all(dual_sum_underflow<T>(bv.count));
    for (std::size_t i = 0; i < 2 * lambda.room; i += block_lanes) {
        const auto at = lanes_of(lambda, i), upper = lanes_of(d.upper, i), both = lanes_of(d.lower, i) + upper;
        auto value = at + both;                // dual_value
        if (in.rounding == Rounding::proven) { // proven_dual_value
            const auto width = greater(lanes_of(e.greatest, i) - at, at + opposite_lanes(e.greatest, i));
            value = next(at + next(both + next(factor * (width + upper) + underflow)));
        }
        lesser(value, lanes_of(out.value, i)).store(out.value.value + i);
    }
}

template <class T, std::size_t kAxes> void select_best(const PackedBv<T>& bv, const T* block, const T* b,
                                                       std::vector<std::pair<T, T>>& scratch, PerSide<T, kAxes>& lambda)
{
    scratch.resize(bv.count);
    const std::size_t rows = PackedBv<T>::rows(bv.kind);
    for (std::size_t s = 0; s < 2; ++s)
        for (std::size_t a = 0; a < kAxes; ++a) {
            const T* extremum = b + (2 * a + s) * block_lanes;
            const T* range = block + block_lanes;
            for (std::size_t j = 0; j < bv.count; j += block_lanes) {
                for (std::size_t lane = 0; lane < std::min(block_lanes, bv.count - j); ++lane)
                    scratch[j + lane] = {extremum[lane], range[lane]};
                extremum += 2 * kAxes * block_lanes;
                range += rows * block_lanes;
            }
            lambda[s][a] = best_lambda<T>(scratch, 1 - bv.sum_l);
        }
    lambda.repeat_last();
}

/// Whether no side of the bound exceeds its floor, hence Eq. 12, clearly.
template <class T, std::size_t kAxes>
bool is_close(const KernelInput<T>& in, const PackedBv<T>& bv, const Bound<T, kAxes>& bound)
{
    const auto wider = Lanes<T>::all(static_cast<T>(widening<T, kAxes>(in, bv, bound)));
    bool close = true;
    for (std::size_t i = 0; i < 2 * bound.floor.room; i += block_lanes) {
        const auto floor = lanes_of(bound.floor, i),
                   width = greater(floor + opposite_lanes(bound.floor, i), Lanes<T>::all(0));
        close &= at_most(lanes_of(bound.value, i) + wider, floor + Lanes<T>::all(T(clearly_looser)) * width);
    }
    return close;
}

/// λ near the best one by at most in.passes evaluations of D, which is evaluate<with its mass>(λ, D).
template <class T, std::size_t kAxes, class Evaluate> void search(const KernelInput<T>& in, const PackedBv<T>& bv,
                                                                  const Extrema<T, kAxes>& e, T* remembered,
                                                                  Bound<T, kAxes>& out, const Evaluate& evaluate)
{
    PerSide<T, kAxes> lambda;
    for (std::size_t i = 0; i < 2 * lambda.room; i += block_lanes) {
        const auto mean = lanes_of(e.mean, i);
        (mean + Lanes<T>::all(bv.start) * (lanes_of(e.greatest, i) - mean)).store(lambda.value + i);
    }
    for (std::size_t s = 0; s < 2 && remembered; ++s)
        for (std::size_t a = 0; a < kAxes; ++a)
            if (std::isfinite(remembered[2 * (s * kAxes + a)]))
                lambda[s][a] = remembered[2 * (s * kAxes + a)];
    Dual<T, kAxes> d;
    if (in.passes == 1 && !remembered) {
        evaluate.template operator()<false>(lambda, d);
        intersect<T, kAxes>(in, bv, e, lambda, d, out);
        return;
    }
    std::optional<TangentSearch<T>> tangents[2][kAxes];
    for (int pass = 0; pass < in.passes; ++pass) {
        evaluate.template operator()<true>(lambda, d);
        intersect<T, kAxes>(in, bv, e, lambda, d, out);
        for (std::size_t s = 0; s < 2; ++s)
            for (std::size_t a = 0; a < kAxes; ++a) {
                const DualParts<T> parts{d.lower[s][a], d.upper[s][a], d.mass[s][a]};
                if (pass == 0)
                    tangents[s][a].emplace(lambda[s][a], parts, bv.sum_l, bv.sum_r, e.mean[s][a]);
                const T here = lambda[s][a];
                lambda[s][a] = tangents[s][a]->next(here, parts, bv.sum_l);
                if (remembered && pass + 1 == in.passes)
                    remember(here, lambda[s][a] - here, 1 - bv.sum_l - parts.mass, remembered + 2 * (s * kAxes + a));
            }
    }
}

/// The greatest b, to be intersected with D where λ is best.
template <class T, std::size_t kAxes> void begin(const Extrema<T, kAxes>& e, Bound<T, kAxes>& out)
{
    for (std::size_t i = 0; i < 2 * out.value.room; i += block_lanes)
        lanes_of(e.greatest, i).store(out.value.value + i);
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
