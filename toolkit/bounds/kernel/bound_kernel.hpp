// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "toolkit/bounds/packed_bv.hpp"
#include "toolkit/bounds/projected_maps.hpp"
#include "toolkit/deform/aligned.hpp"

namespace cinch {

/// What a call of the kernels reads; views, owning nothing.
template <class T> struct KernelInput {
    std::span<const PackedBv<T>> bvs;
    std::span<const std::uint32_t> node;
    std::span<const T> value;
    const ProjectedMaps<T>* maps;
    Rounding rounding = Rounding::proven;
    int passes = 1;                       ///< evaluations of D for local and support; 0 leaves them at the greatest b
    const std::uint32_t* place = nullptr; ///< for lists: where in bvs each BV stands; null: where it is in the tree
    T* remembered = nullptr; ///< k pairs per entry of bvs, NaN at first: where λ begins instead, and its step
                             ///< (choose_lambda.hpp); or null
};

/// Reused from call to call, so that bounding allocates nothing once warm.
template <class T> struct KernelScratch {
    AlignedVector<T> b;
    std::vector<std::pair<T, T>> select;
};

/// Bounds BVs [first, last): supports[(bv − first)·k + d], d as in axes_of(k). With Rounding::proven each is an upper
/// bound for every exactly deformed and every computed vertex. Whatever is not finite gives +∞. The arithmetic is IEEE
/// with every operation and its order fixed: fused multiply-adds included. The same bits on every target. A bound with
/// a guard exceeds the guard's, which is an Eq. 12, by 1 % of its width at most.
template <class T> void bound_packed(const KernelInput<T>& input, std::size_t first, std::size_t last,
                                     KernelScratch<T>& scratch, std::span<double> supports);

/// Bounds the BVs listed, writing to each the k supports at dops + bv·2·side, `side` floats apart along and against the
/// axes: floats relative to maps->origin, rounded up. Whatever is not finite gives +∞. Guards are not asked.
template <class T> void bound_packed(const KernelInput<T>& input, std::span<const std::uint32_t> list,
                                     KernelScratch<T>& scratch, std::size_t side, float* dops);

} // namespace cinch
