// SPDX-License-Identifier: Apache-2.0
// No #pragma once: compiled anew for every target.
#if defined(CINCH_DUAL_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CINCH_DUAL_INL
#undef CINCH_DUAL_INL
#else
#define CINCH_DUAL_INL
#endif

#include "toolkit/bounds/kernel/reference-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {

/// What one pass over the extrema leaves, per side and lane.
template <class T, std::size_t kLanes> struct Extrema {
    alignas(64) T greatest[2][kLanes], second[2][kLanes], mean[2][kLanes];
};

/// b̂_j of every simulation node along and against the axes, over its local box (kLocal) or the BV's, less the reference map.
template <class T, std::size_t kLanes, bool kLocal, bool kReference, bool kSecond>
void extrema(const PackedBv<T>& bv, const ProjectedMaps<T>& maps, const std::uint32_t* node, const T* record, const LaneMap<T, kLanes>& reference,
             T* b, Extrema<T, kLanes>& out)
{
    using L = Lanes<T, kLanes>;
    using V = typename L::V;
    constexpr std::size_t size = PackedBv<T>::record(kLocal ? Method::local : Method::limited);
    const V lowest = L::all(-std::numeric_limits<T>::infinity());
    V greatest[2][L::vectors], second[2][L::vectors], position[L::vectors], radius[L::vectors];
    for (std::size_t i = 0; i < L::vectors; ++i) {
        greatest[0][i] = greatest[1][i] = second[0][i] = second[1][i] = lowest;
        position[i] = radius[i] = L::all(0);
    }
    for (std::size_t j = 0; j < bv.count; ++j, record += size, b += 2 * kLanes) {
        const T* q = maps.of(node[j]);
        const T* c = kLocal ? record + 2 : bv.centre;
        const T* e = kLocal ? record + 5 : bv.half;
        const V r = L::all(record[1]);
        for (std::size_t i = 0; i < L::vectors; ++i) {
            V q0 = L::load(q, i), q1 = L::load(q + kLanes, i), q2 = L::load(q + 2 * kLanes, i), theta = L::load(q + 3 * kLanes, i);
            if constexpr (kReference) {
                q0 = hn::Sub(q0, L::load(reference.row[0], i));
                q1 = hn::Sub(q1, L::load(reference.row[1], i));
                q2 = hn::Sub(q2, L::load(reference.row[2], i));
                theta = hn::Sub(theta, L::load(reference.row[3], i));
            }
            const V p = L::fma(q0, L::all(c[0]), L::fma(q1, L::all(c[1]), L::fma(q2, L::all(c[2]), theta)));
            V w = L::fma(hn::Abs(q0), L::all(e[0]), L::fma(hn::Abs(q1), L::all(e[1]), hn::Mul(hn::Abs(q2), L::all(e[2]))));
            if constexpr (kLocal && !kReference) // the ball
                w = hn::Min(w, hn::Mul(L::load(q + 4 * kLanes, i), L::all(record[8])));
            const V side[2] = {hn::Add(w, p), hn::Sub(w, p)};
            for (std::size_t s = 0; s < 2; ++s) {
                L::store(side[s], b + s * kLanes, i);
                if constexpr (kSecond)
                    second[s][i] = L::greater(L::less(side[s], greatest[s][i]), second[s][i]);
                greatest[s][i] = hn::Max(side[s], greatest[s][i]);
            }
            if constexpr (!kSecond) {
                position[i] = L::fma(r, p, position[i]);
                radius[i] = L::fma(r, w, radius[i]);
            }
        }
    }
    for (std::size_t i = 0; i < L::vectors; ++i) {
        const V sum_r = L::all(bv.sum_r > 0 ? bv.sum_r : 1);
        for (std::size_t s = 0; s < 2; ++s) {
            L::store(greatest[s][i], out.greatest[s], i);
            L::store(bv.count > 1 ? second[s][i] : greatest[s][i], out.second[s], i);
            const V sum = s == 0 ? hn::Add(radius[i], position[i]) : hn::Sub(radius[i], position[i]);
            L::store(bv.sum_r > 0 ? hn::Div(sum, sum_r) : greatest[s][i], out.mean[s], i);
        }
    }
}

/// D(λ) for every lane: Σ l (b − λ), Σ r max(b − λ, 0) and Σ r over b > λ.
template <class T, std::size_t kLanes> struct Dual {
    alignas(64) T lower[2][kLanes], upper[2][kLanes], mass[2][kLanes];
};

