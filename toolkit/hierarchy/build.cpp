// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <numeric>
#include <stdexcept>

#include <Eigen/Eigenvalues>

#include "toolkit/hierarchy/rest_data.hpp"

namespace cinch {
namespace {

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

    set_boxes(surface, bvh);
    orient_boxes(surface, bvh);
    fit_weight_models(surface, bvh);
    choose_points(surface, bvh);
    return bvh;
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
