// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "toolkit/surface/shapes.hpp"

namespace cinch {
namespace {

constexpr double pi = std::numbers::pi;

// How many vertices each ring gets: proportional to its length, at least three, together exactly `total`.
std::vector<std::size_t> ring_sizes(std::size_t total)
{
    // One vertex of an equilateral triangulation with edge a covers √3/2 a² of the sphere's 4π; rings lie √3/2 a apart.
    const double edge = std::sqrt(4 * pi / (static_cast<double>(total) * std::sqrt(3.0) / 2));
    const auto most = std::max<std::size_t>(1, total / 3);
    const auto rings =
        std::clamp<std::size_t>(static_cast<std::size_t>(std::lround(pi / (edge * std::sqrt(3.0) / 2))) - 1, 1, most);
    std::vector<double> share(rings);
    for (std::size_t i = 0; i < rings; ++i)
        share[i] = std::sin(pi * static_cast<double>(i + 1) / static_cast<double>(rings + 1));
    const double sum = std::accumulate(share.begin(), share.end(), 0.0);
    std::vector<std::size_t> size(rings, 3);
    std::size_t left = total - 3 * rings;
    for (std::size_t i = 0; i < rings; ++i) {
        const double ideal = share[i] / sum * static_cast<double>(total);
        const auto extra = std::min(left, static_cast<std::size_t>(std::max(0.0, ideal - 3)));
        size[i] += extra;
        left -= extra;
    }
    for (std::size_t i = rings / 2; left > 0;
         i = (i + 1) % rings, --left) // a handful; the long rings in the middle take them
        ++size[i];
    return size;
}

} // namespace

TriangleMesh ring_sphere(std::size_t vertices)
{
    if (vertices < 5)
        throw std::invalid_argument("ring_sphere: at least 5 vertices are needed");
    const std::vector<std::size_t> sizes = ring_sizes(vertices - 2);
    TriangleMesh mesh;
    mesh.vertices.emplace_back(0, 0, 1);
    std::vector<std::vector<double>> angle(sizes.size());
    std::vector<std::uint32_t> first;
    for (std::size_t i = 0; i < sizes.size(); ++i) {
        first.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
        const double polar = pi * static_cast<double>(i + 1) / static_cast<double>(sizes.size() + 1);
        for (std::size_t k = 0; k < sizes[i]; ++k) {
            angle[i].push_back(2 * pi * (static_cast<double>(k) + (i % 2 ? 0.5 : 0.0)) / static_cast<double>(sizes[i]));
            mesh.vertices.emplace_back(std::sin(polar) * std::cos(angle[i][k]), std::sin(polar) * std::sin(angle[i][k]),
                                       std::cos(polar));
        }
    }
    mesh.vertices.emplace_back(0, 0, -1);
    const auto south = static_cast<std::uint32_t>(mesh.vertices.size() - 1);

    auto at = [&](std::size_t ring, std::size_t k) {
        return first[ring] + static_cast<std::uint32_t>(k % sizes[ring]);
    };
    for (std::size_t k = 0; k < sizes.front(); ++k)
        mesh.triangles.push_back({0, at(0, k), at(0, k + 1)});
    for (std::size_t ring = 0; ring + 1 < sizes.size(); ++ring) {
        const auto &upper = angle[ring], &lower = angle[ring + 1];
        auto unwrapped = [](const std::vector<double>& a, std::size_t k) {
            return a[k % a.size()] + (k >= a.size() ? 2 * pi : 0.0);
        };
        for (std::size_t u = 0, l = 0; u < upper.size() || l < lower.size();) { // zip the two rings together
            const bool step_upper =
                l == lower.size() || (u < upper.size() && unwrapped(upper, u + 1) < unwrapped(lower, l + 1));
            if (step_upper) {
                mesh.triangles.push_back({at(ring, u), at(ring + 1, l), at(ring, u + 1)});
                ++u;
            } else {
                mesh.triangles.push_back({at(ring, u), at(ring + 1, l), at(ring + 1, l + 1)});
                ++l;
            }
        }
    }
    for (std::size_t k = 0; k < sizes.back(); ++k)
        mesh.triangles.push_back({at(sizes.size() - 1, k), south, at(sizes.size() - 1, k + 1)});
    return mesh;
}

} // namespace cinch
