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

#include <hwy/highway.h>

#include "toolkit/bounds/kernel/dual-inl.hpp"
#include "toolkit/bounds/kernel/linear-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {

template <class T, std::size_t kLanes> struct Bound {
    alignas(64) T value[2][kLanes], lambda[2][kLanes];
    LaneMap<T, kLanes> reference;
};

// The whole method: λ where the kind says, D there, and every such value intersected with the greatest b.
template <class T, std::size_t kLanes>
void bound_by_duality(const KernelInput<T>& in, const PackedBv<T>& bv, T* remembered, KernelScratch<T>& scratch, Bound<T, kLanes>& out)
{
    using L = Lanes<T, kLanes>;
    const std::uint32_t* node = in.node.data() + bv.first_node;
    const T* point = in.value.data() + bv.first_value;
    const T* record = point + 3 * bv.points;
    const std::size_t size = PackedBv<T>::record(bv.kind);
    if (scratch.b.size() < 2 * kLanes * bv.count)
        scratch.b.resize(2 * kLanes * bv.count);
    T* b = scratch.b.data();

    Extrema<T, kLanes> e;
    switch (bv.kind) {
    case Method::support:
        mean_map<T, kLanes>(*in.maps, node, record, size, 8, bv.count, out.reference);
        extrema<T, kLanes, true, true, false>(bv, *in.maps, node, record, out.reference, b, e);
        break;
    case Method::local: extrema<T, kLanes, true, false, false>(bv, *in.maps, node, record, out.reference, b, e); break;
    default: extrema<T, kLanes, false, false, true>(bv, *in.maps, node, record, out.reference, b, e); break;
    }
    std::copy_n(&e.greatest[0][0], 2 * kLanes, &out.value[0][0]);
    std::copy_n(&e.greatest[0][0], 2 * kLanes, &out.lambda[0][0]);

    alignas(64) T lambda[2][kLanes];
    Dual<T, kLanes> d;
    if (bv.kind == Method::eq12 || bv.kind == Method::limited) {
        std::copy_n(&e.second[0][0], 2 * kLanes, &lambda[0][0]);
        dual<T, kLanes, false>(bv, record, size, b, lambda, d);
        intersect<T, kLanes>(bv, e, lambda, d, in.rounding, out.value, out.lambda);
    }
    if (bv.kind == Method::limited) {
        select_best<T, kLanes>(bv, record, size, b, scratch.select, lambda);
        dual<T, kLanes, false>(bv, record, size, b, lambda, d);
        intersect<T, kLanes>(bv, e, lambda, d, in.rounding, out.value, out.lambda);
    }
    if (bv.kind == Method::local || bv.kind == Method::support) {
        for (std::size_t s = 0; s < 2; ++s)
            for (std::size_t i = 0; i < L::vectors; ++i) {
                const auto mean = L::load(e.mean[s], i);
                L::store(L::fma(L::all(bv.start), hn::Sub(L::load(e.greatest[s], i), mean), mean), lambda[s], i);
            }
        if (remembered)
            for (std::size_t i = 0; i < 2 * kLanes; ++i)
                if (remembered[i] - remembered[i] == 0) // finite
                    (&lambda[0][0])[i] = remembered[i];
        Bracket<T, kLanes> bracket;
        for (int pass = 0; pass < in.passes; ++pass) {
            const bool last = pass + 1 == in.passes && !remembered;
            if (last)
                dual<T, kLanes, false>(bv, record, size, b, lambda, d);
            else
                dual<T, kLanes, true>(bv, record, size, b, lambda, d);
            intersect<T, kLanes>(bv, e, lambda, d, in.rounding, out.value, out.lambda);
            if (!last)
                step<T, kLanes>(bv, e, d, pass == 0, bracket, lambda);
        }
        if (remembered)
            std::copy_n(&lambda[0][0], 2 * kLanes, remembered);
    }
    if (bv.kind == Method::support) {
        alignas(64) T rest[2][kLanes];
        rest_support<T, kLanes>(bv, point, out.reference, out.reference, rest[0], rest[1]);
        for (std::size_t s = 0; s < 2; ++s)
            for (std::size_t i = 0; i < L::vectors; ++i) {
                const auto sum = hn::Add(L::load(out.value[s], i), L::load(rest[s], i));
                L::store(in.rounding == Rounding::proven ? L::up(sum) : sum, out.value[s], i);
            }
    }
}

