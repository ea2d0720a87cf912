// SPDX-License-Identifier: Apache-2.0
#include "toolkit/hierarchy/kernel/leaf_kernel.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "cinch/bounds.hpp"
#include "toolkit/bounds/projected_maps.hpp"
#include "toolkit/bounds/rounding.hpp"
#include "toolkit/deform/aligned.hpp"
#include "toolkit/hierarchy/dop.hpp"

#include "toolkit/deform/kernel/disabled_targets.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "toolkit/hierarchy/kernel/leaf_kernel.cpp"
#include <hwy/foreach_target.h>

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include "toolkit/hierarchy/kernel/wide-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {

constexpr float infinity = std::numeric_limits<float>::infinity();

/// 16 floats of a record: rows of q and θ, and what comes after.
using Record = Wide<16>;
/// In every lane the sum of its four, ((0 + 1) + (2 + 3)).
HWY_INLINE Record sum_of_fours(const Record& x)
{
#if HWY_TARGET == HWY_SCALAR
    Record out;
    for (std::size_t r = 0; r < 16; r += 4)
        for (std::size_t s = 0; s < 4; ++s)
            out.v[r + s] = hn::Add(hn::Add(x.v[r], x.v[r + 1]), hn::Add(x.v[r + 2], x.v[r + 3]));
    return out;
#else
    const auto pairs = each(x, x, [](auto v, auto) { return hn::Add(v, hn::Shuffle2301(v)); });
    return each(pairs, pairs, [](auto v, auto) { return hn::Add(v, hn::Shuffle1032(v)); });
#endif
}
/// `at_three` in lanes 3, 7, 11, …, else x.
HWY_INLINE Record with_last(const Record& x, const Record& at_three, const Record& threes)
{
    Record out;
    for (std::size_t i = 0; i < Record::vectors; ++i)
        out.v[i] = hn::IfThenElse(hn::Gt(threes.v[i], hn::Zero(Record::D())), at_three.v[i], x.v[i]);
    return out;
}

// Of a leaf's simulation nodes: Y_0, and the sums that bound errors. In every lane of row r that of coordinate r.
struct NodeSums {
    Record reference, images, differing, spread; // images: Σ h N, differing: Σ r N, spread: M
    Record maps;                                 // Σ h (|A_r0| + |A_r1| + |A_r2|)
    bool known;
};

// maps: per node A_r and U_r in rows of four, 16 floats each.
HWY_INLINE NodeSums prepare_nodes(const LeafInput& in, const PackedLeaf& leaf, const std::uint32_t* influence,
                                  float* maps)
{
    HWY_ALIGN static constexpr float third[4] = {0, 0, 0, 1}, first_three[4] = {1, 1, 1, 0};
    const auto pivot = Record::fours(leaf.pivot), threes = Record::fours(third);
    auto by_h = Record::all(0), by_r = Record::all(0), spread = Record::all(0);
    NodeSums out;
    float charge = 0;
    for (std::size_t j = 0; j < leaf.nodes; ++j) {
        const float* record = in.records + influence[4 * j] * in.record;
        float h, r;
        std::memcpy(&h, influence + 4 * j + 1, sizeof h);
        std::memcpy(&r, influence + 4 * j + 2, sizeof r);
        const auto map = Record::load(record), image = sum_of_fours(map * pivot);
        if (j == 0)
            out.reference = image;
        const auto from_reference = image - out.reference, size = magnitude(map);
        with_last(map, from_reference, threes).store(maps + 16 * j);
        by_h = fma(size, Record::all(h), by_h);
        by_r = fma(size, Record::all(r), by_r);
        spread = fma(magnitude(from_reference), Record::all(h), spread);
        charge = std::max(charge, record[in.record - 1]);
    }
    const auto z = magnitude(pivot);
    out.images = sum_of_fours(by_h * z);
    out.differing = sum_of_fours(by_r * z);
    out.spread = sum_of_fours(by_h * Record::fours(leaf.reach)) + spread;
    out.maps = sum_of_fours(by_h * Record::fours(first_three));
    out.known = charge < infinity;
    return out;
}

