// SPDX-License-Identifier: Apache-2.0
// No #pragma once: compiled anew for every target.
#if defined(CINCH_BY_BLOCKS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CINCH_BY_BLOCKS_INL
#undef CINCH_BY_BLOCKS_INL
#else
#define CINCH_BY_BLOCKS_INL
#endif

#include <optional>

#include "toolkit/bounds/kernel/dual-inl.hpp"
#include "toolkit/bounds/kernel/guard-inl.hpp"
#include "toolkit/bounds/kernel/search-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {

/// The kind local: D at λ near the best one, and with a guard at the second-greatest b too, unless the bound is close
/// to Eq. 12 or below it (guard-inl.hpp).
template <class T, std::size_t kAxes> void local(const KernelInput<T>& in, const PackedBv<T>& bv,
                                                 const std::uint32_t* node, const T* block, T* b, T* remembered,
                                                 Bound<T, kAxes>& out)
{
    constexpr std::size_t rows = PackedBv<T>::rows(Method::local);
    Extrema<T, kAxes> e;
    std::optional<LaneFloors<T, kAxes>> floors;
    if (bv.guarded)
        floors.emplace(bv, *in.maps, node);
    extrema<T, kAxes, Boxes::local, false>(bv, *in.maps, node, block, b, e, out.error, floors ? &*floors : nullptr);
    begin<T, kAxes>(e, out);
    search<T, kAxes>(in, bv, e, remembered, out, [&]<bool kMass>(const PerSide<T, kAxes>& at, Dual<T, kAxes>& d) {
        dual<T, kAxes, kMass>(bv, block, rows, b, at, d);
    });
    if (!floors)
        return;
    floors->second(out.floor);
    if (bv.sum_l == 0 && is_close<T, kAxes>(in, bv, out))
        return;
    PerSide<T, kAxes> lambda;
    Dual<T, kAxes> d;
    second_greatest<T, kAxes>(bv, b, lambda);
    dual<T, kAxes, false>(bv, block, rows, b, lambda, d);
    intersect<T, kAxes>(in, bv, e, lambda, d, out);
}

/// The kinds for many simulation nodes: λ where the kind says, D there, and every such value intersected with the
/// greatest b.
template <class T, std::size_t kAxes> void bound_by_blocks(const KernelInput<T>& in, const PackedBv<T>& bv,
                                                           T* remembered, KernelScratch<T>& scratch,
                                                           Bound<T, kAxes>& out)
{
    const std::uint32_t* node = in.node.data() + bv.first_node;
    const T* block = in.value.data() + bv.first_value;
    const std::size_t rows = PackedBv<T>::rows(bv.kind), extent = 2 * kAxes * block_lanes * blocks_of(bv.count);
    if (scratch.b.size() < extent)
        scratch.b.resize(extent);
    T* b = scratch.b.data();

    Extrema<T, kAxes> e;
    if (bv.kind == Method::local)
        return local<T, kAxes>(in, bv, node, block, b, remembered, out);
    if (bv.oriented)
        extrema<T, kAxes, Boxes::oriented, true>(bv, *in.maps, node, block, b, e, out.error);
    else
        extrema<T, kAxes, Boxes::common, true>(bv, *in.maps, node, block, b, e, out.error);
    begin<T, kAxes>(e, out);

    Dual<T, kAxes> d;
    if (bv.kind == Method::eq12 || bv.kind == Method::limited) {
        dual<T, kAxes, false>(bv, block, rows, b, e.second, d);
        intersect<T, kAxes>(in, bv, e, e.second, d, out);
    }
    if (bv.kind == Method::limited) {
        PerSide<T, kAxes> lambda;
        select_best<T, kAxes>(bv, block, b, scratch.select, lambda);
        dual<T, kAxes, false>(bv, block, rows, b, lambda, d);
        intersect<T, kAxes>(in, bv, e, lambda, d, out);
    }
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
