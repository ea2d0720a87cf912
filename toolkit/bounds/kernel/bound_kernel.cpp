// SPDX-License-Identifier: Apache-2.0
#include "toolkit/bounds/kernel/bound_kernel.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "toolkit/bounds/directions.hpp"
#include "toolkit/bounds/kernel/choose_lambda.hpp"
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
#include "toolkit/bounds/kernel/support-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {

// One BV's bound on its way: along and against the axes its value and, as long as somebody asks, λ; and the reference map.
template <class T, std::size_t kAxes> struct Bound {
    alignas(64) T value[2][4 * row_chunks<kAxes> + 12]; // room to store all rows of the last chunk
    T lambda[2][kAxes] = {};
    alignas(64) T reference[4 * row_chunks<kAxes>][4] = {};
    T error; // the greatest of the BV's nodes
    bool traced = false;
};

template <class T, std::size_t kAxes>
void intersect(const KernelInput<T>& in, const PackedBv<T>& bv, const Extrema<T, kAxes>& e, const T (&lambda)[2][kAxes], const Dual<T, kAxes>& d, Bound<T, kAxes>& out)
{
    const T factor = dual_sum_factor<T>(takes_one_by_one(bv.kind) ? row_depth(bv.count) : sum_depth(bv.count)), underflow = dual_sum_underflow<T>(bv.count);
    for (std::size_t s = 0; s < 2; ++s)
        for (std::size_t a = 0; a < kAxes; ++a) {
            const DualParts<T> parts{d.lower[s][a], d.upper[s][a], d.mass[s][a]};
            const T value = in.rounding == Rounding::proven
                                ? proven_dual_value(lambda[s][a], parts, e.greatest[s][a], e.greatest[1 - s][a], factor, underflow)
                                : dual_value(lambda[s][a], parts);
            if (value < out.value[s][a]) { // not if it is NaN
                out.value[s][a] = value;
                out.lambda[s][a] = lambda[s][a];
            }
        }
}

template <class T, std::size_t kAxes>
void select_best(const PackedBv<T>& bv, const T* block, const T* b, std::vector<std::pair<T, T>>& scratch, T (&lambda)[2][kAxes])
{
    for (std::size_t s = 0; s < 2; ++s)
        for (std::size_t a = 0; a < kAxes; ++a) {
            scratch.clear();
            for (std::size_t j = 0; j < bv.count; ++j) {
                const std::size_t i = j / block_lanes, lane = j % block_lanes;
                scratch.emplace_back(b[((i * kAxes + a) * 2 + s) * block_lanes + lane],
                                     block[(i * PackedBv<T>::rows(bv.kind) + 1) * block_lanes + lane]);
            }
            lambda[s][a] = best_lambda<T>(scratch, 1 - bv.sum_l);
        }
}

// λ near the best one by at most in.passes evaluations of D, which is evaluate<with its mass>(λ, D).
template <class T, std::size_t kAxes, class Evaluate>
void search(const KernelInput<T>& in, const PackedBv<T>& bv, const Extrema<T, kAxes>& e, T* remembered, Bound<T, kAxes>& out, const Evaluate& evaluate)
{
    T lambda[2][kAxes];
    for (std::size_t s = 0; s < 2; ++s)
        for (std::size_t a = 0; a < kAxes; ++a) {
            lambda[s][a] = e.mean[s][a] + bv.start * (e.greatest[s][a] - e.mean[s][a]);
            if (remembered && std::isfinite(remembered[2 * (s * kAxes + a)]))
                lambda[s][a] = remembered[2 * (s * kAxes + a)];
        }
    Dual<T, kAxes> d;
    if (in.passes == 1 && !remembered) {
        evaluate.template operator()<false>(lambda, d);
        return intersect<T, kAxes>(in, bv, e, lambda, d, out);
    }
    std::optional<TangentSearch<T>> tangents[2][kAxes];
    for (int pass = 0; pass < in.passes; ++pass) {
        evaluate.template operator()<true>(lambda, d);
        intersect<T, kAxes>(in, bv, e, lambda, d, out);
        for (std::size_t s = 0; s < 2; ++s)
            for (std::size_t a = 0; a < kAxes; ++a) {
                const DualParts<T> parts{d.lower[s][a], d.upper[s][a], d.mass[s][a]};
                if (pass == 0)
                    tangents[s][a].emplace(lambda[s][a], parts, bv.sum_l, bv.sum_r, e.mean[s][a]);
                const T here = lambda[s][a];
                lambda[s][a] = tangents[s][a]->next(here, parts, bv.sum_l);
                if (remembered && pass + 1 == in.passes)
                    remember(here, lambda[s][a] - here, 1 - bv.sum_l - parts.mass, remembered + 2 * (s * kAxes + a));
            }
    }
}