/// The greatest over rows 0 to 2.
HWY_INLINE float greatest_row(const Record& x)
{
    HWY_ALIGN float lane[16];
    x.store(lane);
    return std::max(std::max(lane[0], lane[4]), lane[8]);
}

// See evaluate_leaves.
HWY_INLINE LeafPlace errors_of(const NodeSums& m, const PackedLeaf& leaf, float vertex_error)
{
    LeafPlace place{{0, 0, 0}, infinity, infinity};
    if (!m.known)
        return place;
    HWY_ALIGN float reference[16];
    m.reference.store(reference);
    for (std::size_t r = 0; r < 3; ++r)
        place.reference[r] = reference[4 * r];
    constexpr float u = unit_roundoff_of<float> * 1.02f;
    const float n = static_cast<float>(leaf.nodes + 8);
    const float extent = ((leaf.reach[0] + leaf.reach[1]) + leaf.reach[2]) +
                         ((std::abs(leaf.pivot[0]) + std::abs(leaf.pivot[1])) + std::abs(leaf.pivot[2]));
    const auto sum = fma(m.spread, Record::all(n * u),
                         fma(m.maps, Record::all(n * 0x1p-120f), Record::all((n * 0x1p-120f) * (1 + extent))));
    const auto six_u = Record::all(6 * u);
    place.error = succ(succ(greatest_row(fma(m.images, six_u, sum))) + vertex_error);
    place.difference = succ(succ(greatest_row(fma(m.differing, six_u, sum + sum))) + 2 * vertex_error);
    return place;
}

// The greatest x on either side of every axis, with their errors.
template <std::size_t L>
HWY_INLINE void bound_vertices(const LeafInput& in, const Wide<L> (&p)[3], const LeafPlace& place, float* dop)
{
    const std::size_t side = dop_side(in.kdop);
    const auto axes = axes_of(in.kdop);
    for (std::size_t r = 0; r < 3; ++r) { // the faces come first
        dop[r] = succ(succ(greatest(p[r]) + place.reference[r]) + place.error);
        dop[side + r] = succ(succ(greatest(Wide<L>::all(0) - p[r]) - place.reference[r]) + place.error);
    }
    if (axes.size() == 3)
        return;
    // Sums of up to three coordinates pass 2 roundings.
    const float far = greatest(greater(greater(magnitude(p[0]), magnitude(p[1])), magnitude(p[2])));
    const float whole = far + std::max(std::max(std::abs(place.reference[0]), std::abs(place.reference[1])),
                                       std::abs(place.reference[2]));
    const float wider = succ(succ(3 * place.error) + 16 * unit_roundoff_of<float> * whole);
    for (std::size_t a = 3; a < axes.size(); ++a) {
        Wide<L> along = Wide<L>::all(0);
        float reference = 0;
        for (std::size_t r = 0; r < 3; ++r)
            if (axes[a][r] != 0) {
                along = axes[a][r] > 0 ? along + p[r] : along - p[r];
                reference = axes[a][r] > 0 ? reference + place.reference[r] : reference - place.reference[r];
            }
        dop[a] = succ(succ(greatest(along) + reference) + wider);
        dop[side + a] = succ(succ(greatest(Wide<L>::all(0) - along) - reference) + wider);
    }
}

