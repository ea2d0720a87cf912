// SPDX-License-Identifier: Apache-2.0
#include "toolkit/collide/kernel/cluster_kernel.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "toolkit/bounds/rounding.hpp"
#include "toolkit/hierarchy/kernel/leaf_kernel.hpp"

// As the kernels of the bounds.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "toolkit/collide/kernel/cluster_kernel.cpp"
#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "toolkit/collide/kernel/certain_pair-inl.hpp"
#include "toolkit/hierarchy/kernel/wide-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {

/// The triangles of a leaf, one in a lane: corners, boxes, diagonals.
template <std::size_t L> struct Cluster {
    Wide<L> corner[3][3], low[3], high[3], diagonal;

    HWY_INLINE Cluster(const float* slot, const float (&shift)[3])
    {
        for (std::size_t c = 0; c < 3; ++c)
            for (std::size_t r = 0; r < 3; ++r)
                corner[c][r] = Wide<L>::load(slot + (3 * c + r) * L) + Wide<L>::all(shift[r]);
        Wide<L> squared = Wide<L>::all(0);
        for (std::size_t r = 0; r < 3; ++r) {
            low[r] = less(less(corner[0][r], corner[1][r]), corner[2][r]);
            high[r] = greater(greater(corner[0][r], corner[1][r]), corner[2][r]);
            const auto extent = high[r] - low[r];
            squared = fma(extent, extent, squared);
        }
        diagonal = root(squared);
    }
    // Those whose box, grown by `wider`, meets a box.
    HWY_INLINE std::uint32_t meeting(const float (&box_low)[3], const float (&box_high)[3], float wider) const
    {
        std::uint32_t apart = 0;
        for (std::size_t r = 0; r < 3; ++r)
            apart |= bits_where_greater(low[r], Wide<L>::all(succ(box_high[r] + wider))) | bits_where_greater(Wide<L>::all(-succ(wider - box_low[r])), high[r]);
        return ~apart;
    }
    HWY_INLINE float furthest() const // coordinate
    {
        Wide<L> most = Wide<L>::all(0);
        for (std::size_t r = 0; r < 3; ++r)
            most = greater(most, greater(magnitude(low[r]), magnitude(high[r])));
        return greatest(most);
    }
};

/// The planes of a leaf's triangles: normals, and the margins' parts that do not depend on what they are tested against.
template <std::size_t L> struct Planes {
    Wide<L> normal[3], length, h, bend; ///< length: |n|₁; bend: √3 (h (d + √3 h) + d h), at least

    HWY_INLINE Planes(const Cluster<L>& c, float difference)
    {
        Wide<L> e[3], f[3];
        for (std::size_t r = 0; r < 3; ++r) {
            e[r] = c.corner[1][r] - c.corner[0][r];
            f[r] = c.corner[2][r] - c.corner[0][r];
        }
        for (std::size_t r = 0; r < 3; ++r) {
            const std::size_t s = (r + 1) % 3, t = (r + 2) % 3;
            normal[r] = fms(e[s], f[t], e[t] * f[s]);
        }
        length = (magnitude(normal[0]) + magnitude(normal[1])) + magnitude(normal[2]);
        h = fma(c.diagonal, Wide<L>::all(12 * unit_roundoff_of<float>), Wide<L>::all(difference));
        bend = (h * Wide<L>::all(two_root_3)) * fma(h, Wide<L>::all(root_3), c.diagonal);
    }
};

/// On which side certainly, a bit for each lane.
struct Sides {
    std::uint32_t above[3], below[3];

    std::uint32_t apart() const { return (above[0] & above[1] & above[2]) | (below[0] & below[1] & below[2]); }
    std::uint32_t certain() const { return (above[0] | below[0]) & (above[1] | below[1]) & (above[2] | below[2]); }
    std::array<int, 3> signs(unsigned lane) const
    {
        std::array<int, 3> s;
        for (std::size_t c = 0; c < 3; ++c)
            s[c] = static_cast<int>(above[c] >> lane & 1) - static_cast<int>(below[c] >> lane & 1);
        return s;
    }
};

