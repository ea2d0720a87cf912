// SPDX-License-Identifier: Apache-2.0
#include "toolkit/hierarchy/kernel/leaf_kernel.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "toolkit/bounds/directions.hpp"
#include "toolkit/bounds/projected_maps.hpp"
#include "toolkit/bounds/rounding.hpp"
#include "toolkit/hierarchy/dop.hpp"

// As the kernels of the bounds.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "toolkit/hierarchy/kernel/leaf_kernel.cpp"
#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "toolkit/hierarchy/kernel/wide-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {

constexpr float infinity = std::numeric_limits<float>::infinity();

// Σ_j h_j |q_j| and Σ_j h_j |θ_j| per row, and whether every node has a map.
struct Magnitudes {
    float row[3][4];
    bool known;
};
HWY_INLINE Magnitudes magnitudes(const LeafInput& in, const std::uint32_t* influence, std::size_t nodes)
{
    using Quad = Wide<4>;
    Quad sum[3] = {Quad::all(0), Quad::all(0), Quad::all(0)};
    float charge = 0;
    for (std::size_t j = 0; j < nodes; ++j) {
        const float* map = in.records + influence[2 * j] * in.record;
        float h;
        std::memcpy(&h, influence + 2 * j + 1, sizeof h);
        for (std::size_t r = 0; r < 3; ++r)
            sum[r] = fma(magnitude(Quad::load(map + 4 * r)), Quad::all(h), sum[r]);
        charge = std::max(charge, map[in.record - 1]);
    }
    Magnitudes out;
    HWY_ALIGN float row[4];
    for (std::size_t r = 0; r < 3; ++r) {
        sum[r].store(row);
        std::copy_n(row, 4, out.row[r]);
    }
    out.known = charge < infinity;
    return out;
}

// See evaluate_leaves.
HWY_INLINE float position_error(const Magnitudes& m, const PackedLeaf& leaf, float vertex_error)
{
    const float* x = leaf.reach;
    const float n = static_cast<float>(leaf.nodes + 8);
    float most = 0, all = ((1 + x[0]) + x[1]) + x[2];
    for (const auto& row : m.row) {
        most = std::max(most, ((row[0] * x[0] + row[1] * x[1]) + row[2] * x[2]) + row[3]);
        all += (row[0] + row[1]) + row[2];
    }
    const float rounding = (n * 1.02f * unit_roundoff_of<float>) * most, underflow = (n * 2 * smallest_subnormal_of<float>) * all;
    return succ(succ(rounding + underflow) + vertex_error);
}

// The greatest x on either side of every axis, with their errors.
template <std::size_t L> HWY_INLINE void bound_vertices(const LeafInput& in, const Wide<L> (&p)[3], float error, float* dop)
{
    const std::size_t side = dop_side(in.kdop);
    const auto axes = axes_of(in.kdop);
    // Sums of up to three coordinates pass 2 roundings.
    const float far = greatest(greater(greater(magnitude(p[0]), magnitude(p[1])), magnitude(p[2]))), rounding = 8 * unit_roundoff_of<float> * far;
    for (std::size_t a = 0; a < axes.size(); ++a) {
        Wide<L> along = Wide<L>::all(0);
        int terms = 0;
        for (std::size_t r = 0; r < 3; ++r)
            if (axes[a][r] != 0) {
                along = axes[a][r] > 0 ? along + p[r] : along - p[r];
                ++terms;
            }
        const float wider = terms == 1 ? error : succ(succ(static_cast<float>(terms) * error) + rounding);
        dop[a] = succ(greatest(along) + wider);
        dop[side + a] = succ(greatest(Wide<L>::all(0) - along) + wider);
    }
}

template <std::size_t L> void evaluate_leaf(const LeafInput& in, const LeafJob& job)
{
    const PackedLeaf& leaf = in.leaves[job.leaf];
    const LeafRun run{L, leaf.nodes};
    const float* const value = in.value + leaf.first;
    const auto* const influence = reinterpret_cast<const std::uint32_t*>(value + run.influences());
    const float* const weights = value + run.weights();
    using D = typename Wide<L>::D;
    const D d;
    constexpr std::size_t width = Wide<L>::width;
    Wide<L> p[3];
    for (std::size_t i = 0; i < Wide<L>::vectors; ++i) {
        typename Wide<L>::V sum[3][4];
        for (auto& row : sum)
            for (auto& s : row)
                s = hn::Zero(d);
        for (std::size_t j = 0; j < leaf.nodes; ++j) {
            const float* map = in.records + influence[2 * j] * in.record;
            const auto w = hn::Load(d, weights + j * L + i * width);
            for (std::size_t r = 0; r < 3; ++r)
                for (std::size_t s = 0; s < 4; ++s)
#if HWY_NATIVE_FMA
                    sum[r][s] = hn::MulAdd(w, hn::Set(d, map[4 * r + s]), sum[r][s]);
#else
                    sum[r][s] = hn::Set(d, std::fma(hn::GetLane(w), map[4 * r + s], hn::GetLane(sum[r][s])));
#endif
        }
        const auto x = hn::Load(d, value + i * width), y = hn::Load(d, value + L + i * width), z = hn::Load(d, value + 2 * L + i * width);
        auto fused = [&](auto a, auto b, auto c) HWY_ATTR {
#if HWY_NATIVE_FMA
            return hn::MulAdd(a, b, c);
#else
            return hn::Set(d, std::fma(hn::GetLane(a), hn::GetLane(b), hn::GetLane(c)));
#endif
        };
        for (std::size_t r = 0; r < 3; ++r)
            p[r].v[i] = fused(sum[r][0], x, fused(sum[r][1], y, fused(sum[r][2], z, sum[r][3])));
    }
    const Magnitudes m = magnitudes(in, influence, leaf.nodes);
    const float error = m.known ? position_error(m, leaf, static_cast<float>(in.vertex_error)) : infinity;
    job.slot[9 * L] = error;
    if (!(error < infinity)) { // nothing is known of it
        std::fill_n(job.slot, 9 * L, 0.0f);
        job.slot[9 * L] = infinity;
        const std::size_t side = dop_side(in.kdop), axes = axes_of(in.kdop).size();
        std::fill_n(job.dop, axes, infinity);
        std::fill_n(job.dop + side, axes, infinity);
        return;
    }
    bound_vertices<L>(in, p, error, job.dop);
    HWY_ALIGN float place[3][L];
    for (std::size_t r = 0; r < 3; ++r)
        p[r].store(place[r]);
    const auto* corner = reinterpret_cast<const std::uint8_t*>(value + run.corners());
    for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t r = 0; r < 3; ++r)
            for (std::size_t t = 0; t < L; ++t)
                job.slot[(3 * c + r) * L + t] = place[r][corner[c * L + t]];
}

void evaluate_list(const LeafInput& in, std::span<const LeafJob> jobs)
{
    for (std::size_t i = 0; i < jobs.size(); ++i)
        switch (in.lanes) {
        case 4: evaluate_leaf<4>(in, jobs[i]); break;
        case 8: evaluate_leaf<8>(in, jobs[i]); break;
        default: evaluate_leaf<16>(in, jobs[i]); break;
        }
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cinch {
HWY_EXPORT(evaluate_list);

void evaluate_leaves(const LeafInput& input, std::span<const LeafJob> jobs)
{
    LeafInput in = input;
    in.vertex_error = static_cast<double>(succ(static_cast<float>(input.vertex_error)));
    HWY_DYNAMIC_DISPATCH(evaluate_list)(in, jobs);
}

} // namespace cinch
#endif
