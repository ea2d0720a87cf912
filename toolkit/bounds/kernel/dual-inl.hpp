// SPDX-License-Identifier: Apache-2.0
// No #pragma once: compiled anew for every target.
#if defined(CINCH_DUAL_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CINCH_DUAL_INL
#undef CINCH_DUAL_INL
#else
#define CINCH_DUAL_INL
#endif

#include "toolkit/bounds/kernel/guard-inl.hpp"
#include "toolkit/bounds/kernel/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {

/// Which boxes the extrema are over: the BV's, its oriented one, or each node's cut by its ball.
enum class Boxes { common, oriented, local };

/// b̂_j of every simulation node along and against the axes, into b: per block and axis 8 along, then 8 against it.
/// kSecond asks for the two greatest, otherwise it is the greatest and the mean weighted by r. `floors`, of the kind
/// local with a guard, are raised.
template <class T, std::size_t kAxes, Boxes kBoxes, bool kSecond>
void extrema(const PackedBv<T>& bv, const ProjectedMaps<T>& maps, const std::uint32_t* node, const T* block, T* b,
             Extrema<T, kAxes>& out, T& error, [[maybe_unused]] LaneFloors<T, kAxes>* floors = nullptr)
{
    constexpr bool kCommon = kBoxes != Boxes::local;
    constexpr std::size_t rows = PackedBv<T>::rows(kCommon ? Method::limited : Method::local);
    Lanes<T> most = Lanes<T>::all(0);
    TwoGreatest<T, kAxes> two;               // the greatest alone, and
    Lanes<T> position[kAxes], radius[kAxes]; // Σ r p and Σ r w, unless it is kSecond
    std::fill_n(position, kAxes, Lanes<T>::all(0));
    std::fill_n(radius, kAxes, Lanes<T>::all(0));
    const auto repeated = repeated_lanes(bv);
    const std::size_t passed_over =
        blocks_of(bv.count) < 16 ? 0 : 3; // of every 4 blocks, by the mean, which need not be exact
    Lanes<T> ranges = Lanes<T>::all(0);
    for (std::size_t i = 0; i < blocks_of(bv.count); ++i, node += block_lanes, block += rows * block_lanes) {
        auto row = [&](std::size_t n) CINCH_FLATTEN { return Lanes<T>::load(block + n * block_lanes); };
        Lanes<T> c[3], e[3];
        for (std::size_t s = 0; s < 3; ++s) {
            c[s] = kCommon ? Lanes<T>::all(bv.centre[s]) : row(2 + s);
            e[s] = kCommon ? Lanes<T>::all(bv.half[s]) : row(5 + s);
        }
        if (!kSecond && (i & passed_over) == 0)
            ranges = ranges + row(1);
        if constexpr (kBoxes == Boxes::local)
            if (floors && i + 1 == blocks_of(bv.count))
                floors->raise(two.first);
        auto take = [&](std::size_t a, const Lanes<T>(&q)[4], const Lanes<T>* norm) CINCH_FLATTEN {
            const auto p = fma(q[0], c[0], fma(q[1], c[1], fma(q[2], c[2], q[3])));
            auto w = fma(magnitude(q[0]), e[0], fma(magnitude(q[1]), e[1], magnitude(q[2]) * e[2]));
            if constexpr (kBoxes == Boxes::oriented) {
                auto along = [&](const T(&axis)[3]) CINCH_FLATTEN {
                    return magnitude(fma(q[0], Lanes<T>::all(axis[0]),
                                         fma(q[1], Lanes<T>::all(axis[1]), q[2] * Lanes<T>::all(axis[2]))));
                };
                w = (along(bv.axis[0]) + along(bv.axis[1])) + along(bv.axis[2]);
            }
            if constexpr (kBoxes == Boxes::local)
                w = less(w, norm[a] * row(8));
            const Lanes<T> side[2] = {w + p, w - p};
            for (std::size_t s = 0; s < 2; ++s, b += block_lanes) {
                side[s].store(b);
                if constexpr (kSecond)
                    two.take(s, a, i + 1 < blocks_of(bv.count) ? side[s] : side[s] + repeated);
                else
                    two.first[s][a] = greater(side[s], two.first[s][a]);
            }
            if (!kSecond && (i & passed_over) == 0) {
                position[a] = fma(row(1), p, position[a]);
                radius[a] = fma(row(1), w, radius[a]);
            }
        };
        Lanes<T> q[4];
        with_maps<kAxes>(maps, node, [&](const auto& map) CINCH_FLATTEN {
            most = greater(map.errors(), most);
            Lanes<T> norm[kBoxes == Boxes::local ? kAxes / 4 * 4 + 4 : 1];
            if constexpr (kBoxes == Boxes::local)
                for (std::size_t a = 0; a <= kAxes; a += 4)
                    map.rows(4 * kAxes + a, norm + a);
#pragma GCC unroll 3
            for (std::size_t a = 0; a < kAxes; ++a) {
                map.rows(4 * a, q);
                take(a, q, norm);
            }
        });
    }
    error = greatest(most);
    greatest(two.first, out.greatest);
    if constexpr (kSecond) {
        two.second(bv.count, out.second);
    } else {
        Lanes<T> sums[2][kAxes];
        std::copy_n(position, kAxes, sums[0]);
        std::copy_n(radius, kAxes, sums[1]);
        PerSide<T, kAxes> both; // position and radius
        sum(sums, both);
        const T range = sum(ranges);
        PerSide<T, kAxes> sign;
        std::fill_n(sign[0], sign.room, T(1));
        std::fill_n(sign[1], sign.room, T(-1));
        for (std::size_t i = 0; i < 2 * both.room; i += block_lanes) { // radius ± position
            const auto sides = lanes_of(both, i) + lanes_of(sign, i) * opposite_lanes(both, i);
            (range > 0 ? sides / Lanes<T>::all(range) : lanes_of(out.greatest, i)).store(out.mean.value + i);
        }
    }
}