// n·(point − base) against margin, per lane.
template <std::size_t L>
HWY_INLINE void take_side(const Wide<L> (&normal)[3], const Wide<L> (&point)[3], const Wide<L> (&base)[3], const Wide<L>& margin, std::uint32_t& above, std::uint32_t& below)
{
    const auto along = fma(normal[0], point[0] - base[0], fma(normal[1], point[1] - base[1], normal[2] * (point[2] - base[2])));
    above = bits_where_greater(along, margin);
    below = bits_where_greater(Wide<L>::all(0) - along, margin);
}

/// b's place relative to a's reference point.
struct Relative {
    float shift[3];   ///< of b's corners
    float low[3], high[3]; ///< of the box around b's leaf
    float error;      ///< of shift
};
HWY_INLINE Relative relative(const ClusterInput& in, const ClusterPair& pair, const LeafPlace& a, const LeafPlace& b)
{
    Relative out;
    float far = 0;
    for (std::size_t r = 0; r < 3; ++r) {
        const float between = b.reference[r] - a.reference[r];
        out.shift[r] = between + in.shift[r];
        far = std::max(far, std::max(std::abs(between), std::abs(out.shift[r])));
        out.high[r] = succ(succ(succ(pair.dop_b[r] + in.shift[r]) + in.shift_error) - a.reference[r]);
        out.low[r] = -succ(succ(succ(pair.dop_b[in.side + r] - in.shift[r]) + in.shift_error) + a.reference[r]);
    }
    out.error = succ(2 * unit_roundoff_of<float> * far + in.shift_error); // two roundings
    return out;
}