template <std::size_t L> void evaluate_leaf(const LeafInput& in, const LeafJob& job, float* maps)
{
    const PackedLeaf& leaf = in.leaves[job.leaf];
    const LeafRun run{L, leaf.nodes};
    const float* const value = in.value + leaf.first;
    const float* const weights = value + run.weights();
    const NodeSums nodes =
        prepare_nodes(in, leaf, reinterpret_cast<const std::uint32_t*>(value + run.influences()), maps);
    const LeafPlace place = errors_of(nodes, leaf, static_cast<float>(in.vertex_error));
    if (!(place.error < infinity)) { // nothing is known of it
        if (job.slot) {
            std::fill_n(job.slot, 3 * L, 0.0f);
            std::memcpy(job.slot + 3 * L, value + run.corners(), 3 * L);
            place_of(job.slot, L) = {{0, 0, 0}, infinity, infinity};
        }
        const std::size_t side = dop_side(in.kdop), axes = axes_of(in.kdop).size();
        std::fill_n(job.dop, axes, infinity);
        std::fill_n(job.dop + side, axes, infinity);
        return;
    }
    using D = typename Wide<L>::D;
    const D d;
    Wide<L> p[3];
    for (std::size_t i = 0; i < Wide<L>::vectors; ++i) {
        auto fused = [&](auto a, auto b, auto c) HWY_ATTR {
#if HWY_NATIVE_FMA
            return hn::MulAdd(a, b, c);
#else
            return hn::Set(d, std::fma(hn::GetLane(a), hn::GetLane(b), hn::GetLane(c)));
#endif
        };
        const std::size_t first = i * Wide<L>::width;
        typename Wide<L>::V sum[3][4];
        for (auto& row : sum)
            for (auto& s : row)
                s = hn::Zero(d);
        for (std::size_t j = 0; j < leaf.nodes; ++j) {
            const float* map = maps + 16 * j;
            const auto w = hn::Load(d, weights + j * L + first);
#pragma GCC unroll 3
            for (std::size_t r = 0; r < 3; ++r)
#pragma GCC unroll 4
                for (std::size_t s = 0; s < 4; ++s)
                    sum[r][s] = fused(w, hn::Set(d, map[4 * r + s]), sum[r][s]);
        }
        const auto x = hn::Load(d, value + first), y = hn::Load(d, value + L + first),
                   z = hn::Load(d, value + 2 * L + first);
#pragma GCC unroll 3
        for (std::size_t r = 0; r < 3; ++r)
            p[r].v[i] = fused(sum[r][0], x, fused(sum[r][1], y, fused(sum[r][2], z, sum[r][3])));
    }
    bound_vertices<L>(in, p, place, job.dop);
    if (!job.slot)
        return;
    for (std::size_t r = 0; r < 3; ++r)
        p[r].store(job.slot + r * L);
    std::memcpy(job.slot + 3 * L, value + run.corners(), 3 * L);
    place_of(job.slot, L) = place;
}

void prefetch(const LeafInput& in, const LeafJob& job)
{
    const PackedLeaf& leaf = in.leaves[job.leaf];
    const float* const value = in.value + leaf.first;
    for (std::size_t i = 0; i < LeafRun{in.lanes, leaf.nodes}.size(); i += 16)
        hwy::Prefetch(value + i);
}

void evaluate_list(const LeafInput& in, std::span<const LeafJob> jobs, float* maps)
{
    for (std::size_t i = 0; i < jobs.size(); ++i) {
        if (i + 2 < jobs.size())
            prefetch(in, jobs[i + 2]);
        switch (in.lanes) {
        case 4:
            evaluate_leaf<4>(in, jobs[i], maps);
            break;
        case 8:
            evaluate_leaf<8>(in, jobs[i], maps);
            break;
        default:
            evaluate_leaf<16>(in, jobs[i], maps);
            break;
        }
    }
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cinch {
HWY_EXPORT(evaluate_list);

void evaluate_leaves(const LeafInput& input, std::span<const LeafJob> jobs)
{
    static thread_local AlignedVector<float> maps; // of one leaf's nodes
    std::size_t most = 0;
    for (const LeafJob& job : jobs)
        most = std::max<std::size_t>(most, input.leaves[job.leaf].nodes);
    if (maps.size() < 16 * most)
        maps.resize(16 * most);
    LeafInput in = input;
    in.vertex_error = static_cast<double>(succ(static_cast<float>(input.vertex_error)));
    HWY_DYNAMIC_DISPATCH(evaluate_list)(in, jobs, maps.data());
}

} // namespace cinch
#endif
