// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <Eigen/Eigenvalues>

#include "toolkit/bounds/rounding.hpp"
#include "toolkit/deform/dyadic.hpp"
#include "toolkit/deform/parallel.hpp"
#include "toolkit/hierarchy/rest_data.hpp"

namespace cinch {
namespace {

// Covariance inverted where it is not flat.
Eigen::Matrix3d pseudo_inverse(const Eigen::Matrix3d& covariance)
{
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(covariance);
    const Vec3 values = eigen.eigenvalues();
    Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();
    for (int i = 0; i < 3; ++i)
        if (values[i] > 1e-10 * values[2])
            inverse += eigen.eigenvectors().col(i) * eigen.eigenvectors().col(i).transpose() / values[i];
    return inverse;
}

// What a weight of this vertex adds to the model's residual and moment. δ = w − mean is exact, y is off by u|y|; a
// product of gradient·y passes 5 roundings, so |ρ̂ − ρ| ≤ γ₅(|δ| + Σ|g_i y_i|) and underflow; 8u leaves room for the
// sum's own roundings.
void include(WeightModel& model, double weight, const Vec3& y)
{
    const double delta = weight - model.mean;
    const Vec3 terms = model.gradient.cwiseProduct(y);
    const double rho = delta - ((terms[0] + terms[1]) + terms[2]);
    const double magnitude = std::abs(delta) + terms.lpNorm<1>();
    const double residual = succ(std::abs(rho) + (8 * unit_roundoff * magnitude + 8 * smallest_subnormal));
    model.residual = residual <= model.residual ? model.residual : residual; // NaN goes in
    for (int i = 0; i < 3; ++i) {
        const double product = std::abs(delta) * std::abs(y[i]); // two roundings
        if (delta != 0 && y[i] != 0)                             // the product may vanish all the same
            model.moment[i] =
                std::max(model.moment[i], succ(product + (4 * unit_roundoff * product + smallest_subnormal)));
    }
}

// A difference, squares, sums and the root pass 5 roundings.
void include_in_ball(const Vec3& x, Bvh& bvh, std::size_t influence)
{
    const Vec3 r = x - bvh.local[influence].centre;
    const double most = r.lpNorm<Eigen::Infinity>(),
                 distance = most > 0x1p-500 && most < 0x1p500 ? r.norm() : r.lpNorm<1>();
    if (distance > 0)
        bvh.radius[influence] = std::max(bvh.radius[influence], succ(distance * (1 + 16 * unit_roundoff)));
}

void fit(const DeformableSurface& surface, std::span<const std::uint32_t> vertices, Bvh& bvh, Bv& bv)
{
    const auto nodes = std::span(bvh.node).subspan(bv.first_influence, bv.influence_count);
    const auto models = std::span(bvh.model).subspan(bv.first_influence, bv.influence_count);
    static thread_local std::vector<std::uint32_t> place;
    place.resize(std::max<std::size_t>(place.size(), surface.weights.node_count));
    for (std::uint32_t j = 0; j < nodes.size(); ++j)
        place[nodes[j]] = j;

    const double count = static_cast<double>(vertices.size());
    bv.pivot = Vec3::Zero();
    for (std::uint32_t k : vertices)
        bv.pivot += surface.mesh.vertices[k] / count;
    Vec3 low = surface.mesh.vertices[vertices[0]], high = low;
    for (std::uint32_t k : vertices) {
        low = low.cwiseMin(surface.mesh.vertices[k]);
        high = high.cwiseMax(surface.mesh.vertices[k]);
    }
    bv.pivot =
        bv.pivot.cwiseMax(low).cwiseMin(high); // inside whatever rounding did; on flat BVs exactly in their plane
    const double unit = bv.box.half.maxCoeff() > 0 ? bv.box.half.maxCoeff() : 1;
    std::vector<double> mean(nodes.size(), 0.0);
    std::vector<Vec3> cross(nodes.size(), Vec3::Zero());
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (std::uint32_t k : vertices) {
        const Vec3 y = (surface.mesh.vertices[k] - bv.pivot) / unit;
        covariance += y * y.transpose();
        const Weights::Row row = surface.weights.of(k);
        for (std::size_t i = 0; i < row.node.size(); ++i) {
            mean[place[row.node[i]]] += row.weight[i] / count;
            cross[place[row.node[i]]] += row.weight[i] * y;
        }
    }
    round_dyadic(mean);
    const Eigen::Matrix3d inverse = pseudo_inverse(covariance);
    for (std::size_t j = 0; j < nodes.size(); ++j) {
        models[j].mean = mean[j];
        const Vec3 gradient = inverse * cross[j] / unit;
        if (std::isfinite(gradient.sum()))
            models[j].gradient = gradient;
    }
    std::vector<std::uint8_t> influences(nodes.size(), 0);
    for (std::uint32_t k : vertices) {
        const Vec3 y = surface.mesh.vertices[k] - bv.pivot;
        const Weights::Row row = surface.weights.of(k);
        for (std::size_t i = 0; i < row.node.size(); ++i) {
            include_in_ball(surface.mesh.vertices[k], bvh, bv.first_influence + place[row.node[i]]);
            include(models[place[row.node[i]]], row.weight[i], y);
            influences[place[row.node[i]]] = 1;
        }
        for (std::size_t j = 0; j < nodes.size(); ++j) {
            if (!influences[j])
                include(models[j], 0, y);
            influences[j] = 0;
        }
    }
}

} // namespace

void fit_weight_models(const DeformableSurface& surface, Bvh& bvh)
{
    bvh.model.assign(bvh.node.size(), {});
    bvh.radius.assign(bvh.node.size(), 0.0);
    parallel_blocks(bvh.bvs.size(), 16, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i)
            fit(surface, vertices_of(surface, bvh, bvh.bvs[i]), bvh, bvh.bvs[i]);
    });
}

} // namespace cinch
