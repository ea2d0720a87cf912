// SPDX-License-Identifier: Apache-2.0
#include "toolkit/bounds/kernel/bound_kernel.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "toolkit/bounds/directions.hpp"
#include "toolkit/bounds/rounding.hpp"

// Targets without fused multiply-add would have to emulate it at great cost; what is left is AVX2 and up, NEON, and portable
// code. Targets with vectors of unknown length cannot hold them in arrays.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "toolkit/bounds/kernel/bound_kernel.cpp"
#include <hwy/foreach_target.h>

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include "toolkit/bounds/kernel/dual-inl.hpp"
#include "toolkit/bounds/kernel/linear-inl.hpp"
#include "toolkit/bounds/kernel/search-inl.hpp"
#include "toolkit/bounds/kernel/support-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {

// The kinds for many simulation nodes: λ where the kind says, D there, and every such value intersected with the greatest b.
template <class T, std::size_t kAxes>
void bound_by_blocks(const KernelInput<T>& in, const PackedBv<T>& bv, T* remembered, KernelScratch<T>& scratch, Bound<T, kAxes>& out)
{
    const std::uint32_t* node = in.node.data() + bv.first_node;
    const T* block = in.value.data() + bv.first_value;
    const std::size_t rows = PackedBv<T>::rows(bv.kind), extent = 2 * kAxes * block_lanes * blocks_of(bv.count);
    if (scratch.b.size() < extent)
        scratch.b.resize(extent);
    T* b = scratch.b.data();

    Extrema<T, kAxes> e;
    if (bv.kind == Method::local)
        extrema<T, kAxes, Boxes::local, false>(bv, *in.maps, node, block, b, e, out.error);
    else if (bv.oriented)
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
    if (bv.kind == Method::local)
        search<T, kAxes>(in, bv, e, remembered, out, [&]<bool kMass>(const PerSide<T, kAxes>& at, Dual<T, kAxes>& own) {
            dual<T, kAxes, kMass>(bv, block, rows, b, at, own);
        });
}

// The kinds for few.
template <class T, std::size_t kAxes>
void bound_by_rows(const KernelInput<T>& in, const PackedBv<T>& bv, T* remembered, KernelScratch<T>& scratch, Bound<T, kAxes>& out)
{
    constexpr std::size_t chunks = row_chunks<kAxes>;
    const std::uint32_t* node = in.node.data() + bv.first_node;
    const T* point = in.value.data() + bv.first_value;
    const T* value = point + 12 * quads_of(bv.points);
    AxisMap<T, kAxes> reference;
    Sides<T, kAxes> bound;
    if (bv.kind == Method::linear) {
        linear<T, kAxes>(bv, *in.maps, node, point, value, in.rounding, reference, bound, out.error);
    } else {
        if (scratch.b.size() < 16 * chunks * bv.count)
            scratch.b.resize(16 * chunks * bv.count);
        T* b = scratch.b.data();
        mean_map<T, kAxes>(bv, *in.maps, node, value, PackedBv<T>::values(Method::support), support_mean, reference, out.error);
        RowExtrema<T, kAxes> e;
        support_extrema<T, kAxes>(bv, *in.maps, node, value, reference, b, e);
        if (in.passes == 1 && !remembered) {
            support_in_one_pass<T, kAxes>(bv, value, b, e, in.rounding, bound);
        } else {
            Extrema<T, kAxes> own;
            to_array<T, kAxes>(e.greatest, own.greatest);
            to_array<T, kAxes>(e.mean, own.mean);
            begin<T, kAxes>(own, out);
            search<T, kAxes>(in, bv, own, remembered, out, [&]<bool kMass>(const PerSide<T, kAxes>& at, Dual<T, kAxes>& d) {
                SidesInRows<T, kAxes> lambda;
                from_array<T, kAxes>(at, lambda);
                RowDual<T, kAxes> parts;
                support_dual<T, kAxes, kMass>(bv, value, b, lambda, parts);
                to_array<T, kAxes>(parts.lower, d.lower);
                to_array<T, kAxes>(parts.upper, d.upper);
                if constexpr (kMass)
                    to_array<T, kAxes>(parts.mass, d.mass);
            });
            for (std::size_t s = 0; s < 2; ++s)
                for (std::size_t c = 0; c < chunks; ++c)
                    bound.chunk[s][c] = Rows<T>::each_row(out.value[s] + 4 * c);
        }
        for (std::size_t c = 0; c < chunks; ++c)
            add_rest_support(bv, point, reference.chunk[c], reference.chunk[c], in.rounding, bound.chunk[0][c], bound.chunk[1][c]);
    }
    store<T, kAxes>(bound, out.value);
    if (bv.guard) {
        Sides<T, kAxes> floor;
        floor_of_mean<T, kAxes>(bv, reference, floor);
        store<T, kAxes>(floor, out.floor);
    }
}

