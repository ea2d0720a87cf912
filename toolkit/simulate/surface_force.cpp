// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/surface_force.hpp"

namespace cinch {
namespace {

Vec3 blend(const Configuration& c, std::size_t k, const Field& x, const MatrixField& j)
{
    if (!c.surface)
        return at(x, k);
    Vec3 sum = Vec3::Zero();
    const Weights::Row row = c.surface->weights.of(k);
    for (std::size_t e = 0; e < row.node.size(); ++e) {
        const std::uint32_t i = row.node[e];
        sum += row.weight[e] * (at(x, i) + matrix_at(j, i) * (c.surface->mesh.vertices[k] - c.body.rest[i]));
    }
    return sum;
}

} // namespace

std::size_t points_of(const Configuration& c) { return c.surface ? c.surface->mesh.vertices.size() : c.body.size(); }
Vec3 point(const Configuration& c, std::size_t k) { return blend(c, k, c.x, c.deformation); }
Vec3 point_change(const Configuration& c, std::size_t k, const Field& dx, const MatrixField& dj)
{
    return blend(c, k, dx, dj);
}

void add_point_force(const Configuration& c, std::size_t k, const Vec3& force, Forces out)
{
    if (!c.surface) {
        at(out.force, k) += force;
        return;
    }
    const Weights::Row row = c.surface->weights.of(k);
    for (std::size_t e = 0; e < row.node.size(); ++e) {
        const std::uint32_t i = row.node[e];
        at(out.force, i) += row.weight[e] * force;
        matrix_at(out.stress, i) += row.weight[e] * force * (c.surface->mesh.vertices[k] - c.body.rest[i]).transpose();
    }
}

} // namespace cinch
