// SPDX-License-Identifier: Apache-2.0
// No #pragma once: compiled anew for every target.
#if defined(CINCH_LINEAR_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CINCH_LINEAR_INL
#undef CINCH_LINEAR_INL
#else
#define CINCH_LINEAR_INL
#endif

#include "toolkit/bounds/kernel/reference-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {

/// The bound of an affine model of the weights. With w_j = m_j + g_j·y + ρ_j, y = x − z, z the pivot, and the mean map q̄, θ̄:
///   γ·v = q̄·x + θ̄ + Σ_j (w_j − m_j)((q_j − q̄)·x + θ_j − θ̄)
///       = q̄·z + θ̄ + (q̄ + Σ_j P_j g_j)·y + Σ_j ρ_j P_j + Σ_j (w_j − m_j)(q_j − q̄)·y,   P_j = (q_j − q̄)·z + θ_j − θ̄,
/// so rest support of q̄ + Σ P_j g_j, then |ρ_j| ≤ residual_j and |(w_j − m_j) y| ≤ moment_j.
template <class T, std::size_t kLanes>
void linear(const PackedBv<T>& bv, const ProjectedMaps<T>& maps, const std::uint32_t* node, const T* point, const T* record, Rounding rounding,
            LaneMap<T, kLanes>& mean, T (&bound)[2][kLanes])
{
    using L = Lanes<T, kLanes>;
    using V = typename L::V;
    constexpr std::size_t size = PackedBv<T>::record(Method::linear);
    mean_map<T, kLanes>(maps, node, record, size, 0, bv.count, mean);
    V direction[3][L::vectors], residual[L::vectors], moment[L::vectors];
    for (std::size_t i = 0; i < L::vectors; ++i) {
        for (std::size_t s = 0; s < 3; ++s)
            direction[s][i] = L::all(0);
        residual[i] = moment[i] = L::all(0);
    }
    for (std::size_t j = 0; j < bv.count; ++j, record += size) {
        const T* q = maps.of(node[j]);
        for (std::size_t i = 0; i < L::vectors; ++i) {
            V dq[4];
            for (std::size_t s = 0; s < 4; ++s)
                dq[s] = hn::Sub(L::load(q + s * kLanes, i), L::load(mean.row[s], i));
            const V p = L::fma(dq[0], L::all(bv.pivot[0]), L::fma(dq[1], L::all(bv.pivot[1]), L::fma(dq[2], L::all(bv.pivot[2]), dq[3])));
            for (std::size_t s = 0; s < 3; ++s) {
                direction[s][i] = L::fma(p, L::all(record[1 + s]), direction[s][i]);
                moment[i] = L::fma(hn::Abs(dq[s]), L::all(record[5 + s]), moment[i]);
            }
            residual[i] = L::fma(hn::Abs(p), L::all(record[4]), residual[i]);
        }
    }
    LaneMap<T, kLanes> whole;
    for (std::size_t s = 0; s < 3; ++s)
        for (std::size_t i = 0; i < L::vectors; ++i)
            L::store(hn::Add(direction[s][i], L::load(mean.row[s], i)), whole.row[s], i);
    rest_support<T, kLanes>(bv, point, mean, whole, bound[0], bound[1]);
    for (std::size_t s = 0; s < 2; ++s)
        for (std::size_t i = 0; i < L::vectors; ++i) {
            const V support = L::load(bound[s], i);
            L::store(rounding == Rounding::proven ? L::up(hn::Add(support, L::up(hn::Add(residual[i], moment[i])))) : hn::Add(support, hn::Add(residual[i], moment[i])),
                     bound[s], i);
        }
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