// The greatest b, to be intersected with D where λ is best.
template <class T, std::size_t kAxes> void begin(const Extrema<T, kAxes>& e, Bound<T, kAxes>& out)
{
    for (std::size_t s = 0; s < 2; ++s)
        for (std::size_t a = 0; a < kAxes; ++a)
            out.value[s][a] = out.lambda[s][a] = e.greatest[s][a];
}

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
        T lambda[2][kAxes];
        select_best<T, kAxes>(bv, block, b, scratch.select, lambda);
        dual<T, kAxes, false>(bv, block, rows, b, lambda, d);
        intersect<T, kAxes>(in, bv, e, lambda, d, out);
    }
    if (bv.kind == Method::local)
        search<T, kAxes>(in, bv, e, remembered, out, [&]<bool kMass>(const T (&at)[2][kAxes], Dual<T, kAxes>& own) {
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
            SidesInRows<T, kAxes> lambda;
            support_in_one_pass<T, kAxes>(bv, value, b, e, in.rounding, bound, lambda);
            if (out.traced)
                to_array<T, kAxes>(lambda, out.lambda);
        } else {
            Extrema<T, kAxes> own;
            to_array<T, kAxes>(e.greatest, own.greatest);
            to_array<T, kAxes>(e.mean, own.mean);
            begin<T, kAxes>(own, out);
            search<T, kAxes>(in, bv, own, remembered, out, [&]<bool kMass>(const T (&at)[2][kAxes], Dual<T, kAxes>& d) {
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
                    bound.chunk[s][c] = Rows<T>::each_row(&out.value[s][4 * c]);
        }
        for (std::size_t c = 0; c < chunks; ++c)
            add_rest_support(bv, point, reference.chunk[c], reference.chunk[c], in.rounding, bound.chunk[0][c], bound.chunk[1][c]);
    }
    for (std::size_t s = 0; s < 2; ++s)
        for (std::size_t c = 0; c < chunks; ++c)
            bound.chunk[s][c].store(&out.value[s][4 * c]); // what is too much, the next one overwrites
    if (out.traced)
        for (std::size_t c = 0; c < chunks; ++c)
            reference.chunk[c].store(out.reference[4 * c]);
}

// What the errors of the BV's nodes add.
template <class T, std::size_t kAxes> double widening(const KernelInput<T>& in, const PackedBv<T>& bv, const Bound<T, kAxes>& bound)
{
    const double error = static_cast<double>(bound.error);
    return in.rounding == Rounding::proven ? succ(error * static_cast<double>(bv.error_factor)) : error;
}

// Back from T about the body's origin to supports in the world, with the errors of the BV's nodes on top.
template <class T, std::size_t kAxes>
void finish(const KernelInput<T>& in, const PackedBv<T>& bv, const Bound<T, kAxes>& bound, double* supports)
{
    const bool proven = in.rounding == Rounding::proven;
    const double wider = widening<T, kAxes>(in, bv, bound);
    const Vec3& origin = in.maps->origin;
    const bool at_home = origin[0] == 0 && origin[1] == 0 && origin[2] == 0;
    const auto axes = axes_of(in.maps->kdop);
    for (std::size_t a = 0; a < kAxes; ++a)
        for (std::size_t s = 0; s < 2; ++s) {
            double sum = static_cast<double>(bound.value[s][a]) + wider;
            sum = proven ? succ(sum) : sum;
            for (std::size_t r = 0; r < 3 && !at_home; ++r)
                if (axes[a][r] != 0) {
                    sum += ((axes[a][r] > 0) == (s == 0) ? 1 : -1) * origin[static_cast<int>(r)];
                    sum = proven ? succ(sum) : sum;
                }
            supports[2 * a + s] = sum < infinite ? sum : infinite;
        }
}

// The same as floats that stay relative to the body's origin.
template <class T, std::size_t kAxes>
void finish(const KernelInput<T>& in, const PackedBv<T>& bv, const Bound<T, kAxes>& bound, std::size_t side, float* dop)
{
    const double wider = widening<T, kAxes>(in, bv, bound);
    if constexpr (sizeof(T) == 4) {
        const float by = succ(static_cast<float>(wider)); // fl(x) ≥ x(1 − u), and succ goes past x
        for (std::size_t s = 0; s < 2; ++s)
            for (std::size_t c = 0; c < row_chunks<kAxes>; ++c) {
                const auto sum = next(Rows<float>::load(&bound.value[s][4 * c]) + Rows<float>::all(by));
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
void bound_range(const KernelInput<T>& in, std::size_t first, std::size_t last, KernelScratch<T>& scratch, double* supports, KernelTrace<T>* trace)
{
    for (std::size_t i = first; i < last; ++i, supports += 2 * kAxes) {
        const PackedBv<T>& bv = in.bvs[i];
        Bound<T, kAxes> bound;
        bound.traced = trace != nullptr;
        bound_one<T, kAxes>(in, i, scratch, bound);
        finish<T, kAxes>(in, bv, bound, supports);
        if (trace) {
            *trace = {};
            for (std::size_t a = 0; a < kAxes; ++a) {
                for (std::size_t s = 0; s < 2 && bv.kind != Method::linear; ++s)
                    trace->lambda[s][a] = bound.lambda[s][a];
                if (takes_one_by_one(bv.kind))
                    std::copy_n(bound.reference[a], 4, trace->reference[a]);
            }
            ++trace;
        }
        if (bv.also) {
            double other[2 * kAxes];
            bound_one<T, kAxes>(in, bv.also, scratch, bound);
            finish<T, kAxes>(in, in.bvs[bv.also], bound, other);
            for (std::size_t d = 0; d < 2 * kAxes; ++d)
                supports[d] = std::min(supports[d], other[d]);
        }
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
void bound_any(const KernelInput<T>& in, std::size_t first, std::size_t last, KernelScratch<T>& scratch, double* supports, KernelTrace<T>* trace)
{
    switch (in.maps->kdop) {
    case 6: return bound_range<T, 3>(in, first, last, scratch, supports, trace);
    case 14: return bound_range<T, 7>(in, first, last, scratch, supports, trace);
    case 18: return bound_range<T, 9>(in, first, last, scratch, supports, trace);
    default: return bound_range<T, 13>(in, first, last, scratch, supports, trace);
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

void bound_float(const KernelInput<float>& in, std::size_t first, std::size_t last, KernelScratch<float>& scratch, double* supports, KernelTrace<float>* trace)
{
    bound_any<float>(in, first, last, scratch, supports, trace);
}

void bound_double(const KernelInput<double>& in, std::size_t first, std::size_t last, KernelScratch<double>& scratch, double* supports, KernelTrace<double>* trace)
{
    bound_any<double>(in, first, last, scratch, supports, trace);
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
void bound_packed(const KernelInput<float>& input, std::size_t first, std::size_t last, KernelScratch<float>& scratch, std::span<double> supports, KernelTrace<float>* trace)
{
    HWY_DYNAMIC_DISPATCH(bound_float)(input, first, last, scratch, supports.data(), trace);
}

template <>
void bound_packed(const KernelInput<double>& input, std::size_t first, std::size_t last, KernelScratch<double>& scratch, std::span<double> supports, KernelTrace<double>* trace)
{
    HWY_DYNAMIC_DISPATCH(bound_double)(input, first, last, scratch, supports.data(), trace);
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
