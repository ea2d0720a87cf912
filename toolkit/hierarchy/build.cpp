// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <numeric>
#include <stdexcept>

#include <Eigen/Eigenvalues>

#include "toolkit/hierarchy/cluster.hpp"
#include "toolkit/hierarchy/rest_data.hpp"

#include "cinch/environment.hpp"
#include "toolkit/surface/triangle_mesh.hpp"

namespace cinch {
namespace {

// Orders `units` so that the halves lie on either side of the median along the longest covariance axis.
void split(std::span<std::uint32_t> units, std::span<const Vec3> centroid)
{
    Vec3 mean = Vec3::Zero();
    for (std::uint32_t t : units)
        mean += centroid[t];
    mean /= static_cast<double>(units.size());
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (std::uint32_t t : units)
        covariance += (centroid[t] - mean) * (centroid[t] - mean).transpose();
    const Vec3 axis = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvectors().col(2);
    auto key = [&](std::uint32_t t) { return std::pair(axis.dot(centroid[t]), t); };
    std::nth_element(units.begin(), units.begin() + static_cast<std::ptrdiff_t>(units.size() / 2), units.end(),
                     [&](std::uint32_t s, std::uint32_t t) { return key(s) < key(t); });
}

// A tree over what has these centroids, triangles for now: splits what is more than `leaf`. Sets everything about
// triangles.
void split_all(std::span<const Vec3> centroid, std::size_t leaf, Bvh& bvh)
{
    bvh.triangle.resize(centroid.size());
    std::iota(bvh.triangle.begin(), bvh.triangle.end(), 0u);
    Bv root;
    root.triangle_count = static_cast<std::uint32_t>(centroid.size());
    bvh.bvs.push_back(root);
    for (std::size_t begin = 0; begin < bvh.bvs.size();) { // one level per round
        bvh.level.push_back(static_cast<std::uint32_t>(begin));
        const std::size_t end = bvh.bvs.size();
        for (; begin < end; ++begin) {
            const auto first = bvh.bvs[begin].first_triangle, count = bvh.bvs[begin].triangle_count;
            if (count <= leaf)
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
}

// Puts the triangles of every cluster in the cluster's place.
void expand(const Clusters& clusters, Bvh& bvh)
{
    std::vector<std::uint32_t> triangle, begin; // begin: where the triangles of the cluster in each place now begin
    for (const std::uint32_t c : bvh.triangle) {
        begin.push_back(static_cast<std::uint32_t>(triangle.size()));
        triangle.insert(triangle.end(), clusters.triangle.begin() + clusters.first[c],
                        clusters.triangle.begin() + clusters.first[c + 1]);
    }
    begin.push_back(static_cast<std::uint32_t>(triangle.size()));
    for (Bv& bv : bvh.bvs) {
        const std::uint32_t first = begin[bv.first_triangle], end = begin[bv.first_triangle + bv.triangle_count];
        bv.first_triangle = first;
        bv.triangle_count = end - first;
    }
    bvh.triangle = std::move(triangle);
}

std::vector<Vec3> mean_of_each(const Clusters& clusters, std::span<const Vec3> centroid)
{
    std::vector<Vec3> mean;
    for (std::size_t c = 0; c < clusters.count(); ++c) {
        Vec3 sum = Vec3::Zero();
        for (std::uint32_t i = clusters.first[c]; i < clusters.first[c + 1]; ++i)
            sum += centroid[clusters.triangle[i]];
        mean.push_back(sum / static_cast<double>(clusters.first[c + 1] - clusters.first[c]));
    }
    return mean;
}

void require_weights_of_mesh(const DeformableSurface& surface)
{
    if (surface.weights.vertex_count() != surface.mesh.vertices.size())
        throw std::invalid_argument("build_bvh: the weights are not those of the mesh");
}

Bvh with_rest_data(const DeformableSurface& surface, Bvh bvh, RestDetail detail)
{
    bvh.detail = detail;
    set_boxes(surface, bvh);
    orient_boxes(surface, bvh);
    if (detail == RestDetail::boxes) {
        for (Bv& bv : bvh.bvs)
            bv.pivot = bv.box.centre;
        return bvh;
    }
    fit_weight_models(surface, bvh);
    choose_points(surface, bvh, detail == RestDetail::all);
    return bvh;
}

// The surface's triangles where they are grouped.
const TriangleMesh& laid_out(const DeformableSurface& surface, TriangleMesh& kept)
{
    if (surface.layout.empty())
        return surface.mesh;
    if (surface.layout.size() != surface.mesh.vertices.size())
        throw std::invalid_argument("build_bvh: the layout is not that of the mesh");
    return kept = {surface.layout, surface.mesh.triangles};
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

} // namespace

Bvh build_bvh(const DeformableSurface& surface, std::size_t leaf_triangles, RestDetail detail)
{
    require_default_arithmetic();
    if (leaf_triangles == 0)
        throw std::invalid_argument("build_bvh: a leaf needs at least one triangle");
    require_weights_of_mesh(surface);
    if (surface.mesh.triangles.empty())
        return {};
    Bvh bvh;
    TriangleMesh kept;
    split_all(scaled_centroids(laid_out(surface, kept)), leaf_triangles, bvh);
    return with_rest_data(surface, std::move(bvh), detail);
}

Bvh build_bvh(const DeformableSurface& surface, ClusterSize leaf, RestDetail detail)
{
    require_default_arithmetic();
    if (leaf.triangles == 0 || leaf.vertices < 3)
        throw std::invalid_argument("build_bvh: a leaf needs room for a triangle and its vertices");
    require_weights_of_mesh(surface);
    if (surface.mesh.triangles.empty())
        return {};
    TriangleMesh kept;
    const TriangleMesh& mesh = laid_out(surface, kept);
    const std::vector<Vec3> centroid = scaled_centroids(mesh);
    Bvh near; // only for the order of its triangles
    split_all(centroid, 1, near);
    const Clusters clusters = cluster_triangles(mesh, near.triangle, leaf);
    Bvh bvh;
    split_all(mean_of_each(clusters, centroid), 1, bvh);
    expand(clusters, bvh);
    return with_rest_data(surface, std::move(bvh), detail);
}

std::vector<std::uint32_t> vertices_of(const DeformableSurface& surface, const Bvh& bvh, const Bv& bv)
{
    static thread_local std::vector<bool> seen; // all false between calls
    seen.resize(std::max(seen.size(), surface.mesh.vertices.size()));
    std::vector<std::uint32_t> vertices;
    for (std::uint32_t t : std::span(bvh.triangle).subspan(bv.first_triangle, bv.triangle_count))
        for (std::uint32_t v : surface.mesh.triangles[t])
            if (!seen[v]) {
                seen[v] = true;
                vertices.push_back(v);
            }
    for (std::uint32_t v : vertices)
        seen[v] = false;
    return vertices;
}

} // namespace cinch