template <std::size_t L> void test_pair(const ClusterInput& in, const ClusterPair& pair, std::uint32_t index, std::vector<TriangleHit>& out, std::uint64_t& tests)
{
    constexpr float at_home[3] = {0, 0, 0};
    const LeafPlace &place_a = place_of(pair.slot_a, L), &place_b = place_of(pair.slot_b, L);
    const Relative to_b = relative(in, pair, place_a, place_b);
    // Which triangles of either meet the box of the other leaf.
    const Cluster<L> a(pair.slot_a, at_home);
    std::uint32_t of_a = a.meeting(to_b.low, to_b.high, place_a.error) & ((1u << pair.triangles_a) - 1);
    if (of_a == 0)
        return;
    const Cluster<L> b(pair.slot_b, to_b.shift);
    const float rounding = 2 * unit_roundoff_of<float> * b.furthest(); // of the sums with the shift
    const float error_b = succ(succ(place_b.error + to_b.error) + rounding);
    float low[3], high[3];
    for (std::size_t r = 0; r < 3; ++r) {
        high[r] = succ(pair.dop_a[r] - place_a.reference[r]);
        low[r] = -succ(pair.dop_a[in.side + r] + place_a.reference[r]);
    }
    const std::uint32_t of_b = b.meeting(low, high, error_b) & ((1u << pair.triangles_b) - 1);
    if (of_b == 0)
        return;

    const float s = succ(place_a.error + error_b);
    const Planes<L> planes_a(a, place_a.difference), planes_b(b, succ(place_b.difference + rounding));
    HWY_ALIGN float of_each[7][L]; // of a: normal, |n|₁, bend, diagonal, h
    for (std::size_t r = 0; r < 3; ++r)
        planes_a.normal[r].store(of_each[r]);
    planes_a.length.store(of_each[3]);
    planes_a.bend.store(of_each[4]);
    a.diagonal.store(of_each[5]);
    planes_a.h.store(of_each[6]);
    for (; of_a != 0; of_a &= of_a - 1) {
        const auto i = static_cast<unsigned>(std::countr_zero(of_a));
        float p[3][3];
        for (std::size_t c = 0; c < 3; ++c)
            for (std::size_t r = 0; r < 3; ++r)
                p[c][r] = pair.slot_a[(3 * c + r) * L + i];
        for (std::size_t r = 0; r < 3; ++r) {
            low[r] = std::min(std::min(p[0][r], p[1][r]), p[2][r]);
            high[r] = std::max(std::max(p[0][r], p[1][r]), p[2][r]);
        }
        std::uint32_t left = of_b & b.meeting(low, high, s);
        if (left == 0)
            continue;
        tests += static_cast<std::uint64_t>(std::popcount(left));
        const auto diagonal = b.diagonal + Wide<L>::all(of_each[5][i] + 2 * s); // D
        const auto off = fma(diagonal, Wide<L>::all(unit_roundoff_of<float>), Wide<L>::all(s)); // g
        const auto reach = fma(off, Wide<L>::all(root_3), diagonal);
        const auto more = Wide<L>::all(margin_factor), least = Wide<L>::all(margin_underflow);
        Sides sides_b, sides_a; // of b's corners to the plane of i, of i's corners to b's planes
        {
            const auto margin = fma(fma(off, Wide<L>::all(of_each[3][i]), reach * Wide<L>::all(of_each[4][i])), more, least);
            const Wide<L> normal[3] = {Wide<L>::all(of_each[0][i]), Wide<L>::all(of_each[1][i]), Wide<L>::all(of_each[2][i])};
            const Wide<L> base[3] = {Wide<L>::all(p[0][0]), Wide<L>::all(p[0][1]), Wide<L>::all(p[0][2])};
            for (std::size_t c = 0; c < 3; ++c)
                take_side<L>(normal, b.corner[c], base, margin, sides_b.above[c], sides_b.below[c]);
            left &= ~sides_b.apart();
            if (left == 0)
                continue;
        }
        {
            const auto margin = fma(fma(off, planes_b.length, reach * planes_b.bend), more, least);
            for (std::size_t c = 0; c < 3; ++c) {
                const Wide<L> point[3] = {Wide<L>::all(p[c][0]), Wide<L>::all(p[c][1]), Wide<L>::all(p[c][2])};
                take_side<L>(planes_b.normal, point, b.corner[0], margin, sides_a.above[c], sides_a.below[c]);
            }
            left &= ~sides_a.apart();
        }
        if (left == 0)
            continue;
        const std::uint32_t certain = sides_a.certain() & sides_b.certain();
        HWY_ALIGN float D[L], d[L], h[L];
        diagonal.store(D);
        b.diagonal.store(d);
        planes_b.h.store(h);
        for (; left != 0; left &= left - 1) {
            const auto j = static_cast<unsigned>(std::countr_zero(left));
            int answer = 0; // of certain_pair
            if (certain >> j & 1) {
                float q[3][3];
                for (std::size_t c = 0; c < 3; ++c)
                    for (std::size_t r = 0; r < 3; ++r)
                        q[c][r] = pair.slot_b[(3 * c + r) * L + j] + to_b.shift[r];
                answer = certain_pair(p, q, sides_a.signs(j), sides_b.signs(j), {s, D[j], of_each[5][i], of_each[6][i], d[j], h[j]});
            }
            if (answer >= 0)
                out.push_back({index, static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(j), answer == 0});
        }
    }
}

void test_list(const ClusterInput& in, std::span<const ClusterPair> pairs, std::uint32_t first, std::vector<TriangleHit>& out, std::uint64_t& tests)
{
    for (std::size_t n = 0; n < pairs.size(); ++n) {
        const auto index = static_cast<std::uint32_t>(first + n);
        switch (in.lanes) {
        case 4: test_pair<4>(in, pairs[n], index, out, tests); break;
        case 8: test_pair<8>(in, pairs[n], index, out, tests); break;
        default: test_pair<16>(in, pairs[n], index, out, tests); break;
        }
    }
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cinch {
HWY_EXPORT(test_list);

void test_clusters(const ClusterInput& input, std::span<const ClusterPair> pairs, std::uint32_t first_pair, std::vector<TriangleHit>& out, std::uint64_t& triangle_tests)
{
    HWY_DYNAMIC_DISPATCH(test_list)(input, pairs, first_pair, out, triangle_tests);
}

} // namespace cinch
#endif
