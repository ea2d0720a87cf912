// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>
#include <stdexcept>

#include "toolkit/bounds/rounding.hpp"
#include "toolkit/hierarchy/rest_data.hpp"

namespace cinch {
namespace {

struct Range {
    Vec3 low = Vec3::Zero(), high = Vec3::Zero();

    void include(const Range& other)
    {
        low = low.cwiseMin(other.low);
        high = high.cwiseMax(other.high);
    }
};

struct Influence {
    std::uint32_t node;
    double l, h;
    Range range; // of the vertices that it influences
};

struct RestData { // of one BV, while building
    Range range;
    std::vector<Influence> influences;
    std::uint32_t vertex_influences = 0;
};

RestData leaf_data(const DeformableSurface& surface, std::span<const std::uint32_t> vertices)
{
    const Vec3& first = surface.mesh.vertices[vertices[0]];
    RestData out{{first, first}, {}, 0};
    struct Entry {
        std::uint32_t node;
        double weight;
        std::uint32_t vertex;
    };
    std::vector<Entry> entries;
    for (std::uint32_t k : vertices) {
        out.range.include({surface.mesh.vertices[k], surface.mesh.vertices[k]});
        const Weights::Row row = surface.weights.of(k);
        out.vertex_influences = std::max(out.vertex_influences, static_cast<std::uint32_t>(row.node.size()));
        for (std::size_t i = 0; i < row.node.size(); ++i)
            entries.push_back({row.node[i], row.weight[i], k});
    }
    std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.node < b.node; });
    for (auto run = entries.begin(); run != entries.end();) {
        const auto end = std::find_if(run, entries.end(), [&](const Entry& e) { return e.node != run->node; });
        const Vec3& x = surface.mesh.vertices[run->vertex];
        Influence influence{run->node, run->weight, run->weight, {x, x}};
        for (auto e = run; e != end; ++e) {
            influence.l = std::min(influence.l, e->weight);
            influence.h = std::max(influence.h, e->weight);
            influence.range.include({surface.mesh.vertices[e->vertex], surface.mesh.vertices[e->vertex]});
        }
        if (static_cast<std::size_t>(end - run) < vertices.size())
            influence.l = 0;
        out.influences.push_back(influence);
        run = end;
    }
    return out;
}

// A node that misses one child has weight 0 there.
RestData merged(const RestData& a, const RestData& b)
{
    RestData out{a.range, {}, std::max(a.vertex_influences, b.vertex_influences)};
    out.range.include(b.range);
    out.influences.reserve(std::max(a.influences.size(), b.influences.size()));
    auto i = a.influences.begin(), j = b.influences.begin();
    while (i != a.influences.end() || j != b.influences.end()) {
        if (j == b.influences.end() || (i != a.influences.end() && i->node < j->node)) {
            out.influences.push_back(*i++);
            out.influences.back().l = 0;
        } else if (i == a.influences.end() || j->node < i->node) {
            out.influences.push_back(*j++);
            out.influences.back().l = 0;
        } else {
            Influence both = *i++;
            both.l = std::min(both.l, j->l);
            both.h = std::max(both.h, j->h);
            both.range.include(j->range);
            out.influences.push_back(both);
            ++j;
        }
    }
    return out;
}

// Doubles whose real box contains the range. The computed half is at most 5u·m too large for m = max |coordinate|: the
// centre is off the middle by ≤ u·m, which counts twice, the difference and succ add ≤ 3u·half, half ≤ m. A BV's own
// box gets 16u·m more (where it is not flat), so that it contains its local boxes as real boxes.
RestBox box_around(const Range& range, bool own)
{
    RestBox box;
    box.centre = 0.5 * range.low + 0.5 * range.high;
    for (int axis = 0; axis < 3; ++axis) {
        const double half = std::max(range.high[axis] - box.centre[axis], box.centre[axis] - range.low[axis]);
        const double most = std::max(std::abs(range.high[axis]), std::abs(range.low[axis]));
        if (half > 0) // a difference of doubles is 0 only if it is exactly 0
            box.half[axis] = succ(own ? half + (16 * unit_roundoff * most + 4 * smallest_subnormal) : half);
    }
    return box;
}

} // namespace

void set_boxes(const DeformableSurface& surface, Bvh& bvh)
{
    std::vector<RestData> data(bvh.bvs.size());
    for (std::size_t i = bvh.bvs.size(); i-- > 0;) { // children before parents
        const Bv& bv = bvh.bvs[i];
        data[i] = bv.is_leaf() ? leaf_data(surface, vertices_of(surface, bvh, bv))
                               : merged(data[bv.first_child], data[bv.first_child + 1]);
    }
    std::size_t influences = 0;
    for (const RestData& d : data)
        influences += d.influences.size();
    if (influences > std::numeric_limits<std::uint32_t>::max())
        throw std::length_error("build_bvh: over 2^32 weight intervals; use larger leaves");
    bvh.node.reserve(influences);
    bvh.l.reserve(influences);
    bvh.h.reserve(influences);
    bvh.local.reserve(influences);
    for (std::size_t i = 0; i < bvh.bvs.size(); ++i) {
        Bv& bv = bvh.bvs[i];
        bv.box = box_around(data[i].range, true);
        bv.vertex_influences = data[i].vertex_influences;
        bv.first_influence = static_cast<std::uint32_t>(bvh.node.size());
        bv.influence_count = static_cast<std::uint32_t>(data[i].influences.size());
        for (const Influence& influence : data[i].influences) {
            bvh.node.push_back(influence.node);
            bvh.l.push_back(influence.l);
            bvh.h.push_back(influence.h);
            bvh.local.push_back(box_around(influence.range, false));
        }
        data[i] = {};
    }
}

} // namespace cinch