/// D(λ) in parts, with kMass Σ r over b > λ too.
template <class T, std::size_t kAxes, bool kMass, bool kLower>
void dual(const PackedBv<T>& bv, const T* block, std::size_t rows, const T* b, const PerSide<T, kAxes>& lambda,
          Dual<T, kAxes>& out)
{
    Lanes<T> lower[2][kAxes], upper[2][kAxes], mass[2][kAxes];
    for (std::size_t s = 0; s < 2; ++s)
        for (std::size_t a = 0; a < kAxes; ++a)
            lower[s][a] = upper[s][a] = mass[s][a] = Lanes<T>::all(0);
    for (std::size_t i = 0; i < blocks_of(bv.count); ++i, block += rows * block_lanes) {
        const auto l = Lanes<T>::load(block), r = Lanes<T>::load(block + block_lanes);
#pragma GCC unroll 3
        for (std::size_t a = 0; a < kAxes; ++a)
#pragma GCC unroll 2
            for (std::size_t s = 0; s < 2; ++s, b += block_lanes) {
                const auto above = Lanes<T>::load(b) - Lanes<T>::all(lambda[s][a]);
                if constexpr (kLower)
                    lower[s][a] = fma(l, above, lower[s][a]);
                upper[s][a] = fma(r, greater(above, Lanes<T>::all(0)), upper[s][a]);
                if constexpr (kMass)
                    mass[s][a] = mass[s][a] + where_positive(above, r);
            }
    }
    sum(upper, out.upper);
    if constexpr (kLower)
        sum(lower, out.lower);
    else
        fill(out.lower, T(0));
    if constexpr (kMass)
        sum(mass, out.mass);
}

template <class T, std::size_t kAxes, bool kMass> void dual(const PackedBv<T>& bv, const T* block, std::size_t rows,
                                                            const T* b, const PerSide<T, kAxes>& lambda,
                                                            Dual<T, kAxes>& out)
{
    if (bv.sum_l > 0)
        dual<T, kAxes, kMass, true>(bv, block, rows, b, lambda, out);
    else
        dual<T, kAxes, kMass, false>(bv, block, rows, b, lambda, out);
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
