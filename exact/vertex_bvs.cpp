// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/vertex_bvs.hpp"

#include <algorithm>
#include <cmath>

namespace cinch::exact {

VertexBvs::VertexBvs(const DeformableSurface& surface, const Bvh& bvh) : row{0}
{
    std::vector<std::vector<std::uint32_t>> containing(surface.mesh.vertices.size());
    for (std::uint32_t i = 0; i < bvh.bvs.size(); ++i) {
        const Bv& of = bvh.bvs[i];
        for (std::uint32_t t = of.first_triangle; t < of.first_triangle + of.triangle_count; ++t)
            for (const std::uint32_t v : surface.mesh.triangles[bvh.triangle[t]])
                if (containing[v].empty() || containing[v].back() != i)
                    containing[v].push_back(i);
    }
    for (std::uint32_t v = 0; v < containing.size(); ++v)
        if (!containing[v].empty()) {
            vertex.push_back(v);
            bv.insert(bv.end(), containing[v].begin(), containing[v].end());
            row.push_back(static_cast<std::uint32_t>(bv.size()));
        }
}

std::vector<double> VertexBvs::least(std::span<const double> supports, std::size_t k) const
{
    std::vector<double> out(vertex.size() * k, HUGE_VAL);
    for (std::size_t i = 0; i < vertex.size(); ++i)
        for (std::uint32_t n = row[i]; n < row[i + 1]; ++n)
            for (std::size_t d = 0; d < k; ++d) {
                const double support = supports[bv[n] * k + d];
                out[i * k + d] = std::isnan(support) ? -HUGE_VAL : std::min(out[i * k + d], support);
            }
    return out;
}

} // namespace cinch::exact