// Back from T about the body's origin to supports in the world, with the errors of the BV's nodes on top.
template <class T, std::size_t kLanes>
void finish(const KernelInput<T>& in, const PackedBv<T>& bv, const T (&value)[2][kLanes], double* supports)
{
    const std::uint32_t* node = in.node.data() + bv.first_node;
    T error = 0;
    for (std::size_t j = 0; j < bv.count; ++j) {
        const T charge = in.maps->of(node[j])[4 * kLanes - 1];
        error = charge > error ? charge : error;
    }
    const bool proven = in.rounding == Rounding::proven;
    const double widening = proven ? succ(static_cast<double>(error) * static_cast<double>(bv.error_factor)) : static_cast<double>(error);
    const auto axes = axes_of(in.maps->kdop);
    for (std::size_t a = 0; a < axes.size(); ++a)
        for (std::size_t s = 0; s < 2; ++s) {
            double sum = static_cast<double>(value[s][a]) + widening;
            sum = proven ? succ(sum) : sum;
            for (std::size_t r = 0; r < 3; ++r)
                if (axes[a][r] != 0 && in.maps->origin[static_cast<int>(r)] != 0) {
                    sum += ((axes[a][r] > 0) == (s == 0) ? 1 : -1) * in.maps->origin[static_cast<int>(r)];
                    sum = proven ? succ(sum) : sum;
                }
            supports[2 * a + s] = sum < infinite ? sum : infinite;
        }
}

template <class T, std::size_t kLanes>
void bound_one(const KernelInput<T>& in, std::size_t i, KernelScratch<T>& scratch, Bound<T, kLanes>& bound, double* supports)
{
    const PackedBv<T>& bv = in.bvs[i];
    const T* point = in.value.data() + bv.first_value;
    if (bv.kind == Method::linear)
        linear<T, kLanes>(bv, *in.maps, in.node.data() + bv.first_node, point, point + 3 * bv.points, in.rounding, bound.reference, bound.value);
    else
        bound_by_duality<T, kLanes>(in, bv, in.remembered ? in.remembered + i * 2 * kLanes : nullptr, scratch, bound);
    finish<T, kLanes>(in, bv, bound.value, supports);
}

template <class T, std::size_t kLanes>
void bound_lanes(const KernelInput<T>& in, std::size_t first, std::size_t last, KernelScratch<T>& scratch, double* supports, KernelTrace<T>* trace)
{
    const auto k = static_cast<std::size_t>(in.maps->kdop);
    for (std::size_t i = first; i < last; ++i, supports += k) {
        const PackedBv<T>& bv = in.bvs[i];
        Bound<T, kLanes> bound;
        bound_one<T, kLanes>(in, i, scratch, bound, supports);
        if (bv.also) {
            Bound<T, kLanes> second;
            double other[2 * kLanes];
            bound_one<T, kLanes>(in, bv.also, scratch, second, other);
            for (std::size_t d = 0; d < k; ++d)
                supports[d] = std::min(supports[d], other[d]);
        }
        if (trace) {
            *trace = {};
            for (std::size_t s = 0; s < 2 && bv.kind != Method::linear; ++s)
                std::copy_n(bound.lambda[s], kLanes, trace->lambda[s]);
            for (std::size_t s = 0; s < 4 && (bv.kind == Method::linear || bv.kind == Method::support); ++s)
                std::copy_n(bound.reference.row[s], kLanes, trace->reference[s]);
            ++trace;
        }
    }
}

template <class T>
void bound_any(const KernelInput<T>& in, std::size_t first, std::size_t last, KernelScratch<T>& scratch, double* supports, KernelTrace<T>* trace)
{
    switch (lanes_of(in.maps->kdop)) {
    case 4: return bound_lanes<T, 4>(in, first, last, scratch, supports, trace);
    case 8: return bound_lanes<T, 8>(in, first, last, scratch, supports, trace);
    case 12: return bound_lanes<T, 12>(in, first, last, scratch, supports, trace);
    default: return bound_lanes<T, 16>(in, first, last, scratch, supports, trace);
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

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cinch {
namespace {

HWY_EXPORT(bound_float);
HWY_EXPORT(bound_double);

} // namespace

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
