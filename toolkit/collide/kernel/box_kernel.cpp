// SPDX-License-Identifier: Apache-2.0
#include "toolkit/collide/kernel/box_kernel.hpp"

#include "toolkit/deform/kernel/disabled_targets.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "toolkit/collide/kernel/box_kernel.cpp"
#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "toolkit/hierarchy/kernel/wide-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {

template <std::size_t kSide> HWY_INLINE bool disjoint(const float* a, const float* b, const float* shift)
{
    const auto zero = Wide<4>::all(0);
    for (std::size_t i = 0; i < kSide; i += 4) {
        const auto along = (Wide<4>::load(a + i) + Wide<4>::load(b + kSide + i)) + Wide<4>::load(shift + i);
        const auto against = (Wide<4>::load(a + kSide + i) + Wide<4>::load(b + i)) + Wide<4>::load(shift + kSide + i);
        if (bits_where_greater(zero, along) | bits_where_greater(zero, against))
            return true;
    }
    return false;
}

template <std::size_t kSide> BvPair* test(const BoxInput& in, std::span<const BoxTest> tests, BvPair* out)
{
    for (const BoxTest& t : tests) {
        const std::uint32_t a0 = t.a & ~BoxTest::both, b0 = t.b & ~BoxTest::both;
        const std::uint32_t a_end = a0 + 1 + (t.a != a0), b_end = b0 + 1 + (t.b != b0);
        for (std::uint32_t a = a0; a < a_end; ++a)
            for (std::uint32_t b = b0; b < b_end; ++b) {
                *out = {a, b};
                out += !disjoint<kSide>(in.dops_a + std::size_t{a} * 2 * kSide, in.dops_b + std::size_t{b} * 2 * kSide,
                                        in.shift);
            }
    }
    return out;
}

BvPair* test_any(const BoxInput& in, std::span<const BoxTest> tests, BvPair* out)
{
    switch (in.side) {
    case 4:
        return test<4>(in, tests, out);
    case 8:
        return test<8>(in, tests, out);
    case 12:
        return test<12>(in, tests, out);
    default:
        return test<16>(in, tests, out);
    }
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cinch {
HWY_EXPORT(test_any);

BvPair* test_boxes(const BoxInput& input, std::span<const BoxTest> tests, BvPair* out)
{
    return HWY_DYNAMIC_DISPATCH(test_any)(input, tests, out);
}

} // namespace cinch
#endif
