// SPDX-License-Identifier: Apache-2.0
#include "cinch/deform.hpp"

#include <stdexcept>

#include "cinch/environment.hpp"
#include "toolkit/deform/parallel.hpp"

namespace cinch {

Vec3 evaluate_vertex(const Vec3& rest, Weights::Row row, std::span<const AffineMap> maps) noexcept
{
    const double x = rest[0], y = rest[1], z = rest[2];
    double sum[3] = {0, 0, 0};
    for (std::size_t i = 0; i < row.node.size(); ++i) {
        const auto& m = maps[row.node[i]].m;
        const double w = row.weight[i];
        for (int r = 0; r < 3; ++r)
            sum[r] = sum[r] + w * (((m[r][0] * x + m[r][1] * y) + m[r][2] * z) + m[r][3]);
    }
    return {sum[0], sum[1], sum[2]};
}

void displace(std::span<const MorphTarget> targets, std::span<const double> weights, std::span<Vec3> rest)
{
    if (weights.size() != targets.size())
        throw std::invalid_argument("displace: one weight per morph target is needed");
    require_default_arithmetic();
    for (std::size_t i = 0; i < targets.size(); ++i)
        for (std::size_t n = 0; n < targets[i].vertex.size(); ++n)
            rest[targets[i].vertex[n]] += weights[i] * targets[i].displacement[n];
}

void evaluate(std::span<const Vec3> rest, const Weights& weights, std::span<const AffineMap> maps, std::span<Vec3> out)
{
    require_default_arithmetic();
    parallel_blocks(rest.size(), 1024, [&](std::size_t first, std::size_t last) {
        for (std::size_t k = first; k < last; ++k)
            out[k] = evaluate_vertex(rest[k], weights.of(k), maps);
    });
}

} // namespace cinch
