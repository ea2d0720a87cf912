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
template <class T, std::size_t kAxes>
void linear(const PackedBv<T>& bv, const ProjectedMaps<T>& maps, const std::uint32_t* node, const T* point, const T* block, Rounding rounding, T* transposed,
            AxisMap<T, kAxes>& mean, T (&bound)[2][kAxes], T& error)
{
    constexpr std::size_t rows = PackedBv<T>::rows(Method::linear);
    mean_map<T, kAxes>(bv, maps, node, block, rows, 0, transposed, mean, error);
    Lanes<T> direction[kAxes][3], residual[kAxes], moment[kAxes];
    for (std::size_t a = 0; a < kAxes; ++a)
        direction[a][0] = direction[a][1] = direction[a][2] = residual[a] = moment[a] = Lanes<T>::all(0);
    const auto z0 = Lanes<T>::all(bv.pivot[0]), z1 = Lanes<T>::all(bv.pivot[1]), z2 = Lanes<T>::all(bv.pivot[2]);
    for (std::size_t i = 0; i < blocks_of(bv.count); ++i, block += rows * block_lanes) {
        auto row = [&](std::size_t r) { return Lanes<T>::load(block + r * block_lanes); };
        for (std::size_t a = 0; a < kAxes; ++a, transposed += 4 * block_lanes) {
            Lanes<T> dq[4];
            for (std::size_t s = 0; s < 4; ++s)
                dq[s] = Lanes<T>::load(transposed + s * block_lanes) - Lanes<T>::all(mean.of[a][s]);
            const auto p = fma(dq[0], z0, fma(dq[1], z1, fma(dq[2], z2, dq[3])));
            for (std::size_t s = 0; s < 3; ++s) {
                direction[a][s] = fma(p, row(1 + s), direction[a][s]);
                moment[a] = fma(magnitude(dq[s]), row(5 + s), moment[a]);
            }
            residual[a] = fma(magnitude(p), row(4), residual[a]);
        }
    }
    AxisMap<T, kAxes> whole;
    for (std::size_t a = 0; a < kAxes; ++a) {
        for (std::size_t s = 0; s < 3; ++s)
            whole.of[a][s] = sum(direction[a][s]) + mean.of[a][s];
        const T rest = sum(residual[a]) + sum(moment[a]);
        bound[0][a] = bound[1][a] = rounding == Rounding::proven ? succ(rest) : rest;
    }
    add_rest_support<T, kAxes>(bv, point, mean, whole, rounding, bound);
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
