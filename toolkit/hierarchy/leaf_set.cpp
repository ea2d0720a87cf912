// SPDX-License-Identifier: Apache-2.0
#include "toolkit/hierarchy/leaf_set.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <stdexcept>

#include "toolkit/bounds/rounding.hpp"

namespace cinch {
namespace {

void pack_leaf(const DeformableSurface& surface, const Bvh& bvh, const Bv& bv,
               const std::vector<std::uint32_t>& vertices, const Vec3& origin, LeafSet& out)
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

    // The heaviest first: its image of the pivot is the reference.
    const auto nodes = std::span(bvh.node).subspan(bv.first_influence, bv.influence_count);
    const auto h = std::span(bvh.h).subspan(bv.first_influence, bv.influence_count),
               l = std::span(bvh.l).subspan(bv.first_influence, bv.influence_count);
    std::vector<std::size_t> place(nodes.size()); // where each stands
    std::iota(place.begin(), place.end(), std::size_t{0});
    std::swap(place[0], place[static_cast<std::size_t>(std::max_element(h.begin(), h.end()) - h.begin())]);
    for (std::size_t j = 0; j < nodes.size(); ++j) {
        std::uint32_t* const words = influence + 4 * place[j];
        const float most = round_up<float>(h[j]), differing = round_up<float>(h[j] - l[j]); // dyadic: exact
        words[0] = nodes[j];
        std::memcpy(words + 1, &most, sizeof most);
        std::memcpy(words + 2, &differing, sizeof differing);
    }
    Vec3 pivot;
    for (int r = 0; r < 3; ++r) {
        leaf.pivot[r] = static_cast<float>(bv.pivot[r] - origin[r]);
        pivot[r] = static_cast<double>(leaf.pivot[r]);
    }
    for (std::size_t lane = 0; lane < L; ++lane) {
        const std::uint32_t k = vertices[std::min(lane, vertices.size() - 1)];
        for (std::size_t r = 0; r < 3; ++r) {
            // Two differences of doubles, then a rounding to float. An error of u|x| of the first where the origin is
            // not 0, x the coordinate about it, may be more than one of the float: it goes to the reach.
            const int s = static_cast<int>(r);
            const double x = surface.mesh.vertices[k][s] - origin[s], y = x - pivot[s];
            value[r * L + lane] = static_cast<float>(y);
            const double lost = (origin[s] == 0 ? 0 : std::abs(x) * 0x1p-28) + std::abs(y);
            leaf.reach[r] = std::max(leaf.reach[r], succ(round_up<float>(lost)));
        }
        const Weights::Row row = surface.weights.of(k);
        for (std::size_t i = 0; i < row.node.size(); ++i) {
            const auto j =
                static_cast<std::size_t>(std::lower_bound(nodes.begin(), nodes.end(), row.node[i]) - nodes.begin());
            value[run.weights() + place[j] * L + lane] = static_cast<float>(row.weight[i]);
        }
    }
    for (std::size_t t = 0; t < L; ++t) {
        const Triangle& triangle =
            surface.mesh.triangles[bvh.triangle[bv.first_triangle + std::min<std::size_t>(t, bv.triangle_count - 1)]];
        for (std::size_t c = 0; c < 3; ++c)
            corner[c * L + t] =
                static_cast<std::uint8_t>(std::find(vertices.begin(), vertices.end(), triangle[c]) - vertices.begin());
    }
    out.leaves.push_back(leaf);
}

} // namespace

LeafSet pack_leaves(const Bvh& bvh, const DeformableSurface& surface, const Vec3& rest_origin, std::size_t lanes)
{
    if (lanes != 4 && lanes != 8 && lanes != 16)
        throw std::invalid_argument("pack_leaves: lanes are 4, 8 or 16");
    LeafSet out;
    out.lanes = lanes;
    for (const Bv& bv : bvh.bvs) {
        if (!bv.is_leaf())
            continue;
        const auto vertices = vertices_of(surface, bvh, bv);
        if (std::max<std::size_t>(vertices.size(), bv.triangle_count) > lanes)
            throw std::invalid_argument("pack_leaves: a leaf has more triangles or vertices than lanes; "
                                        "build_bvh(surface, ClusterSize) limits both");
        if (bv.influence_count > most_nodes_in_float) // the premise of evaluate_leaves
            throw std::length_error(
                "pack_leaves: a leaf has over 65,536 simulation nodes; give its vertices fewer influences");
        pack_leaf(surface, bvh, bv, vertices, rest_origin, out);
    }
    out.value.shrink_to_fit();
    return out;
}

} // namespace cinch
