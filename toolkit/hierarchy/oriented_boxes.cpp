// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "toolkit/bounds/rounding.hpp"
#include "toolkit/deform/parallel.hpp"
#include "toolkit/hierarchy/rest_data.hpp"

namespace cinch {
namespace {

// Along the eigenvectors Q of the covariance. x − c = Q Qᵀ(x − c) + (I − QQᵀ)(x − c), and Q is orthogonal to a few u:
// extents that are 256u·|x − c|₁ larger than Qᵀ(x − c) as computed leave room for that, for the products and for
// rounding extent times axis.
OrientedBox around(const TriangleMesh& mesh, std::span<const std::uint32_t> vertices, const RestBox& box)
{
    OrientedBox out;
    const double unit = box.half.maxCoeff();
    if (!(unit > 0x1p-900 && unit < 0x1p900)) { // a point, or too small or large to square: the box as it is
        out.centre = box.centre;
        for (int i = 0; i < 3; ++i)
            out.axis[i][i] = box.half[i];
        return out;
    }
    Vec3 mean = Vec3::Zero();
    for (std::uint32_t k : vertices)
        mean += (mesh.vertices[k] - box.centre) / unit / static_cast<double>(vertices.size());
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (std::uint32_t k : vertices) {
        const Vec3 y = (mesh.vertices[k] - box.centre) / unit - mean;
        covariance += y * y.transpose();
    }
    const Eigen::Matrix3d q = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvectors();
    Vec3 low = Vec3::Constant(infinite), high = -low;
    for (std::uint32_t k : vertices) {
        const Vec3 along = q.transpose() * (mesh.vertices[k] - box.centre);
        low = low.cwiseMin(along);
        high = high.cwiseMax(along);
    }
    out.centre = box.centre + q * (0.5 * low + 0.5 * high);
    Vec3 extent = Vec3::Zero();
    for (std::uint32_t k : vertices) {
        const Vec3 y = mesh.vertices[k] - out.centre;
        extent = extent.cwiseMax((q.transpose() * y).cwiseAbs() + Vec3::Constant(256 * unit_roundoff * y.lpNorm<1>()));
    }
    for (int i = 0; i < 3; ++i)
        out.axis[i] = (extent[i] * (1 + 32 * unit_roundoff)) * q.col(i);
    return out;
}

} // namespace

void orient_boxes(const DeformableSurface& surface, Bvh& bvh)
{
    parallel_blocks(bvh.bvs.size(), 64, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i)
            bvh.bvs[i].oriented = around(surface.mesh, vertices_of(surface, bvh, bvh.bvs[i]), bvh.bvs[i].box);
    });
}

} // namespace cinch
