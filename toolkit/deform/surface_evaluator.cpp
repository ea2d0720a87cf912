// SPDX-License-Identifier: Apache-2.0
#include "toolkit/deform/surface_evaluator.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "toolkit/deform/arithmetic.hpp"
#include "toolkit/deform/evaluate.hpp"
#include "toolkit/deform/kernel/evaluate_group.hpp"
#include "toolkit/deform/parallel.hpp"

namespace cinch {
namespace {

// Halves by the median of the longest side, at multiples of 8, until each 8 lie together.
void split(const std::vector<Vec3>& rest, std::span<std::uint32_t> order)
{
    if (order.size() <= 8)
        return;
    Vec3 low = rest[order[0]], high = low;
    for (const std::uint32_t k : order) {
        low = low.cwiseMin(rest[k]);
        high = high.cwiseMax(rest[k]);
    }
    Eigen::Index axis;
    (high - low).maxCoeff(&axis);
    const std::size_t half = (order.size() / 2 + 7) / 8 * 8;
    std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(half), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        return rest[a][axis] != rest[b][axis] ? rest[a][axis] < rest[b][axis] : a < b;
    });
    split(rest, order.first(half));
    split(rest, order.subspan(half));
}

bool is_finite(const AffineMap& map)
{
    for (const auto& row : map.m)
        for (const double value : row)
            if (!std::isfinite(value))
                return false;
    return true;
}

} // namespace

SurfaceEvaluator::SurfaceEvaluator(const DeformableSurface& surface) : surface_(&surface)
{
    const std::vector<Vec3>& rest = surface.mesh.vertices;
    std::vector<std::uint32_t> order(rest.size());
    std::iota(order.begin(), order.end(), 0u);
    split(rest, order);

    std::vector<std::uint32_t> nodes;
    for (std::size_t first = 0; first < order.size(); first += 8) {
        Group group;
        nodes.clear();
        for (std::size_t lane = 0; lane < 8; ++lane) {
            const std::uint32_t k = group.vertex[lane] = order[std::min(first + lane, order.size() - 1)];
            for (int r = 0; r < 3; ++r)
                group.rest[r][lane] = rest[k][r];
            const auto row = surface.weights.of(k).node;
            nodes.insert(nodes.end(), row.begin(), row.end());
        }
        std::sort(nodes.begin(), nodes.end());
        nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
        group.first = static_cast<std::uint32_t>(node_.size());
        group.count = static_cast<std::uint32_t>(nodes.size());
        node_.insert(node_.end(), nodes.begin(), nodes.end());
        weight_.resize(8 * node_.size(), 0);
        for (std::size_t lane = 0; lane < 8; ++lane) {
            const Weights::Row row = surface.weights.of(group.vertex[lane]);
            for (std::size_t e = 0; e < row.node.size(); ++e) {
                const auto place = static_cast<std::size_t>(std::lower_bound(nodes.begin(), nodes.end(), row.node[e]) - nodes.begin());
                weight_[8 * (group.first + place) + lane] = row.weight[e];
            }
        }
        groups_.push_back(group);
    }
}

void SurfaceEvaluator::operator()(std::span<const AffineMap> maps, std::span<Vec3> out) const
{
    require_default_arithmetic();
    const bool all_finite = std::all_of(maps.begin(), maps.end(), is_finite);
    parallel_blocks(groups_.size(), 128, [&](std::size_t first, std::size_t last) {
        for (std::size_t g = first; g < last; ++g) {
            const Group& group = groups_[g];
            const std::uint32_t* node = node_.data() + group.first;
            if (!all_finite && !std::all_of(node, node + group.count, [&](std::uint32_t j) { return is_finite(maps[j]); })) {
                for (const std::uint32_t k : group.vertex) // 0 times infinity is no 0
                    out[k] = evaluate_vertex(surface_->mesh.vertices[k], surface_->weights.of(k), maps);
                continue;
            }
            double place[3][8];
            evaluate_group(group.rest[0], node, weight_.data() + 8 * std::size_t(group.first), group.count, maps.data(), place[0]);
            for (std::size_t lane = 0; lane < 8; ++lane)
                out[group.vertex[lane]] = {place[0][lane], place[1][lane], place[2][lane]};
        }
    });
}

} // namespace cinch
