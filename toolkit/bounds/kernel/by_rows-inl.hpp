// SPDX-License-Identifier: Apache-2.0
// No #pragma once: compiled anew for every target.
#if defined(CINCH_BY_ROWS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CINCH_BY_ROWS_INL
#undef CINCH_BY_ROWS_INL
#else
#define CINCH_BY_ROWS_INL
#endif

#include "toolkit/bounds/kernel/guard-inl.hpp"
#include "toolkit/bounds/kernel/linear-inl.hpp"
#include "toolkit/bounds/kernel/moments-inl.hpp"
#include "toolkit/bounds/kernel/search-inl.hpp"
#include "toolkit/bounds/kernel/support-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {

/// The kinds for few.
template <class T, std::size_t kAxes> void bound_by_rows(const KernelInput<T>& in, const PackedBv<T>& bv, T* remembered,
                                                         KernelScratch<T>& scratch, Bound<T, kAxes>& out)
{
    constexpr std::size_t chunks = row_chunks<kAxes>;
    const std::uint32_t* node = in.node.data() + bv.first_node;
    const T* point = in.value.data() + bv.first_value;
    const T* value = point + bv.values_before();
    AxisMap<T, kAxes> reference;
    Sides<T, kAxes> bound;
    if (bv.kind == Method::linear) {
        linear<T, kAxes>(bv, *in.maps, node, point, value, in.rounding, reference, bound, out.error);
    } else {
        if (scratch.b.size() < 16 * chunks * bv.count)
            scratch.b.resize(16 * chunks * bv.count);
        T* b = scratch.b.data();
        const bool moments = bv.kind == Method::moments;
        const std::size_t stride = PackedBv<T>::values(bv.kind);
        mean_map<T, kAxes>(bv, *in.maps, node, value, stride, moments ? moment_mean : support_mean, reference,
                           out.error);
        RowExtrema<T, kAxes> e;
        MomentNumbers<T> numbers[chunks];
        const T* head = value - moment_head;
        if (moments)
            for (std::size_t c = 0; c < chunks; ++c) {
                numbers[c] = moment_numbers<T, kAxes>(bv, *in.maps, node, head, value, reference.chunk[c], c);
                moment_extrema<T, kAxes>(bv, *in.maps, node, head, value, reference.chunk[c], numbers[c], c,
                                         b + 16 * c * bv.count, e);
            }
        else
            support_extrema<T, kAxes>(bv, *in.maps, node, value, reference, b, e);
        const RowInterval<T> interval{value + (moments ? moment_l : support_l),
                                      value + (moments ? moment_r : support_r), stride};
        if (in.passes == 1 && !remembered) {
            support_in_one_pass<T, kAxes>(bv, interval, b, e, in.rounding, bound);
        } else {
            Extrema<T, kAxes> own;
            to_array<T, kAxes>(e.greatest, own.greatest);
            to_array<T, kAxes>(e.mean, own.mean);
            begin<T, kAxes>(own, out);
            search<T, kAxes>(in, bv, own, remembered, out,
                             [&]<bool kMass>(const PerSide<T, kAxes>& at, Dual<T, kAxes>& d) {
                                 SidesInRows<T, kAxes> lambda;
                                 from_array<T, kAxes>(at, lambda);
                                 RowDual<T, kAxes> parts;
                                 support_dual<T, kAxes, kMass>(bv, interval, b, lambda, parts);
                                 to_array<T, kAxes>(parts.lower, d.lower);
                                 to_array<T, kAxes>(parts.upper, d.upper);
                                 if constexpr (kMass)
                                     to_array<T, kAxes>(parts.mass, d.mass);
                             });
            for (std::size_t s = 0; s < 2; ++s)
                for (std::size_t c = 0; c < chunks; ++c)
                    bound.chunk[s][c] = each_row<T>(out.value[s] + 4 * c);
        }
        for (std::size_t c = 0; c < chunks; ++c)
            if (!moments)
                add_rest_support(bv, point, reference.chunk[c], reference.chunk[c], in.rounding, bound.chunk[0][c],
                                 bound.chunk[1][c]);
            else if (numbers[c].bounded)
                add_lifted_support(bv, point, head, reference.chunk[c], numbers[c], in.rounding, bound.chunk[0][c],
                                   bound.chunk[1][c]);
            else
                bound.chunk[0][c] = bound.chunk[1][c] = Rows<T>::all(infinity_of<T>);
    }
    store<T, kAxes>(bound, out.value);
    if (bv.guard) {
        Sides<T, kAxes> floor;
        floor_of_mean<T, kAxes>(bv, reference, floor);
        store<T, kAxes>(floor, out.floor);
    }
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
