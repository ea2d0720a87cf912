// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/contact_points.hpp"

namespace cinch {

Vec3 ContactPoints::blend(const Configuration& c, std::size_t k, const Field& x, const MatrixField& j) const
{
    const DeformableSurface* const s = surface(c);
    if (!s)
        return at(x, k);
    Vec3 sum = Vec3::Zero();
    const Weights::Row row = s->weights.of(k);
    for (std::size_t e = 0; e < row.node.size(); ++e) {
        const std::uint32_t i = row.node[e];
        sum += row.weight[e] * (at(x, i) + matrix_at(j, i) * (s->mesh.vertices[k] - c.body.rest[i]));
    }
    return sum;
}

void ContactPoints::add_force(const Configuration& c, std::size_t k, const Vec3& force, Forces out) const
{
    const DeformableSurface* const s = surface(c);
    if (!s) {
        at(out.force, k) += force;
        return;
    }
    const Weights::Row row = s->weights.of(k);
    for (std::size_t e = 0; e < row.node.size(); ++e) {
        const std::uint32_t i = row.node[e];
        at(out.force, i) += row.weight[e] * force;
        matrix_at(out.stress, i) += row.weight[e] * force * (s->mesh.vertices[k] - c.body.rest[i]).transpose();
    }
}

} // namespace cinch
