// SPDX-License-Identifier: Apache-2.0
#include "toolkit/hierarchy/kernel/crowd_kernel.hpp"

#include <algorithm>
#include <cmath>

#include "toolkit/deform/kernel/disabled_targets.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "toolkit/hierarchy/kernel/crowd_kernel.cpp"
#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "toolkit/bounds/kernel/next-inl.hpp"
#include "toolkit/deform/kernel/simd-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {

using Eight = Simd<float, 8>;

HWY_INLINE Eight gather(const float* base, const std::uint32_t* at)
{
    Eight x;
    using D = Eight::D;
    const hn::RebindToSigned<D> di;
    for (std::size_t i = 0; i < Eight::vectors; ++i)
        x.v[i] =
            hn::GatherIndex(D(), base, hn::LoadU(di, reinterpret_cast<const std::int32_t*>(at) + i * Eight::width));
    return x;
}

HWY_INLINE float greatest_of(const Eight& x)
{
    auto most = x.v[0];
    for (std::size_t i = 1; i < Eight::vectors; ++i)
        most = hn::Max(most, x.v[i]);
    return hn::GetLane(hn::MaxOfLanes(Eight::D(), most));
}

// Entry (r, c) of all maps in a row of its own, as floats; false where one is beyond the range.
HWY_INLINE bool by_entries(std::span<const AffineMap> maps, std::size_t places, float* out)
{
    double most = 0;
    bool numbers = true;
    for (std::size_t j = 0; j < maps.size(); ++j)
        for (std::size_t r = 0; r < 3; ++r)
            for (std::size_t c = 0; c < 4; ++c) {
                const double x = maps[j].m[r][c], size = std::abs(x);
                most = most > size ? most : size;
                numbers &= size <= 0x1p40;
                out[(4 * r + c) * places + j] = static_cast<float>(x);
            }
    return numbers;
}

// With u = 2^-24, S = Σ |m c| + |t| and R = Σ |m| h of a simulation node, middle and reach are within 4.1u S and 4.1u R
// of what the maps in real arithmetic have, entries rounded included; half extents are 17u(|c| + h) too large
// (crowd.cpp), translations 16u |t|, so that every node's reach is 10u (S + R) above the exact one, and more than the
// (n + 8) 2^-53 by which evaluate_vertex may be off, n ≤ 2^20.
template <bool kProven> bool bound(const CrowdInput& in, std::span<const AffineMap> maps, float* scratch, float* out)
{
    const std::size_t places = crowd_scratch(in.nodes) / 12;
    if (!by_entries(maps, places, scratch))
        return false;
    for (const CrowdBox& box : in.boxes) {
        Eight high[3], low[3], shift[3];
        for (std::size_t r = 0; r < 3; ++r) {
            high[r] = low[r] = Eight::all(-HUGE_VALF); // of the negated axis
            shift[r] = Eight::all(0);
        }
        for (std::size_t g = box.first_group; g < box.first_group + box.groups; ++g) {
            const float* rest = in.rest + 48 * g;
            Eight centre[3], half[3];
            for (std::size_t c = 0; c < 3; ++c) {
                centre[c] = Eight::load(rest + 8 * c);
                half[c] = Eight::load(rest + 24 + 8 * c);
            }
            const std::uint32_t run = in.run[g];
            for (std::size_t r = 0; r < 3; ++r) {
                auto entry = [&](std::size_t c) HWY_ATTR {
                    const float* row = scratch + (4 * r + c) * places;
                    return run != no_run ? Eight::load(row + run) : gather(row, in.node + 8 * g);
                };
                const Eight x = entry(0), y = entry(1), z = entry(2), t = entry(3);
                const Eight middle = fma(z, centre[2], fma(y, centre[1], fma(x, centre[0], t)));
                const Eight reach = fma(magnitude(z), half[2], fma(magnitude(y), half[1], magnitude(x) * half[0]));
                high[r] = greater(high[r], reach + middle);
                low[r] = greater(low[r], reach - middle);
                if constexpr (kProven)
                    shift[r] = greater(shift[r], magnitude(t));
            }
        }
        for (std::size_t r = 0; r < 3; ++r) {
            float up = greatest_of(high[r]), down = greatest_of(low[r]);
            if constexpr (kProven) {
                const float room = succ(16 * 0x1p-24f * greatest_of(shift[r]) + in.least);
                up = succ(up + room);
                down = succ(down + room);
            }
            out[r] = up;
            out[3 + r] = -down;
        }
        out += 6;
    }
    return true;
}

bool bound_any(const CrowdInput& in, std::span<const AffineMap> maps, float* scratch, float* out)
{
    return in.proven ? bound<true>(in, maps, scratch, out) : bound<false>(in, maps, scratch, out);
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cinch {
HWY_EXPORT(bound_any);

std::size_t crowd_scratch(std::size_t nodes) { return 12 * ((nodes + 15) / 8 * 8); }

bool bound_body(const CrowdInput& input, std::span<const AffineMap> maps, float* scratch, float* out)
{
    return HWY_DYNAMIC_DISPATCH(bound_any)(input, maps, scratch, out);
}

} // namespace cinch
#endif
