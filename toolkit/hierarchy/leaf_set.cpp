// SPDX-License-Identifier: Apache-2.0
#include "toolkit/hierarchy/leaf_set.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "toolkit/bounds/rounding.hpp"

namespace cinch {
namespace {

float at_least(double x) // for x ≥ 0
{
    const float f = static_cast<float>(x);
    return static_cast<double>(f) >= x ? f : succ(f);
}

// Lanes that hold so many triangles or vertices.
std::size_t lanes_for(std::size_t most) { return most <= 4 ? 4 : most <= 8 ? 8 : 16; }

void pack_leaf(const DeformableSurface& surface, const Bvh& bvh, const Bv& bv, const std::vector<std::uint32_t>& vertices, const Vec3& origin, LeafSet& out)
{
    const std::size_t L = out.lanes;
    PackedLeaf leaf;
    leaf.first = out.value.size();
    leaf.nodes = bv.influence_count;
    leaf.first_triangle = bv.first_triangle;
    leaf.triangles = bv.triangle_count;
    leaf.vertices = static_cast<std::uint32_t>(vertices.size());
    const LeafRun run{L, leaf.nodes};
    out.value.resize(leaf.first + (run.size() + 15) / 16 * 16, 0.0f); // on cache lines
    float* const value = &out.value[leaf.first];
    auto* const corner = reinterpret_cast<std::uint8_t*>(value + run.corners());
    auto* const influence = reinterpret_cast<std::uint32_t*>(value + run.influences());

    const auto nodes = std::span(bvh.node).subspan(bv.first_influence, bv.influence_count);
    for (std::size_t j = 0; j < nodes.size(); ++j) {
        influence[2 * j] = nodes[j];
        const float h = at_least(bvh.h[bv.first_influence + j]);
        std::memcpy(influence + 2 * j + 1, &h, sizeof h);
    }
    for (std::size_t lane = 0; lane < L; ++lane) {
        const std::uint32_t k = vertices[std::min(lane, vertices.size() - 1)];
        for (std::size_t r = 0; r < 3; ++r) {
            const double x = surface.mesh.vertices[k][static_cast<int>(r)] - origin[static_cast<int>(r)];
            value[r * L + lane] = static_cast<float>(x);
            // |fl(x)| may be either side of |x|, and x is off by u|x| where the origin is not 0.
            leaf.reach[r] = std::max(leaf.reach[r], succ(at_least(std::abs(x))));
        }
        const Weights::Row row = surface.weights.of(k);
        for (std::size_t i = 0; i < row.node.size(); ++i) {
            const auto j = static_cast<std::size_t>(std::lower_bound(nodes.begin(), nodes.end(), row.node[i]) - nodes.begin());
            value[run.weights() + j * L + lane] = static_cast<float>(row.weight[i]);
        }
    }
    for (std::size_t t = 0; t < L; ++t) {
        const Triangle& triangle = surface.mesh.triangles[bvh.triangle[bv.first_triangle + std::min<std::size_t>(t, bv.triangle_count - 1)]];
        for (std::size_t c = 0; c < 3; ++c)
            corner[c * L + t] = static_cast<std::uint8_t>(std::find(vertices.begin(), vertices.end(), triangle[c]) - vertices.begin());
    }
    out.leaves.push_back(leaf);
}

} // namespace

LeafSet pack_leaves(const Bvh& bvh, const DeformableSurface& surface, const Vec3& rest_origin)
{
    LeafSet out;
    std::vector<std::vector<std::uint32_t>> vertices;
    std::size_t most = 1;
    for (const Bv& bv : bvh.bvs) {
        if (!bv.is_leaf())
            continue;
        vertices.push_back(vertices_of(surface, bvh, bv));
        most = std::max({most, vertices.back().size(), std::size_t{bv.triangle_count}});
    }
    if (most > 16)
        throw std::invalid_argument("pack_leaves: a leaf has more than 16 triangles or vertices; build_bvh(surface, ClusterSize{16, 16}) makes none");
    out.lanes = lanes_for(most);
    std::size_t leaf = 0;
    for (const Bv& bv : bvh.bvs)
        if (bv.is_leaf())
            pack_leaf(surface, bvh, bv, vertices[leaf++], rest_origin, out);
    out.value.shrink_to_fit();
    return out;
}

} // namespace cinch
