// SPDX-License-Identifier: Apache-2.0
// Compiled once per k-DOP and arithmetic, CINCH_AXES and CINCH_REAL, so that the compiler works on several at once
// (CMakeLists.txt).
#include "toolkit/bounds/kernel/bound_kdop.hpp"

#include "toolkit/deform/kernel/disabled_targets.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "toolkit/bounds/kernel/bound_kdop.cpp"
#include <hwy/foreach_target.h>

#include <hwy/cache_control.h>
#include <hwy/highway.h>

// Portable code is for machines that have none of the vectors; unrolled lane by lane it would take half of the time
// that all targets together take to compile.
#if HWY_TARGET == HWY_SCALAR && HWY_COMPILER_GCC && !HWY_COMPILER_CLANG && defined(__OPTIMIZE__)
#pragma GCC push_options
#pragma GCC optimize("O2")
#define CINCH_OPTIMISED_LESS
#endif

#include "toolkit/bounds/kernel/by_blocks-inl.hpp"
#include "toolkit/bounds/kernel/by_rows-inl.hpp"
#include "toolkit/bounds/kernel/output-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {
namespace {

using Real = CINCH_REAL;

template <class T, std::size_t kAxes>
HWY_NOINLINE void bound_one(const KernelInput<T>& in, std::size_t i, KernelScratch<T>& scratch, Bound<T, kAxes>& bound)
{
    const PackedBv<T>& bv = in.bvs[i];
    T* remembered = in.remembered ? in.remembered + i * 4 * kAxes : nullptr;
    if (takes_one_by_one(bv.kind))
        bound_by_rows<T, kAxes>(in, bv, remembered, scratch, bound);
    else
        bound_by_blocks<T, kAxes>(in, bv, remembered, scratch, bound);
}

template <class T, std::size_t kAxes> void bound_range(const KernelInput<T>& in, std::size_t first, std::size_t last,
                                                       KernelScratch<T>& scratch, double* supports)
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
    const std::size_t count = bv.values_before() + bv.count * PackedBv<T>::values(bv.kind);
    hwy::Prefetch(in.node.data() + bv.first_node);
    for (std::size_t i = 0; i < count; i += 64 / sizeof(T))
        hwy::Prefetch(value + i);
}

template <class T, std::size_t kAxes> void bound_list(const KernelInput<T>& in, std::span<const std::uint32_t> list,
                                                      KernelScratch<T>& scratch, std::size_t side, float* dops)
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

void bound_all(const KernelInput<Real>& in, std::size_t first, std::size_t last, KernelScratch<Real>& scratch,
               double* supports)
{
    bound_range<Real, CINCH_AXES>(in, first, last, scratch, supports);
}

void bound_listed(const KernelInput<Real>& in, std::span<const std::uint32_t> list, KernelScratch<Real>& scratch,
                  std::size_t side, float* dops)
{
    bound_list<Real, CINCH_AXES>(in, list, scratch, side, dops);
}

} // namespace
} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#ifdef CINCH_OPTIMISED_LESS
#pragma GCC pop_options
#undef CINCH_OPTIMISED_LESS
#endif

#if HWY_ONCE
namespace cinch {

using Real = CINCH_REAL;
HWY_EXPORT(bound_all);
HWY_EXPORT(bound_listed);

template <> void bound_kdop<Real, CINCH_AXES>(const KernelInput<Real>& in, std::size_t first, std::size_t last,
                                              KernelScratch<Real>& scratch, double* supports)
{
    HWY_DYNAMIC_DISPATCH(bound_all)(in, first, last, scratch, supports);
}

template <> void bound_kdop<Real, CINCH_AXES>(const KernelInput<Real>& in, std::span<const std::uint32_t> list,
                                              KernelScratch<Real>& scratch, std::size_t side, float* dops)
{
    HWY_DYNAMIC_DISPATCH(bound_listed)(in, list, scratch, side, dops);
}

} // namespace cinch
#endif
