// SPDX-License-Identifier: Apache-2.0
#include "toolkit/hierarchy/spheres.hpp"

#include <algorithm>
#include <cmath>

#include "toolkit/bounds/rounding.hpp"
#include "toolkit/deform/parallel.hpp"
#include "toolkit/surface/length.hpp"

namespace cinch {

std::vector<Vec3> node_places(const DeformableSurface& surface)
{
    std::vector<Vec3> place(surface.weights.node_count, Vec3::Zero());
    std::vector<double> weight(surface.weights.node_count, 0.0);
    for (std::size_t k = 0; k < surface.mesh.vertices.size(); ++k) {
        const Weights::Row row = surface.weights.of(k);
        for (std::size_t i = 0; i < row.node.size(); ++i) {
            place[row.node[i]] += row.weight[i] * surface.mesh.vertices[k];
            weight[row.node[i]] += row.weight[i];
        }
    }
    for (std::size_t j = 0; j < place.size(); ++j)
        if (weight[j] > 0)
            place[j] /= weight[j];
    return place;
}

RestSpheres rest_spheres(const Bvh& bvh, const DeformableSurface& surface)
{
    RestSpheres out;
    out.place = node_places(surface);
    out.radius.assign(bvh.bvs.size(), 0.0);
    out.influence.assign(bvh.node.size(), {});
    parallel_blocks(bvh.bvs.size(), 16, [&](std::size_t first, std::size_t last) {
        std::vector<double> weight(surface.weights.node_count, 0.0); // of one vertex, dense
        for (std::size_t i = first; i < last; ++i) {
            const Bv& bv = bvh.bvs[i];
            const auto vertices = vertices_of(surface, bvh, bv);
            const auto influences = std::span(out.influence).subspan(bv.first_influence, bv.influence_count);
            auto each_vertex = [&](auto&& visit) {
                for (std::uint32_t k : vertices) {
                    const Weights::Row row = surface.weights.of(k);
                    for (std::size_t e = 0; e < row.node.size(); ++e)
                        weight[row.node[e]] = row.weight[e];
                    for (SphereInfluence& j : influences)
                        visit(j, weight[j.node], surface.mesh.vertices[k] - out.place[j.node]);
                    for (std::uint32_t node : row.node)
                        weight[node] = 0;
                }
            };
            for (std::size_t j = 0; j < influences.size(); ++j) {
                influences[j].node = bvh.node[bv.first_influence + j];
                influences[j].mean = bvh.model[bv.first_influence + j].mean;
            }
            each_vertex([&](SphereInfluence& j, double w, const Vec3& y) {
                j.moment += w * y / static_cast<double>(vertices.size());
            });
            each_vertex([&](SphereInfluence& j, double w, const Vec3& y) {
                j.weight_spread = std::max(j.weight_spread, std::abs(w - j.mean)); // dyadic: exact
                // y, the product, the difference and the norm pass fewer than 8 roundings.
                const double spread = length(w * y - j.moment),
                             slop = 16 * unit_roundoff * (w * y.lpNorm<1>() + j.moment.lpNorm<1>());
                j.moment_spread = std::max(j.moment_spread, succ(spread + slop));
            });
            for (std::uint32_t k : vertices) {
                const Vec3 y = surface.mesh.vertices[k] - bv.box.centre;
                out.radius[i] = std::max(out.radius[i], succ(length(y) * (1 + 16 * unit_roundoff)));
            }
        }
    });
    return out;
}

} // namespace cinch