template <class T, std::size_t kLanes, bool kMass>
void dual(const PackedBv<T>& bv, const T* record, std::size_t size, const T* b, const T (&lambda)[2][kLanes], Dual<T, kLanes>& out)
{
    using L = Lanes<T, kLanes>;
    using V = typename L::V;
    V at[2][L::vectors], lower[2][L::vectors], upper[2][L::vectors], mass[2][L::vectors];
    for (std::size_t s = 0; s < 2; ++s)
        for (std::size_t i = 0; i < L::vectors; ++i) {
            at[s][i] = L::load(lambda[s], i);
            lower[s][i] = upper[s][i] = mass[s][i] = L::all(0);
        }
    for (std::size_t j = 0; j < bv.count; ++j, record += size, b += 2 * kLanes) {
        const V l = L::all(record[0]), r = L::all(record[1]);
        for (std::size_t s = 0; s < 2; ++s)
            for (std::size_t i = 0; i < L::vectors; ++i) {
                const V above = hn::Sub(L::load(b + s * kLanes, i), at[s][i]);
                lower[s][i] = L::fma(l, above, lower[s][i]);
                upper[s][i] = L::fma(r, hn::Max(above, L::all(0)), upper[s][i]);
                if constexpr (kMass)
                    mass[s][i] = hn::Add(mass[s][i], hn::IfThenElseZero(hn::Gt(above, L::all(0)), r));
            }
    }
    for (std::size_t s = 0; s < 2; ++s)
        for (std::size_t i = 0; i < L::vectors; ++i) {
            L::store(lower[s][i], out.lower[s], i);
            L::store(upper[s][i], out.upper[s], i);
            L::store(mass[s][i], out.mass[s], i);
        }
}

/// The double of D(λ), or an upper bound of it: see dual_sum_error() in rounding.hpp. Lowers `bound` to it where it is less, and
/// notes λ.
template <class T, std::size_t kLanes>
void intersect(const PackedBv<T>& bv, const Extrema<T, kLanes>& e, const T (&lambda)[2][kLanes], const Dual<T, kLanes>& d, Rounding rounding,
               T (&bound)[2][kLanes], T (&used)[2][kLanes])
{
    using L = Lanes<T, kLanes>;
    using V = typename L::V;
    const V factor = L::all(dual_sum_factor<T>(bv.count)), underflow = L::all(dual_sum_underflow<T>(bv.count));
    for (std::size_t s = 0; s < 2; ++s)
        for (std::size_t i = 0; i < L::vectors; ++i) {
            const V at = L::load(lambda[s], i), upper = L::load(d.upper[s], i), sum = hn::Add(L::load(d.lower[s], i), upper);
            V value = hn::Add(at, sum);
            if (rounding == Rounding::proven) {
                const V width = L::greater(hn::Sub(L::load(e.greatest[s], i), at), hn::Add(at, L::load(e.greatest[1 - s], i)));
                const V error = L::up(L::fma(factor, hn::Add(width, upper), underflow));
                value = L::up(hn::Add(at, L::up(hn::Add(sum, error))));
            }
            const V old = L::load(bound[s], i);
            const auto less = hn::Lt(value, old); // false for NaN
            L::store(hn::IfThenElse(less, value, old), bound[s], i);
            L::store(hn::IfThenElse(less, at, L::load(used[s], i)), used[s], i);
        }
}

/// Tangents of the convex D on either side of its minimum. At first those at λ = ∓∞, written at the first λ.
template <class T, std::size_t kLanes> struct Bracket {
    alignas(64) T at[2][2][kLanes], value[2][2][kLanes], slope[2][2][kLanes]; // [end: 0 falling, 1 rising][side][lane]
};

/// Takes in the tangent at λ and moves λ to the crossing of the bracket's two tangents; λ stays where that is no number.
template <class T, std::size_t kLanes>
void step(const PackedBv<T>& bv, const Extrema<T, kLanes>& e, const Dual<T, kLanes>& d, bool first, Bracket<T, kLanes>& bracket, T (&lambda)[2][kLanes])
{
    for (std::size_t s = 0; s < 2; ++s)
        for (std::size_t i = 0; i < kLanes; ++i) {
            const T at = lambda[s][i], flat = 1 - bv.sum_l, value = at + d.lower[s][i] + d.upper[s][i], slope = flat - d.mass[s][i];
            T(&ends)[2][2][kLanes] = bracket.at;
            if (first) {
                ends[0][s][i] = ends[1][s][i] = at;
                bracket.value[0][s][i] = at + d.lower[s][i] + bv.sum_r * (e.mean[s][i] - at);
                bracket.slope[0][s][i] = flat - bv.sum_r;
                bracket.value[1][s][i] = at + d.lower[s][i];
                bracket.slope[1][s][i] = flat;
            }
            const std::size_t end = slope < 0 ? 0 : 1;
            ends[end][s][i] = at;
            bracket.value[end][s][i] = value;
            bracket.slope[end][s][i] = slope;
            const T across = ends[1][s][i] - ends[0][s][i];
            const T drop = bracket.value[1][s][i] - bracket.value[0][s][i] - bracket.slope[1][s][i] * across;
            const T next = ends[0][s][i] + drop / (bracket.slope[0][s][i] - bracket.slope[1][s][i]);
            if (next - next == 0) // finite
                lambda[s][i] = next;
        }
}

template <class T, std::size_t kLanes>
void select_best(const PackedBv<T>& bv, const T* record, std::size_t size, const T* b, std::vector<std::pair<T, T>>& scratch, T (&lambda)[2][kLanes])
{
    for (std::size_t s = 0; s < 2; ++s)
        for (std::size_t i = 0; i < kLanes; ++i) {
            scratch.clear();
            for (std::size_t j = 0; j < bv.count; ++j)
                scratch.emplace_back(b[(2 * j + s) * kLanes + i], record[j * size + 1]);
            lambda[s][i] = best_lambda<T>(scratch, 1 - bv.sum_l);
        }
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
