// SPDX-License-Identifier: Apache-2.0
#include "toolkit/deform/kernel/evaluate_group.hpp"

#include "toolkit/deform/kernel/disabled_targets.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "toolkit/deform/kernel/evaluate_group.cpp"
#include <hwy/foreach_target.h>

#include "toolkit/deform/kernel/simd-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {

// One coordinate of eight vertices in lanes. Double: products and sums rounded one by one. Float: fused.
template <class T> HWY_INLINE void evaluate(const T* rest, const std::uint32_t* node, const T* weight,
                                            std::size_t count, const T* maps, T* place)
{
    using X = Simd<T, 8>;
    const auto x = X::load(rest), y = X::load(rest + 8), z = X::load(rest + 16);
    X sum[3] = {X::all(0), X::all(0), X::all(0)};
    for (std::size_t e = 0; e < count; ++e) {
        const T* m = maps + 12 * std::size_t(node[e]);
        const auto w = X::load(weight + 8 * e);
        for (std::size_t r = 0; r < 3; ++r, m += 4) {
            const auto a = X::all(m[0]), b = X::all(m[1]), c = X::all(m[2]), t = X::all(m[3]);
            if constexpr (sizeof(T) == 8)
                sum[r] = sum[r] + w * (((a * x + b * y) + c * z) + t);
            else
                sum[r] = fma(w, fma(a, x, fma(b, y, fma(c, z, t))), sum[r]);
        }
    }
    for (std::size_t r = 0; r < 3; ++r)
        sum[r].store(place + 8 * r);
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