// Supports about the body's origin, with the errors of the BV's nodes on top.
template <class T, std::size_t kAxes>
void finish(const KernelInput<T>& in, const PackedBv<T>& bv, const Bound<T, kAxes>& bound, double (&own)[2][kAxes])
{
    const double wider = widening<T, kAxes>(in, bv, bound);
    for (std::size_t s = 0; s < 2; ++s)
        for (std::size_t a = 0; a < kAxes; ++a) {
            const double sum = static_cast<double>(bound.value[s][a]) + wider, support = in.rounding == Rounding::proven ? succ(sum) : sum;
            own[s][a] = support < infinite ? support : infinite;
        }
}

// And in the world.
template <class T, std::size_t kAxes> void to_world(const KernelInput<T>& in, const double (&own)[2][kAxes], double* supports)
{
    const bool proven = in.rounding == Rounding::proven;
    const Vec3& origin = in.maps->origin;
    const bool at_home = origin[0] == 0 && origin[1] == 0 && origin[2] == 0;
    const auto axes = axes_of(in.maps->kdop);
    for (std::size_t a = 0; a < kAxes; ++a)
        for (std::size_t s = 0; s < 2; ++s) {
            double sum = own[s][a];
            for (std::size_t r = 0; r < 3 && !at_home; ++r)
                if (axes[a][r] != 0) {
                    sum += ((axes[a][r] > 0) == (s == 0) ? 1 : -1) * origin[static_cast<int>(r)];
                    sum = proven ? succ(sum) : sum;
                }
            supports[2 * a + s] = sum < infinite ? sum : infinite;
        }
}

// The same about the origin, as floats.
template <class T, std::size_t kAxes>
void finish(const KernelInput<T>& in, const PackedBv<T>& bv, const Bound<T, kAxes>& bound, std::size_t side, float* dop)
{
    const double wider = widening<T, kAxes>(in, bv, bound);
    if constexpr (sizeof(T) == 4) {
        const float by = succ(static_cast<float>(wider)); // fl(x) ≥ x(1 − u), and succ goes past x
        for (std::size_t s = 0; s < 2; ++s)
            for (std::size_t c = 0; c < row_chunks<kAxes>; ++c) {
                const auto sum = next(Rows<float>::load(bound.value[s] + 4 * c) + Rows<float>::all(by));
                HWY_ALIGN float own[16];
                lesser(sum, Rows<float>::all(infinity_of<float>)).store(own);
                for (std::size_t a = 4 * c; a < std::min(4 * c + 4, kAxes); ++a)
                    dop[s * side + a] = own[a % 4];
            }
    } else {
        for (std::size_t a = 0; a < kAxes; ++a)
            for (std::size_t s = 0; s < 2; ++s) {
                const float support = succ(static_cast<float>(succ(static_cast<double>(bound.value[s][a]) + wider)));
                dop[s * side + a] = support < infinity_of<float> ? support : infinity_of<float>;
            }
    }
}

template <class T, std::size_t kAxes>
void bound_one(const KernelInput<T>& in, std::size_t i, KernelScratch<T>& scratch, Bound<T, kAxes>& bound)
{
    const PackedBv<T>& bv = in.bvs[i];
    T* remembered = in.remembered ? in.remembered + i * 4 * kAxes : nullptr;
    if (takes_one_by_one(bv.kind))
        bound_by_rows<T, kAxes>(in, bv, remembered, scratch, bound);
    else
        bound_by_blocks<T, kAxes>(in, bv, remembered, scratch, bound);
}

template <class T, std::size_t kAxes>
void bound_range(const KernelInput<T>& in, std::size_t first, std::size_t last, KernelScratch<T>& scratch, double* supports)
{
    for (std::size_t i = first; i < last; ++i, supports += 2 * kAxes) {
        const PackedBv<T>& bv = in.bvs[i];
        Bound<T, kAxes> bound;
        double own[2][kAxes];
        bound_one<T, kAxes>(in, i, scratch, bound);
        finish<T, kAxes>(in, bv, bound, own);
        auto intersect_with = [&](std::size_t other_bv) {
            Bound<T, kAxes> other;
            double others[2][kAxes];
            bound_one<T, kAxes>(in, other_bv, scratch, other);
            finish<T, kAxes>(in, in.bvs[other_bv], other, others);
            for (std::size_t s = 0; s < 2; ++s)
                for (std::size_t a = 0; a < kAxes; ++a)
                    own[s][a] = std::min(own[s][a], others[s][a]);
        };
        if (bv.also)
            intersect_with(bv.also);
        if (bv.guard) {
            bool close = true;
            for (std::size_t s = 0; s < 2; ++s)
                for (std::size_t a = 0; a < kAxes; ++a)
                    close &= close_to<T>(own[s][a], bound.floor[s][a], bound.floor[1 - s][a]);
            if (!close)
                intersect_with(bv.guard);
        }
        to_world<T, kAxes>(in, own, supports);
    }
}

template <class T> void prefetch(const KernelInput<T>& in, const PackedBv<T>& bv)
{
    if (!takes_one_by_one(bv.kind))
        return; // a long run, which the hardware follows
    const T* const value = in.value.data() + bv.first_value;
    const std::size_t count = 12 * quads_of(bv.points) + bv.count * PackedBv<T>::values(bv.kind);
    hwy::Prefetch(in.node.data() + bv.first_node);
    for (std::size_t i = 0; i < count; i += 64 / sizeof(T))
        hwy::Prefetch(value + i);
}

