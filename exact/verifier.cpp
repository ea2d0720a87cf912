// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/verifier.hpp"

#include <cmath>
#include <stdexcept>

#include "cinch/deform.hpp"
#include "cinch/environment.hpp"
#include "exact/bv_check.hpp"
#include "exact/rest_data.hpp"
#include "toolkit/deform/parallel.hpp"

namespace cinch::exact {
std::string name_of(Statement statement)
{
    switch (statement) {
    case rest_data:
        return "rest data";
    case weight_space:
        return "weight space";
    case exact_vertices:
        return "exact vertices";
    case computed_vertices:
        return "computed vertices";
    }
    return "unknown";
}

namespace {

void no_pause() {}

} // namespace

Verifier::Verifier(const DeformableSurface& surface, const Bvh& bvh, void (*pause)(),
                   std::span<const MorphTarget> targets)
    : surface_(surface), bvh_(bvh), pause_(pause ? pause : no_pause), targets_(targets),
      displacements_(targets, surface.mesh.vertices.size())
{
    require_default_arithmetic();
    require_dyadic_weights(surface);
    require_tree(surface, bvh);
    if (bvh.detail != RestDetail::all)
        throw std::invalid_argument("Verifier: the BVH was built without some of its rest data (RestDetail)");
    vertices_.resize(bvh.bvs.size());
    faults_.resize(bvh.bvs.size());
    parallel_blocks(bvh.bvs.size(), 64, [&](std::size_t first, std::size_t last) {
        pause_();
        for (std::size_t i = first; i < last; ++i) {
            vertices_[i] = vertices_of(surface, bvh, i);
            faults_[i] = rest_data_fault(surface, bvh, i, vertices_[i]);
        }
    });
}

std::array<Enclosure, 3> Verifier::place(std::uint32_t vertex, std::span<const AffineMap> maps,
                                         std::span<const double> weights) const
{
    const Frame frame{surface_, bvh_, maps, Method::vertices, RestShape::aabb, {}, {}, {}, displacements_, weights};
    const DirectedRounding upward;
    const Point<Interval> x = deformed(frame.rest<Interval>(vertex), surface_.weights.of(vertex), maps);
    return {{{x[0].inf(), x[0].sup()}, {x[1].inf(), x[1].sup()}, {x[2].inf(), x[2].sup()}}};
}

FrameVerdict Verifier::check(std::span<const AffineMap> maps, Methods methods, int kdop,
                             std::span<const double> supports, RestShape shape, std::span<const double> weights) const
{
    const auto k = static_cast<std::size_t>(kdop);
    if (!is_kdop(kdop) || maps.size() != surface_.weights.node_count || supports.size() != bvh_.bvs.size() * k ||
        (!weights.empty() && weights.size() != displacements_.targets()))
        throw std::invalid_argument("Verifier::check: sizes do not fit");
    for (const AffineMap& map : maps)
        for (const auto& row : map.m)
            for (double x : row)
                if (!std::isfinite(x))
                    throw std::invalid_argument(
                        "Verifier::check: a transform is not finite; there is no exact position to compare with");

    if (!std::all_of(weights.begin(), weights.end(), [](double a) { return std::isfinite(a); }))
        throw std::invalid_argument("Verifier::check: a weight is not finite; there is no exact position to compare "
                                    "with");
    require_default_arithmetic();
    const std::size_t vertex_count = surface_.mesh.vertices.size();
    Frame frame{surface_, bvh_, maps, methods, shape, axes_of(kdop), {}, {}, displacements_, weights};
    frame.computed_vertices = surface_.mesh.vertices;
    if (!weights.empty())
        displace(targets_, weights, frame.computed_vertices);
    evaluate(frame.computed_vertices, surface_.weights, maps, frame.computed_vertices);
    frame.exact_vertices.resize(vertex_count);
    parallel_blocks(vertex_count, 512, [&](std::size_t first, std::size_t last) {
        pause_();
        const DirectedRounding upward;
        for (std::size_t v = first; v < last; ++v)
            frame.exact_vertices[v] = deformed(frame.rest<Interval>(v), surface_.weights.of(v), maps);
    });

    FrameVerdict out;
    out.failed.assign(supports.size(), 0);
    out.lambda.assign(supports.size(), 0);
    out.bvs.resize(bvh_.bvs.size());
    constexpr std::size_t block_bvs = 64;
    std::vector<BlockResult> blocks((bvh_.bvs.size() + block_bvs - 1) / block_bvs);
    parallel_blocks(blocks.size(), 1, [&](std::size_t first, std::size_t last) {
        const DirectedRounding upward;
        BvCheck check(frame);
        for (std::size_t b = first; b < last; ++b)
            for (std::size_t i = b * block_bvs; i < std::min(bvh_.bvs.size(), (b + 1) * block_bvs); ++i) {
                if (i % 8 == 0)
                    pause_();
                if (!faults_[i].empty()) {
                    std::fill_n(out.failed.begin() + static_cast<std::ptrdiff_t>(i * k), k, rest_data);
                    blocks[b].violations.push_back({i, -1, rest_data, faults_[i]});
                }
                check.check(i, vertices_[i], supports.subspan(i * k, k), out, blocks[b]);
            }
    });
    constexpr std::size_t most_examples = 10;
    for (BlockResult& block : blocks) {
        out.decided_by_filter += block.decided_by_filter;
        out.exact_lambda.merge(block.exact_lambda);
        for (Violation& violation : block.violations)
            if (out.examples.size() < most_examples)
                out.examples.push_back(std::move(violation));
    }
    return out;
}

} // namespace cinch::exact
