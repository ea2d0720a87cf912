// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/collide/positions.hpp"

#include <algorithm>

namespace cinch {

Positions::Positions(const CollideScene& scene) : scene_(scene)
{
    for (const Input& body : scene.bodies) {
        evaluators_.emplace_back(body.surface);
        positions_.emplace_back(body.surface.mesh.vertices.size());
    }
}

void Positions::evaluate(std::size_t frame)
{
    for (std::size_t b = 0; b < positions_.size(); ++b)
        evaluators_[b](scene_.maps(b, frame), positions_[b]);
}

bool Positions::intersect(std::size_t a, std::uint32_t triangle_a, std::size_t b, std::uint32_t triangle_b) const
{
    const TrianglePoints p = triangle(a, triangle_a), q = triangle(b, triangle_b);
    for (int r = 0; r < 3; ++r)
        if (std::max({p[0][r], p[1][r], p[2][r]}) < std::min({q[0][r], q[1][r], q[2][r]}) ||
            std::max({q[0][r], q[1][r], q[2][r]}) < std::min({p[0][r], p[1][r], p[2][r]}))
            return false;
    return cinch::intersect(p, q);
}

std::size_t Positions::bytes() const
{
    std::size_t bytes = 0;
    for (const auto& p : positions_)
        bytes += p.size() * sizeof(Vec3);
    return bytes;
}

std::vector<std::pair<std::uint32_t, std::uint32_t>> overlapping_bodies(const std::vector<Vec3>& low,
                                                                        const std::vector<Vec3>& high)
{
    std::vector<std::uint32_t> order(low.size());
    for (std::uint32_t i = 0; i < order.size(); ++i)
        order[i] = i;
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return low[a][0] < low[b][0]; });
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (std::size_t i = 0; i < order.size(); ++i)
        for (std::size_t j = i + 1; j < order.size() && low[order[j]][0] <= high[order[i]][0]; ++j)
            if ((low[order[i]].array() <= high[order[j]].array()).all() &&
                (low[order[j]].array() <= high[order[i]].array()).all())
                pairs.push_back(std::minmax(order[i], order[j]));
    std::sort(pairs.begin(), pairs.end());
    return pairs;
}

} // namespace cinch
