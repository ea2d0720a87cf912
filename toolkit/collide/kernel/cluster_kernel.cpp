// SPDX-License-Identifier: Apache-2.0
#include "toolkit/collide/kernel/cluster_kernel.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "toolkit/bounds/rounding.hpp"
#include "toolkit/hierarchy/kernel/leaf_kernel.hpp"

#include "toolkit/deform/kernel/disabled_targets.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "toolkit/collide/kernel/cluster_kernel.cpp"
#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "toolkit/collide/kernel/pair_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {

/// The boxes of a leaf's triangles, one in a lane.
template <std::size_t L> struct Boxes {
    Point<L> low, high;

    HWY_INLINE Boxes(const float* slot, const float (&shift)[3])
    {
        const std::uint8_t* const corner = corners_of(slot, L);
        for (std::size_t r = 0; r < 3; ++r) {
            const auto x = Wide<L>::load(slot + r * L), by = Wide<L>::all(shift[r]);
            const auto a = lookup<L>(x, corner), b = lookup<L>(x, corner + L), c = lookup<L>(x, corner + 2 * L);
            low[r] = less(less(a, b), c) + by;
            high[r] = greater(greater(a, b), c) + by;
        }
    }
    // Those that meet a box.
    HWY_INLINE std::uint32_t meeting(const float* box_low, const float* box_high) const
    {
        auto apart = (low[0] > Wide<L>::all(box_high[0])) | (Wide<L>::all(box_low[0]) > high[0]);
        for (std::size_t r = 1; r < 3; ++r)
            apart = apart | (low[r] > Wide<L>::all(box_high[r])) | (Wide<L>::all(box_low[r]) > high[r]);
        return ~apart.bits();
    }
    HWY_INLINE void grow(float by)
    {
        for (std::size_t r = 0; r < 3; ++r) {
            low[r] = Wide<L>::all(0) - next(Wide<L>::all(by) - low[r]);
            high[r] = next(high[r] + Wide<L>::all(by));
        }
    }
    HWY_INLINE float furthest() const // coordinate
    {
        auto most = Wide<L>::all(0);
        for (std::size_t r = 0; r < 3; ++r)
            most = greater(most, greater(magnitude(low[r]), magnitude(high[r])));
        return greatest(most);
    }
};

/// b's place relative to a's reference point. Fours are for x, y, z and nothing.
struct Relative {
    float shift[3];                  ///< of b's corners
    HWY_ALIGN float low[4], high[4]; ///< of the box around b's leaf, grown by a's error
    float error;                     ///< of shift
};
HWY_INLINE Relative relative(const ClusterInput& in, const ClusterPair& pair, const LeafPlace& a, const LeafPlace& b)
{
    using Four = Wide<4>;
    Relative out;
    float far = 0;
    for (std::size_t r = 0; r < 3; ++r) {
        const float between = b.reference[r] - a.reference[r];
        out.shift[r] = between + in.shift[r];
        far = std::max(far, std::max(std::abs(between), std::abs(out.shift[r])));
    }
    const auto shift = Four::load(in.shift), shift_error = Four::all(in.shift_error), start = Four::load(a.reference),
               error = Four::all(a.error);
    next(next(next(next(Four::load(pair.dop_b) + shift) + shift_error) - start) + error).store(out.high);
    (Four::all(0) - next(next(next(next(Four::load(pair.dop_b + in.side) - shift) + shift_error) + start) + error))
        .store(out.low);
    out.error = succ(2 * unit_roundoff_of<float> * far + in.shift_error); // two roundings
    return out;
}

/// Candidates: triangle i[n] of a and j[n] of b, up to L².
template <std::size_t L> struct Candidates {
    std::size_t count = 0;
    std::uint8_t i[L * L + L], j[L * L + L]; // and what fills the last lanes
};

template <std::size_t L>
HWY_INLINE void gather(const float* slot, const std::uint8_t* triangle, const float (&shift)[3], Triangles<L>& out)
{
    const std::uint8_t* const corner = corners_of(slot, L);
    for (std::size_t c = 0; c < 3; ++c) {
        HWY_ALIGN std::uint8_t vertex[16];
        lookup_bytes<L>(corner + c * L, triangle, vertex);
        for (std::size_t r = 0; r < 3; ++r)
            out.corner[c][r] = lookup<L>(Wide<L>::load(slot + r * L), vertex) + Wide<L>::all(shift[r]);
    }
}

