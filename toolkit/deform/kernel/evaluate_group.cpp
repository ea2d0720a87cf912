// SPDX-License-Identifier: Apache-2.0
#include "toolkit/deform/kernel/evaluate_group.hpp"

// As the kernels of the bounds.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "toolkit/deform/kernel/evaluate_group.cpp"
#include <hwy/foreach_target.h>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// One coordinate of eight vertices in lanes. Products and sums are rounded one by one, in the order of evaluate_vertex.
void evaluate_group(const double* rest, const std::uint32_t* node, const double* weight, std::size_t count, const AffineMap* maps, double* place)
{
    using D = hn::CappedTag<double, 8>;
    const D d;
    constexpr std::size_t width = hn::MaxLanes(D());
    for (std::size_t h = 0; h < 8; h += width) {
        const auto x = hn::Load(d, rest + h), y = hn::Load(d, rest + 8 + h), z = hn::Load(d, rest + 16 + h);
        auto sum_x = hn::Zero(d), sum_y = sum_x, sum_z = sum_x;
        for (std::size_t e = 0; e < count; ++e) {
            const auto& m = maps[node[e]].m;
            const auto w = hn::Load(d, weight + 8 * e + h);
            auto row = [&](const double (&r)[4]) HWY_ATTR {
                const auto linear = hn::Add(hn::Add(hn::Mul(hn::Set(d, r[0]), x), hn::Mul(hn::Set(d, r[1]), y)), hn::Mul(hn::Set(d, r[2]), z));
                return hn::Mul(w, hn::Add(linear, hn::Set(d, r[3])));
            };
            sum_x = hn::Add(sum_x, row(m[0]));
            sum_y = hn::Add(sum_y, row(m[1]));
            sum_z = hn::Add(sum_z, row(m[2]));
        }
        hn::StoreU(sum_x, d, place + h);
        hn::StoreU(sum_y, d, place + 8 + h);
        hn::StoreU(sum_z, d, place + 16 + h);
    }
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cinch {
HWY_EXPORT(evaluate_group);

void evaluate_group(const double* rest, const std::uint32_t* node, const double* weight, std::size_t count, const AffineMap* maps, double* place) noexcept
{
    HWY_DYNAMIC_DISPATCH(evaluate_group)(rest, node, weight, count, maps, place);
}

} // namespace cinch
#endif