template <class T, std::size_t kAxes>
void bound_list(const KernelInput<T>& in, std::span<const std::uint32_t> list, KernelScratch<T>& scratch, std::size_t side, float* dops)
{
    for (std::size_t n = 0; n < list.size(); ++n) {
        auto at = [&](std::uint32_t bv) { return in.place ? in.place[bv] : bv; };
        if (n + 2 < list.size())
            prefetch(in, in.bvs[at(list[n + 2])]);
        const std::uint32_t i = at(list[n]);
        const PackedBv<T>& bv = in.bvs[i];
        float* const dop = dops + std::size_t{list[n]} * 2 * side;
        Bound<T, kAxes> bound;
        bound_one<T, kAxes>(in, i, scratch, bound);
        finish<T, kAxes>(in, bv, bound, side, dop);
        if (bv.also) {
            float other[2 * kAxes];
            bound_one<T, kAxes>(in, bv.also, scratch, bound);
            finish<T, kAxes>(in, in.bvs[bv.also], bound, kAxes, other);
            for (std::size_t s = 0; s < 2; ++s)
                for (std::size_t a = 0; a < kAxes; ++a)
                    dop[s * side + a] = std::min(dop[s * side + a], other[s * kAxes + a]);
        }
    }
}

template <class T>
void bound_any(const KernelInput<T>& in, std::size_t first, std::size_t last, KernelScratch<T>& scratch, double* supports)
{
    switch (in.maps->kdop) {
    case 6: return bound_range<T, 3>(in, first, last, scratch, supports);
    case 14: return bound_range<T, 7>(in, first, last, scratch, supports);
    case 18: return bound_range<T, 9>(in, first, last, scratch, supports);
    default: return bound_range<T, 13>(in, first, last, scratch, supports);
    }
}

template <class T>
void bound_any_list(const KernelInput<T>& in, std::span<const std::uint32_t> list, KernelScratch<T>& scratch, std::size_t side, float* dops)
{
    switch (in.maps->kdop) {
    case 6: return bound_list<T, 3>(in, list, scratch, side, dops);
    case 14: return bound_list<T, 7>(in, list, scratch, side, dops);
    case 18: return bound_list<T, 9>(in, list, scratch, side, dops);
    default: return bound_list<T, 13>(in, list, scratch, side, dops);
    }
}

void bound_float(const KernelInput<float>& in, std::size_t first, std::size_t last, KernelScratch<float>& scratch, double* supports)
{
    bound_any<float>(in, first, last, scratch, supports);
}

void bound_double(const KernelInput<double>& in, std::size_t first, std::size_t last, KernelScratch<double>& scratch, double* supports)
{
    bound_any<double>(in, first, last, scratch, supports);
}

void list_float(const KernelInput<float>& in, std::span<const std::uint32_t> list, KernelScratch<float>& scratch, std::size_t side, float* dops)
{
    bound_any_list<float>(in, list, scratch, side, dops);
}

void list_double(const KernelInput<double>& in, std::span<const std::uint32_t> list, KernelScratch<double>& scratch, std::size_t side, float* dops)
{
    bound_any_list<double>(in, list, scratch, side, dops);
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cinch {

HWY_EXPORT(bound_float);
HWY_EXPORT(bound_double);
HWY_EXPORT(list_float);
HWY_EXPORT(list_double);

template <>
void bound_packed(const KernelInput<float>& input, std::size_t first, std::size_t last, KernelScratch<float>& scratch, std::span<double> supports)
{
    HWY_DYNAMIC_DISPATCH(bound_float)(input, first, last, scratch, supports.data());
}

template <>
void bound_packed(const KernelInput<double>& input, std::size_t first, std::size_t last, KernelScratch<double>& scratch, std::span<double> supports)
{
    HWY_DYNAMIC_DISPATCH(bound_double)(input, first, last, scratch, supports.data());
}

template <>
void bound_packed(const KernelInput<float>& input, std::span<const std::uint32_t> list, KernelScratch<float>& scratch, std::size_t side, float* dops)
{
    HWY_DYNAMIC_DISPATCH(list_float)(input, list, scratch, side, dops);
}

template <>
void bound_packed(const KernelInput<double>& input, std::span<const std::uint32_t> list, KernelScratch<double>& scratch, std::size_t side, float* dops)
{
    HWY_DYNAMIC_DISPATCH(list_double)(input, list, scratch, side, dops);
}

std::vector<std::string> kernel_targets()
{
    std::vector<std::string> names;
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets())
        names.emplace_back(hwy::TargetName(target));
    return names;
}

std::string kernel_target() { return kernel_targets().front(); }

bool force_kernel_target(std::string_view name)
{
    hwy::SetSupportedTargetsForTest(0);
    if (name.empty())
        return true;
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets())
        if (hwy::TargetName(target) == name) {
            hwy::SetSupportedTargetsForTest(target);
            return true;
        }
    return false;
}

} // namespace cinch
#endif
