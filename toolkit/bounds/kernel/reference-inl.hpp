// SPDX-License-Identifier: Apache-2.0
// No #pragma once: compiled anew for every target.
#if defined(CINCH_REFERENCE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CINCH_REFERENCE_INL
#undef CINCH_REFERENCE_INL
#else
#define CINCH_REFERENCE_INL
#endif

#include "toolkit/bounds/kernel/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {

/// A map along every axis: q in places 0 to 2, θ in place 3.
template <class T, std::size_t kAxes> struct AxisMap {
    T of[kAxes][4];
};

/// Σ_j m_j (q_j, θ_j), m in row `mean_row` of a block of `rows` rows. Leaves all q and θ in `transposed`, per block and axis 4 rows of 8, and
/// the nodes' greatest error in `error`.
template <class T, std::size_t kAxes>
void mean_map(const PackedBv<T>& bv, const ProjectedMaps<T>& maps, const std::uint32_t* node, const T* block, std::size_t rows, std::size_t mean_row,
              T* transposed, AxisMap<T, kAxes>& out, T& error)
{
    Lanes<T> total[kAxes][4], most = Lanes<T>::all(0);
    for (auto& axis : total)
        for (auto& x : axis)
            x = Lanes<T>::all(0);
    for (std::size_t i = 0; i < blocks_of(bv.count); ++i, node += block_lanes, block += rows * block_lanes) {
        const auto m = Lanes<T>::load(block + mean_row * block_lanes);
        with_maps<kAxes>(maps, node, [&](const auto& map) CINCH_FLATTEN {
            most = greater(map.errors(), most);
#pragma GCC unroll 3
            for (std::size_t a = 0; a < kAxes; ++a) {
                Lanes<T> q[4];
                map.rows(4 * a, q);
                for (std::size_t s = 0; s < 4; ++s, transposed += block_lanes) {
                    q[s].store(transposed);
                    total[a][s] = fma(m, q[s], total[a][s]);
                }
            }
        });
    }
    for (std::size_t a = 0; a < kAxes; ++a)
        for (std::size_t s = 0; s < 4; ++s)
            out.of[a][s] = sum(total[a][s]);
    error = greatest(most);
}

/// Adds to `value`, along and against each axis, max q·(x − pivot) over the rest vertices x, q of `direction`, and q̄·pivot + θ̄ of
/// `base`: the points' greatest q·y + slack·‖q‖.
template <class T, std::size_t kAxes>
void add_rest_support(const PackedBv<T>& bv, const T* point, const AxisMap<T, kAxes>& base, const AxisMap<T, kAxes>& direction, Rounding rounding,
                      T (&value)[2][kAxes])
{
    for (std::size_t a = 0; a < kAxes; ++a) {
        const T(&q)[4] = direction.of[a];
        const auto q0 = Lanes<T>::all(q[0]), q1 = Lanes<T>::all(q[1]), q2 = Lanes<T>::all(q[2]);
        auto most = Lanes<T>::all(-infinity_of<T>), least_negated = most;
        for (std::size_t i = 0; i < blocks_of(bv.points); ++i) {
            const T* y = point + 3 * block_lanes * i;
            const auto along = fma(q0, Lanes<T>::load(y), fma(q1, Lanes<T>::load(y + block_lanes), q2 * Lanes<T>::load(y + 2 * block_lanes)));
            most = greater(along, most);
            least_negated = greater(Lanes<T>::all(0) - along, least_negated);
        }
        // ‖q‖, scaled so that no square vanishes or overflows.
        const T most_q = std::max(std::max(std::abs(q[0]), std::abs(q[1])), std::abs(q[2])), unit = most_q > 0 ? most_q : T(1);
        const T x = q[0] / unit, y1 = q[1] / unit, z = q[2] / unit;
        const T slack = (most_q * std::sqrt(std::fma(x, x, std::fma(y1, y1, z * z)))) * bv.slack;
        const T(&b)[4] = base.of[a];
        const T at_pivot = std::fma(b[0], bv.pivot[0], std::fma(b[1], bv.pivot[1], std::fma(b[2], bv.pivot[2], b[3])));
        const T height[2] = {greatest(most), greatest(least_negated)}, position[2] = {at_pivot, -at_pivot};
        for (std::size_t s = 0; s < 2; ++s) {
            if (rounding == Rounding::proven)
                value[s][a] = succ(value[s][a] + succ(succ(height[s] + slack) + position[s]));
            else
                value[s][a] += (height[s] + slack) + position[s];
        }
    }
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
