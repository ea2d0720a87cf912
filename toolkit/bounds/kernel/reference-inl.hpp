// SPDX-License-Identifier: Apache-2.0
// No #pragma once: compiled anew for every target.
#if defined(CINCH_REFERENCE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CINCH_REFERENCE_INL
#undef CINCH_REFERENCE_INL
#else
#define CINCH_REFERENCE_INL
#endif

#include "toolkit/bounds/kernel/lanes-inl.hpp"
#include "toolkit/bounds/packed_bv.hpp"
#include "toolkit/bounds/projected_maps.hpp"

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {

/// A map along every axis: q_s in rows 0 to 2, θ in row 3.
template <class T, std::size_t kLanes> struct LaneMap {
    alignas(64) T row[4][kLanes];
};

/// Σ_j m_j (q_j, θ_j), m_j at place `mean` of the j-th record.
template <class T, std::size_t kLanes>
void mean_map(const ProjectedMaps<T>& maps, const std::uint32_t* node, const T* record, std::size_t record_size, std::size_t mean,
              std::size_t count, LaneMap<T, kLanes>& out)
{
    using L = Lanes<T, kLanes>;
    typename L::V sum[4][L::vectors];
    for (auto& row : sum)
        for (auto& v : row)
            v = L::all(0);
    for (std::size_t j = 0; j < count; ++j) {
        const T* q = maps.of(node[j]);
        const auto m = L::all(record[j * record_size + mean]);
        for (std::size_t s = 0; s < 4; ++s)
            for (std::size_t i = 0; i < L::vectors; ++i)
                sum[s][i] = L::fma(m, L::load(q + s * kLanes, i), sum[s][i]);
    }
    for (std::size_t s = 0; s < 4; ++s)
        for (std::size_t i = 0; i < L::vectors; ++i)
            L::store(sum[s][i], out.row[s], i);
}

/// Upper bounds of ±(q·x + θ) over pivot + hull of the points ± slack, for direction q of `direction` and base map q̄, θ̄ of `base`:
/// ±(q̄·pivot + θ̄) + max ±q·y + slack·‖q‖.
template <class T, std::size_t kLanes>
void rest_support(const PackedBv<T>& bv, const T* point, const LaneMap<T, kLanes>& base, const LaneMap<T, kLanes>& direction, T (&plus)[kLanes], T (&minus)[kLanes])
{
    using L = Lanes<T, kLanes>;
    for (std::size_t i = 0; i < L::vectors; ++i) {
        const auto q0 = L::load(direction.row[0], i), q1 = L::load(direction.row[1], i), q2 = L::load(direction.row[2], i);
        auto most = L::all(-std::numeric_limits<T>::infinity()), least = L::all(std::numeric_limits<T>::infinity());
        for (std::size_t p = 0; p < bv.points; ++p) {
            const T* y = point + 3 * p;
            const auto along = L::fma(q0, L::all(y[0]), L::fma(q1, L::all(y[1]), hn::Mul(q2, L::all(y[2]))));
            most = L::greater(along, most);
            least = L::less(along, least);
        }
        const auto slack = hn::Mul(hn::Sqrt(L::fma(q0, q0, L::fma(q1, q1, hn::Mul(q2, q2)))), L::all(bv.slack));
        const auto at_pivot = L::fma(L::load(base.row[0], i), L::all(bv.pivot[0]),
                                     L::fma(L::load(base.row[1], i), L::all(bv.pivot[1]), L::fma(L::load(base.row[2], i), L::all(bv.pivot[2]), L::load(base.row[3], i))));
        L::store(L::up(hn::Add(L::up(hn::Add(most, slack)), at_pivot)), plus, i);
        L::store(L::up(hn::Sub(L::up(hn::Sub(slack, least)), at_pivot)), minus, i);
    }
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
