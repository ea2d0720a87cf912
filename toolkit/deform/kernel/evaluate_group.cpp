// SPDX-License-Identifier: Apache-2.0
#include "toolkit/deform/kernel/evaluate_group.hpp"

#include <cmath>

#include "toolkit/deform/kernel/disabled_targets.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "toolkit/deform/kernel/evaluate_group.cpp"
#include <hwy/foreach_target.h>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// a b + c, rounded once.
template <class D, class V = hn::Vec<D>> HWY_INLINE V fused(D d, V a, V b, V c)
{
#if HWY_NATIVE_FMA
    (void)d;
    return hn::MulAdd(a, b, c);
#else // the emulation would round twice
    static_assert(hn::MaxLanes(D()) == 1);
    return hn::Set(d, std::fma(hn::GetLane(a), hn::GetLane(b), hn::GetLane(c)));
#endif
}

// One coordinate of eight vertices in lanes. Double: products and sums rounded one by one. Float: fused.
template <class T> HWY_INLINE void evaluate(const T* rest, const std::uint32_t* node, const T* weight,
                                            std::size_t count, const T* maps, T* place)
{
    using D = hn::CappedTag<T, 8>;
    const D d;
    for (std::size_t h = 0; h < 8; h += hn::MaxLanes(D())) {
        const auto x = hn::Load(d, rest + h), y = hn::Load(d, rest + 8 + h), z = hn::Load(d, rest + 16 + h);
        auto sum_x = hn::Zero(d), sum_y = sum_x, sum_z = sum_x;
        for (std::size_t e = 0; e < count; ++e) {
            const T* m = maps + 12 * std::size_t(node[e]);
            const auto w = hn::Load(d, weight + 8 * e + h);
            auto add = [&](const T* r, auto& sum) HWY_ATTR {
                const auto a = hn::Set(d, r[0]), b = hn::Set(d, r[1]), c = hn::Set(d, r[2]), t = hn::Set(d, r[3]);
                if constexpr (sizeof(T) == 8)
                    sum = hn::Add(
                        sum, hn::Mul(w, hn::Add(hn::Add(hn::Add(hn::Mul(a, x), hn::Mul(b, y)), hn::Mul(c, z)), t)));
                else
                    sum = fused(d, w, fused(d, a, x, fused(d, b, y, fused(d, c, z, t))), sum);
            };
            add(m, sum_x);
            add(m + 4, sum_y);
            add(m + 8, sum_z);
        }
        hn::StoreU(sum_x, d, place + h);
        hn::StoreU(sum_y, d, place + 8 + h);
        hn::StoreU(sum_z, d, place + 16 + h);
    }
}

void evaluate_double(const double* rest, const std::uint32_t* node, const double* weight, std::size_t count,
                     const double* maps, double* place)
{
    evaluate(rest, node, weight, count, maps, place);
}
void evaluate_float(const float* rest, const std::uint32_t* node, const float* weight, std::size_t count,
                    const float* maps, float* place)
{
    evaluate(rest, node, weight, count, maps, place);
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cinch {
HWY_EXPORT(evaluate_double);
HWY_EXPORT(evaluate_float);

void evaluate_group(const double* rest, const std::uint32_t* node, const double* weight, std::size_t count,
                    const double* maps, double* place) noexcept
{
    HWY_DYNAMIC_DISPATCH(evaluate_double)(rest, node, weight, count, maps, place);
}
void evaluate_group(const float* rest, const std::uint32_t* node, const float* weight, std::size_t count,
                    const float* maps, float* place) noexcept
{
    HWY_DYNAMIC_DISPATCH(evaluate_float)(rest, node, weight, count, maps, place);
}

} // namespace cinch
#endif
