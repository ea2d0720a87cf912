// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "cinch/environment.hpp"
#include "cinch/refit.hpp"
#include "toolkit/bounds/rounding.hpp"
#include "toolkit/deform/aligned.hpp"
#include "toolkit/deform/parallel.hpp"
#include "toolkit/hierarchy/kernel/crowd_kernel.hpp"

namespace cinch {
namespace {

float up(double x)
{
    const auto rounded = static_cast<float>(x);
    return rounded >= x ? rounded : std::nextafter(rounded, HUGE_VALF);
}

} // namespace

struct CrowdRefitter::Parts {
    std::size_t nodes;
    CrowdOptions options;
    std::vector<std::uint32_t> bvs;
    std::vector<CrowdBox> boxes;
    std::vector<std::uint32_t> node, run;
    AlignedVector<float> rest;
    bool in_range = true; // of the kernel
    double farthest = 0;  // of rest coordinates
    // In doubles, for bodies beyond the kernel's range.
    std::vector<std::uint32_t> first;
    std::vector<std::uint32_t> of;
    std::vector<RestBox> local;
    double influences = 0;

    void add(const RestBv& bv);
    CrowdInput input() const
    {
        return {nodes,
                boxes,
                node.data(),
                rest.data(),
                run.data(),
                up(64 * smallest_subnormal_of<float> * std::max(1.0, farthest)),
                options.rounding == Rounding::proven};
    }
    void bound_in_doubles(std::span<const AffineMap> maps, std::span<Aabb> out) const;
};

void CrowdRefitter::Parts::add(const RestBv& bv)
{
    constexpr double u = 0x1p-24;
    const bool proven = options.rounding == Rounding::proven;
    const std::size_t count = bv.node.size(), groups = (count + 7) / 8;
    boxes.push_back({static_cast<std::uint32_t>(run.size()), static_cast<std::uint32_t>(groups)});
    for (std::size_t g = 0; g < groups; ++g) {
        float numbers[48];
        bool row = true;
        for (std::size_t i = 0; i < 8; ++i) {
            const std::size_t n = std::min(8 * g + i, count - 1);
            node.push_back(bv.node[n]);
            row = row && bv.node[n] == bv.node[8 * g] + i;
            for (int c = 0; c < 3; ++c) {
                const double centre = bv.local[n].centre[c], half = bv.local[n].half[c];
                const auto rounded = static_cast<float>(centre);
                const double size = std::abs(centre) + half;
                numbers[8 * static_cast<std::size_t>(c) + i] = rounded;
                // What the rounded centre is off, and the room for all that the kernel rounds.
                numbers[24 + 8 * static_cast<std::size_t>(c) + i] =
                    proven ? up((half + std::abs(centre - rounded)) + 17 * u * size) : static_cast<float>(half);
                farthest = std::max(farthest, 2 * size);
            }
        }
        rest.insert(rest.end(), numbers, numbers + 48);
        run.push_back(row ? bv.node[8 * g] : no_run);
    }
    influences = std::max(influences, static_cast<double>(bv.vertex_influences));
    first.push_back(static_cast<std::uint32_t>(of.size()));
    of.insert(of.end(), bv.node.begin(), bv.node.end());
    local.insert(local.end(), bv.local.begin(), bv.local.end());
}

// As the kernel, with room for (n + 32) roundings in doubles: middle and reach take 13 of them, evaluate_vertex n + 8.
void CrowdRefitter::Parts::bound_in_doubles(std::span<const AffineMap> maps, std::span<Aabb> out) const
{
    const double room = options.rounding == Rounding::proven ? (influences + 32) * unit_roundoff : 0;
    for (std::size_t b = 0; b < boxes.size(); ++b) {
        double high[3], low[3];
        std::fill_n(high, 3, -infinite);
        std::fill_n(low, 3, -infinite);
        const std::size_t last = b + 1 < first.size() ? first[b + 1] : of.size();
        for (std::size_t n = first[b]; n < last; ++n)
            for (std::size_t r = 0; r < 3; ++r) {
                const auto& m = maps[of[n]].m[r];
                double middle = m[3], reach = 0, size = std::abs(m[3]);
                for (int c = 0; c < 3; ++c) {
                    middle += m[c] * local[n].centre[c];
                    reach += std::abs(m[c]) * local[n].half[c];
                    size += std::abs(m[c]) * (std::abs(local[n].centre[c]) + local[n].half[c]);
                }
                const double own = room * size + (room > 0 ? (8 * influences + 32) * smallest_subnormal : 0);
                auto take = [&](double& most, double x) { // what is no number hides nothing
                    most = x < infinite ? std::max(most, x) : infinite;
                };
                take(high[r], succ(middle + reach + own));
                take(low[r], succ(reach - middle + own));
                if (!(size < infinite))
                    high[r] = low[r] = infinite;
            }
        out[b] = {{-low[0], -low[1], -low[2]}, {high[0], high[1], high[2]}};
    }
}

CrowdRefitter::CrowdRefitter(const Bvh& bvh, const DeformableSurface& surface, const CrowdOptions& options)
    : parts_(new Parts)
{
    if (options.level < 0)
        throw std::invalid_argument("crowd: a level of the tree is needed, from 0 on");
    if (bvh.detail == RestDetail::boxes)
        throw std::invalid_argument("crowd: the BVH was built without local boxes (RestDetail)");
    require_default_arithmetic();
    Parts& p = *parts_;
    p.nodes = surface.weights.node_count;
    p.options = options;
    for (std::size_t l = 0; l + 1 < bvh.level.size() && l <= static_cast<std::size_t>(options.level); ++l)
        for (std::uint32_t i = bvh.level[l]; i < bvh.level[l + 1]; ++i)
            if (l == static_cast<std::size_t>(options.level) || bvh.bvs[i].is_leaf()) {
                p.bvs.push_back(i);
                p.add(bvh.rest(i));
            }
    p.in_range = p.farthest <= 0x1p40 && p.influences <= 0x1p20;
}

CrowdRefitter::~CrowdRefitter() = default;
CrowdRefitter::CrowdRefitter(CrowdRefitter&&) noexcept = default;

const std::vector<std::uint32_t>& CrowdRefitter::bvs() const { return parts_->bvs; }

std::size_t CrowdRefitter::bytes() const
{
    const Parts& p = *parts_;
    auto size = [](const auto& all) { return all.size() * sizeof(all[0]); };
    return size(p.boxes) + size(p.node) + size(p.run) + size(p.rest) + size(p.first) + size(p.of) + size(p.local);
}

void CrowdRefitter::operator()(std::span<const AffineMap> maps, std::span<Aabb> out) const
{
    const Parts& p = *parts_;
    const std::size_t bodies = p.nodes ? maps.size() / p.nodes : 0, boxes = p.boxes.size();
    if (maps.size() != bodies * p.nodes || out.size() != bodies * boxes)
        throw std::invalid_argument(
            "crowd: a transform per body and simulation node, and a place per body and box, are "
            "needed");
    require_default_arithmetic();
    const CrowdInput input = p.input();
    parallel_blocks(bodies, 16, [&](std::size_t first, std::size_t last) {
        AlignedVector<float> scratch(crowd_scratch(p.nodes)), bounds(6 * boxes);
        for (std::size_t i = first; i < last; ++i) {
            const auto own = maps.subspan(i * p.nodes, p.nodes);
            const auto places = out.subspan(i * boxes, boxes);
            if (!p.in_range || !bound_body(input, own, scratch.data(), bounds.data())) {
                p.bound_in_doubles(own, places);
                continue;
            }
            for (std::size_t b = 0; b < boxes; ++b) {
                const float* x = &bounds[6 * b];
                places[b] = {{x[3], x[4], x[5]}, {x[0], x[1], x[2]}};
            }
        }
    });
}

} // namespace cinch
