// SPDX-License-Identifier: Apache-2.0
// No #pragma once: compiled anew for every target.
#if defined(CINCH_LINEAR_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CINCH_LINEAR_INL
#undef CINCH_LINEAR_INL
#else
#define CINCH_LINEAR_INL
#endif

#include "toolkit/bounds/kernel/rows-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {

/// The bound of an affine model of the weights. With w_j = m_j + g_j·y + ρ_j, y = x − z, z the pivot, and the mean map
/// q̄, θ̄:
///   γ·v = q̄·x + θ̄ + Σ_j (w_j − m_j)((q_j − q̄)·x + θ_j − θ̄)
///       = q̄·z + θ̄ + (q̄ + Σ_j P_j g_j)·y + Σ_j ρ_j P_j + Σ_j (w_j − m_j)(q_j − q̄)·y,   P_j = (q_j − q̄)·z + θ_j − θ̄,
/// so rest support of q̄ + Σ P_j g_j, then |ρ_j| ≤ residual_j and |(w_j − m_j) y| ≤ moment_j.
template <class T, std::size_t kAxes>
void linear(const PackedBv<T>& bv, const ProjectedMaps<T>& maps, const std::uint32_t* node, const T* point,
            const T* value, Rounding rounding, AxisMap<T, kAxes>& mean, Sides<T, kAxes>& bound, T& error)
{
    constexpr std::size_t stride = PackedBv<T>::values(Method::linear); // gradient (3), residual, moment (3), mean
    mean_map<T, kAxes>(bv, maps, node, value, stride, 7, mean, error);
    const auto z = each_row<T>(bv.pivot);
    for (std::size_t c = 0; c < row_chunks<kAxes>; ++c) {
        // Per row Σ P g, Σ |P| residual, and Σ |dq| moment; nodes alternately in two sums.
        Rows<T> direction[2] = {Rows<T>::all(0), Rows<T>::all(0)}, moment[2] = {direction[0], direction[0]};
        auto add = [&](std::size_t j, std::size_t to) HWY_ATTR {
            const auto d = Rows<T>::load(map_of<T, kAxes>(maps, node[j]) + 16 * c) - mean.chunk[c], p = row_sum(d * z);
            direction[to] = fma(with_fourth(p, magnitude(p)), each_row<T>(value + j * stride), direction[to]);
            moment[to] = fma(magnitude(d), each_row<T>(value + j * stride + 4), moment[to]);
        };
        std::size_t j = 0;
        for (; j + 1 < bv.count; j += 2) {
            add(j, 0);
            add(j + 1, 1);
        }
        if (j < bv.count)
            add(j, 0);
        const auto d = direction[0] + direction[1], m = moment[0] + moment[1];
        Rows<T>&along = bound.chunk[0][c], &against = bound.chunk[1][c];
        along = against = up(column<3>(d) + ((column<0>(m) + column<1>(m)) + column<2>(m)), rounding);
        add_rest_support(bv, point, mean.chunk[c], d + mean.chunk[c], rounding, along, against);
    }
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
