// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>
#include <numeric>
#include <stdexcept>

#include <Eigen/Eigenvalues>

#include "toolkit/bounds/rounding.hpp"
#include "toolkit/hierarchy/bvh.hpp"

namespace cinch {
namespace {

struct Interval {
    std::uint32_t node;
    double l, h;
};

struct RestData { // of one BV, while building
    Vec3 low, high;
    std::vector<Interval> intervals;
    std::uint32_t vertex_influences = 0;
};

// Orders [first, last) of `triangle` so that the halves lie on either side of the median along the longest covariance axis.
void split(std::span<std::uint32_t> triangles, std::span<const Vec3> centroid)
{
    Vec3 mean = Vec3::Zero();
    for (std::uint32_t t : triangles)
        mean += centroid[t];
    mean /= static_cast<double>(triangles.size());
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (std::uint32_t t : triangles)
        covariance += (centroid[t] - mean) * (centroid[t] - mean).transpose();
    const Vec3 axis = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvectors().col(2);
    auto key = [&](std::uint32_t t) { return std::pair(axis.dot(centroid[t]), t); };
    std::nth_element(triangles.begin(), triangles.begin() + static_cast<std::ptrdiff_t>(triangles.size() / 2), triangles.end(),
                     [&](std::uint32_t s, std::uint32_t t) { return key(s) < key(t); });
}

// Centroids in units of the whole mesh, so that covariances neither overflow nor vanish.
std::vector<Vec3> scaled_centroids(const TriangleMesh& mesh)
{
    const Extent e = extent(mesh);
    const double unit = e.longest_half > 0 ? e.longest_half : 1;
    std::vector<Vec3> centroid;
    centroid.reserve(mesh.triangles.size());
    auto scaled = [&](std::uint32_t v) { return Vec3(mesh.vertices[v] / unit - e.centre / unit); };
    for (const Triangle& t : mesh.triangles)
        centroid.push_back((scaled(t[0]) + scaled(t[1]) + scaled(t[2])) / 3);
    return centroid;
}

RestData leaf_data(const DeformableSurface& surface, std::span<const std::uint32_t> triangles)
{
    std::vector<std::uint32_t> vertices;
    for (std::uint32_t t : triangles)
        vertices.insert(vertices.end(), surface.mesh.triangles[t].begin(), surface.mesh.triangles[t].end());
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());

    RestData out{surface.mesh.vertices[vertices[0]], surface.mesh.vertices[vertices[0]], {}, 0};
    std::vector<std::pair<std::uint32_t, double>> weights;
    for (std::uint32_t k : vertices) {
        out.low = out.low.cwiseMin(surface.mesh.vertices[k]);
        out.high = out.high.cwiseMax(surface.mesh.vertices[k]);
        const Weights::Row row = surface.weights.of(k);
        out.vertex_influences = std::max(out.vertex_influences, static_cast<std::uint32_t>(row.node.size()));
        for (std::size_t i = 0; i < row.node.size(); ++i)
            weights.emplace_back(row.node[i], row.weight[i]);
    }
    std::sort(weights.begin(), weights.end()); // by node, then weight: a node's run is [least, greatest]
    for (auto run = weights.begin(); run != weights.end();) {
        const auto end = std::find_if(run, weights.end(), [&](const auto& w) { return w.first != run->first; });
        const bool influences_all = static_cast<std::size_t>(end - run) == vertices.size();
        out.intervals.push_back({run->first, influences_all ? run->second : 0, (end - 1)->second});
        run = end;
    }
    return out;
}

// A node that misses one child has weight 0 there.
RestData merged(const RestData& a, const RestData& b)
{
    RestData out{a.low.cwiseMin(b.low), a.high.cwiseMax(b.high), {}, std::max(a.vertex_influences, b.vertex_influences)};
    auto i = a.intervals.begin(), j = b.intervals.begin();
    while (i != a.intervals.end() || j != b.intervals.end()) {
        if (j == b.intervals.end() || (i != a.intervals.end() && i->node < j->node)) {
            out.intervals.push_back({i->node, 0, i->h});
            ++i;
        } else if (i == a.intervals.end() || j->node < i->node) {
            out.intervals.push_back({j->node, 0, j->h});
            ++j;
        } else {
            out.intervals.push_back({i->node, std::min(i->l, j->l), std::max(i->h, j->h)});
            ++i;
            ++j;
        }
    }
    return out;
}

// Centre ± half as doubles whose real box contains [low, high].
void set_rest_box(Bv& bv, const RestData& data)
{
    bv.centre = 0.5 * data.low + 0.5 * data.high;
    for (int axis = 0; axis < 3; ++axis) {
        const double half = std::max(data.high[axis] - bv.centre[axis], bv.centre[axis] - data.low[axis]);
        bv.half[axis] = half == 0 ? 0 : succ(half); // a difference of doubles is 0 only if it is exactly 0
    }
}

} // namespace