template <std::size_t L> void test_pair(const ClusterInput& in, const ClusterPair& pair, std::uint32_t index,
                                        std::vector<TriangleHit>& out, std::uint64_t& tests)
{
    constexpr float at_home[3] = {0, 0, 0};
    const LeafPlace &place_a = place_of(pair.slot_a, L), &place_b = place_of(pair.slot_b, L);
    const Relative to_b = relative(in, pair, place_a, place_b);
    // Which triangles of either meet the box of the other leaf.
    Boxes<L> a(pair.slot_a, at_home);
    std::uint32_t of_a = a.meeting(to_b.low, to_b.high) & ((1u << pair.triangles_a) - 1);
    if (of_a == 0)
        return;
    const Boxes<L> b(pair.slot_b, to_b.shift);
    const float rounding = 2 * unit_roundoff_of<float> * b.furthest(); // of the sums with the shift
    const float error_b = succ(succ(place_b.error + to_b.error) + rounding);
    HWY_ALIGN float low[4], high[4];
    const auto start = Wide<4>::load(place_a.reference), error = Wide<4>::all(error_b);
    next(next(Wide<4>::load(pair.dop_a) - start) + error).store(high);
    (Wide<4>::all(0) - next(next(Wide<4>::load(pair.dop_a + in.side) + start) + error)).store(low);
    const std::uint32_t of_b = b.meeting(low, high) & ((1u << pair.triangles_b) - 1);
    if (of_b == 0)
        return;

    const float s = succ(place_a.error + error_b);
    Candidates<L> candidates;
    a.grow(s);
    HWY_ALIGN float box[6][L];
    for (std::size_t r = 0; r < 3; ++r) {
        a.low[r].store(box[r]);
        a.high[r].store(box[3 + r]);
    }
    for (; of_a != 0; of_a &= of_a - 1) {
        const auto i = static_cast<std::size_t>(std::countr_zero(of_a));
        for (std::size_t r = 0; r < 3; ++r) {
            low[r] = box[r][i];
            high[r] = box[3 + r][i];
        }
        const std::uint32_t met = of_b & b.meeting(low, high);
        std::memset(candidates.i + candidates.count, static_cast<int>(i), L);
        list_bits<L>(met, candidates.j + candidates.count);
        candidates.count += static_cast<std::size_t>(std::popcount(met));
    }
    tests += candidates.count;
    std::fill_n(candidates.i + candidates.count, L, std::uint8_t{0});
    std::fill_n(candidates.j + candidates.count, L, std::uint8_t{0});
    for (std::size_t first = 0; first < candidates.count; first += L) {
        Triangles<L> p, q;
        gather<L>(pair.slot_a, candidates.i + first, at_home, p);
        gather<L>(pair.slot_b, candidates.j + first, to_b.shift, q);
        p.measure(place_a.difference);
        q.measure(succ(place_b.difference + rounding));
        const std::size_t left = candidates.count - first;
        const Answer answer = intersect_lanes<L>(p, q, left >= L ? (1u << L) - 1 : (1u << left) - 1, s);
        for (std::uint32_t some = answer.hits | answer.doubtful; some != 0; some &= some - 1) {
            const auto lane = static_cast<std::size_t>(std::countr_zero(some));
            out.push_back(
                {index, candidates.i[first + lane], candidates.j[first + lane], (answer.doubtful >> lane & 1) != 0});
        }
    }
}

void test_list(const ClusterInput& in, std::span<const ClusterPair> pairs, std::uint32_t first,
               std::vector<TriangleHit>& out, std::uint64_t& tests)
{
    for (std::size_t n = 0; n < pairs.size(); ++n) {
        const auto index = static_cast<std::uint32_t>(first + n);
        switch (in.lanes) {
        case 4:
            test_pair<4>(in, pairs[n], index, out, tests);
            break;
        case 8:
            test_pair<8>(in, pairs[n], index, out, tests);
            break;
        default:
            test_pair<16>(in, pairs[n], index, out, tests);
            break;
        }
    }
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cinch {
HWY_EXPORT(test_list);

void test_clusters(const ClusterInput& input, std::span<const ClusterPair> pairs, std::uint32_t first_pair,
                   std::vector<TriangleHit>& out, std::uint64_t& triangle_tests)
{
    HWY_DYNAMIC_DISPATCH(test_list)(input, pairs, first_pair, out, triangle_tests);
}

} // namespace cinch
#endif