Bvh build_bvh(const DeformableSurface& surface, std::size_t leaf_triangles)
{
    if (leaf_triangles == 0)
        throw std::invalid_argument("build_bvh: a leaf needs at least one triangle");
    if (surface.weights.vertex_count() != surface.mesh.vertices.size())
        throw std::invalid_argument("build_bvh: the weights are not those of the mesh");
    Bvh bvh;
    const std::size_t triangles = surface.mesh.triangles.size();
    if (triangles == 0)
        return bvh;
    bvh.triangle.resize(triangles);
    std::iota(bvh.triangle.begin(), bvh.triangle.end(), 0u);
    const std::vector<Vec3> centroid = scaled_centroids(surface.mesh);

    Bv root;
    root.triangle_count = static_cast<std::uint32_t>(triangles);
    bvh.bvs.push_back(root);
    for (std::size_t begin = 0; begin < bvh.bvs.size();) { // one level per round
        bvh.level.push_back(static_cast<std::uint32_t>(begin));
        const std::size_t end = bvh.bvs.size();
        for (; begin < end; ++begin) {
            const auto first = bvh.bvs[begin].first_triangle, count = bvh.bvs[begin].triangle_count;
            if (count <= leaf_triangles)
                continue;
            split(std::span(bvh.triangle).subspan(first, count), centroid);
            bvh.bvs[begin].first_child = static_cast<std::uint32_t>(bvh.bvs.size());
            Bv left, right;
            left.first_triangle = first;
            left.triangle_count = count / 2;
            right.first_triangle = first + count / 2;
            right.triangle_count = count - count / 2;
            bvh.bvs.push_back(left);
            bvh.bvs.push_back(right);
        }
    }
    bvh.level.push_back(static_cast<std::uint32_t>(bvh.bvs.size()));

    std::vector<RestData> data(bvh.bvs.size());
    for (std::size_t i = bvh.bvs.size(); i-- > 0;) { // children before parents
        const Bv& bv = bvh.bvs[i];
        data[i] = bv.is_leaf() ? leaf_data(surface, std::span(bvh.triangle).subspan(bv.first_triangle, bv.triangle_count))
                               : merged(data[bv.first_child], data[bv.first_child + 1]);
    }
    for (std::size_t i = 0; i < bvh.bvs.size(); ++i) {
        Bv& bv = bvh.bvs[i];
        set_rest_box(bv, data[i]);
        bv.vertex_influences = data[i].vertex_influences;
        if (bvh.node.size() + data[i].intervals.size() > std::numeric_limits<std::uint32_t>::max())
            throw std::length_error("build_bvh: over 2^32 weight intervals; use larger leaves");
        bv.first_interval = static_cast<std::uint32_t>(bvh.node.size());
        bv.interval_count = static_cast<std::uint32_t>(data[i].intervals.size());
        for (const Interval& interval : data[i].intervals) {
            bvh.node.push_back(interval.node);
            bvh.l.push_back(interval.l);
            bvh.h.push_back(interval.h);
        }
    }
    return bvh;
}

} // namespace cinch
