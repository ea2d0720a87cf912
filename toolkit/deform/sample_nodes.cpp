// SPDX-License-Identifier: Apache-2.0
#include "toolkit/deform/sample_nodes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "cinch/environment.hpp"
#include "toolkit/deform/dyadic.hpp"
#include "toolkit/deform/parallel.hpp"

namespace cinch {
namespace {

struct Crossing {
    double z;
    int sign; // of the triangle's orientation against the ray
};

void lower_distances(const std::vector<Vec3>& points, const Vec3& node, std::vector<double>& squared)
{
    for (std::size_t i = 0; i < points.size(); ++i)
        squared[i] = std::min(squared[i], (points[i] - node).squaredNorm());
}

// The first of those that are farthest but for rounding: on a grid many are, and which of them is greatest by its last
// bits depends on the unit of length.
std::size_t farthest(const std::vector<double>& squared)
{
    const auto most = std::max_element(squared.begin(), squared.end());
    const double tied = *most - *most * 0x1p-40; // NaN where squares overflow, which nothing ties with
    return static_cast<std::size_t>(std::find_if(squared.begin(), most, [&](double x) { return x >= tied; }) -
                                    squared.begin());
}

} // namespace

// One ray along z per column. A column whose crossings do not cancel (open surface) is passed over.
std::vector<Vec3> interior_points(const TriangleMesh& mesh, double points)
{
    Vec3 low = mesh.vertices.front(), high = low;
    for (const Vec3& v : mesh.vertices) {
        low = low.cwiseMin(v);
        high = high.cwiseMax(v);
    }
    const Vec3 size = high - low;
    if (!(size.minCoeff() > 0) || !std::isfinite(size.prod()))
        return {};
    const double unit = std::exp2(std::ilogb(size.maxCoeff())); // bits of the root would depend on the unit of length
    const double cell = unit * std::cbrt((size / unit).prod() / points);
    if (!(size.maxCoeff() / cell < 4096)) // needle-like boxes
        return {};
    const auto columns_x = static_cast<std::size_t>(size.x() / cell) + 1,
               columns_y = static_cast<std::size_t>(size.y() / cell) + 1;
    // Irrational offsets keep the rays off vertices and edges of regular meshes.
    const Vec3 origin = low + cell * Vec3(std::sqrt(2.0) - 1, std::sqrt(3.0) - 1, std::sqrt(5.0) - 2);

    std::vector<std::vector<Crossing>> column(columns_x * columns_y);
    for (const Triangle& t : mesh.triangles) {
        const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
        const double area = (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
        if (area == 0)
            continue;
        auto first = [&](double x, double o) {
            return static_cast<std::size_t>(std::max(0.0, std::ceil((x - o) / cell)));
        };
        const std::size_t x0 = first(std::min({a.x(), b.x(), c.x()}), origin.x()),
                          x1 = first(std::max({a.x(), b.x(), c.x()}), origin.x());
        const std::size_t y0 = first(std::min({a.y(), b.y(), c.y()}), origin.y()),
                          y1 = first(std::max({a.y(), b.y(), c.y()}), origin.y());
        for (std::size_t i = x0; i < std::min(x1, columns_x); ++i)
            for (std::size_t j = y0; j < std::min(y1, columns_y); ++j) {
                const double x = origin.x() + cell * static_cast<double>(i),
                             y = origin.y() + cell * static_cast<double>(j);
                const double u = ((x - a.x()) * (c.y() - a.y()) - (y - a.y()) * (c.x() - a.x())) / area;
                const double v = ((b.x() - a.x()) * (y - a.y()) - (b.y() - a.y()) * (x - a.x())) / area;
                if (u >= 0 && v >= 0 && u + v <= 1)
                    column[i * columns_y + j].push_back(
                        {a.z() + u * (b.z() - a.z()) + v * (c.z() - a.z()), area > 0 ? 1 : -1});
            }
    }

    std::vector<Vec3> inside;
    for (std::size_t i = 0; i < columns_x; ++i)
        for (std::size_t j = 0; j < columns_y; ++j) {
            auto& crossings = column[i * columns_y + j];
            std::sort(crossings.begin(), crossings.end(),
                      [](const Crossing& p, const Crossing& q) { return p.z < q.z; });
            int winding = 0;
            for (const Crossing& c : crossings)
                winding += c.sign;
            if (winding != 0)
                continue;
            for (std::size_t c = 0; c + 1 < crossings.size(); ++c) {
                winding += crossings[c].sign;
                if (winding == 0)
                    continue;
                for (double k = std::ceil((crossings[c].z - origin.z()) / cell);
                     origin.z() + cell * k < crossings[c + 1].z; ++k)
                    inside.emplace_back(origin.x() + cell * static_cast<double>(i),
                                        origin.y() + cell * static_cast<double>(j), origin.z() + cell * k);
            }
        }
    return inside;
}

SimulationNodes sample_nodes(const TriangleMesh& mesh, std::size_t count, std::uint64_t seed)
{
    require_default_arithmetic();
    if (mesh.vertices.empty() || count == 0)
        throw std::invalid_argument("sample_nodes: a mesh with vertices and a count of at least 1 are needed");
    std::vector<Vec3> points = interior_points(mesh, std::clamp(400.0 * static_cast<double>(count), 1e5, 5e5));
    points.insert(points.end(), mesh.vertices.begin(), mesh.vertices.end()); // the closed volume

    constexpr double infinity = std::numeric_limits<double>::infinity();
    std::vector<double> squared(points.size(), infinity);
    SimulationNodes nodes;
    std::size_t next = static_cast<std::size_t>((seed * 0x9e3779b97f4a7c15u) % points.size()); // spreads small seeds
    while (nodes.position.size() < count) {
        if (squared[next] == 0)
            break; // every point is a node already
        nodes.position.push_back(points[next]);
        lower_distances(points, points[next], squared);
        next = farthest(squared);
    }
    nodes.fill_distance = std::sqrt(squared[next]);
    return nodes;
}

Weights kernel_weights(const TriangleMesh& mesh, const SimulationNodes& nodes, double support, std::size_t* alone)
{
    require_default_arithmetic();
    const double h = support * nodes.fill_distance;
    struct VertexRow {
        std::vector<std::uint32_t> node;
        std::vector<double> weight;
        bool alone = false;
    };
    std::vector<VertexRow> rows(mesh.vertices.size());
    parallel_blocks(rows.size(), 256, [&](std::size_t first, std::size_t last) {
        for (std::size_t k = first; k < last; ++k) {
            VertexRow& row = rows[k];
            std::uint32_t nearest = 0;
            double nearest_squared = std::numeric_limits<double>::infinity();
            for (std::size_t j = 0; j < nodes.position.size(); ++j) {
                const double r2 = (mesh.vertices[k] - nodes.position[j]).squaredNorm();
                if (r2 < nearest_squared) {
                    nearest_squared = r2;
                    nearest = static_cast<std::uint32_t>(j);
                }
                const double s = 1 - r2 / (h * h); // NaN for h = 0: no entry
                if (s > 0) {
                    row.node.push_back(static_cast<std::uint32_t>(j));
                    row.weight.push_back(s * s * s);
                }
            }
            if (row.node.empty()) {
                row.alone = nearest_squared > 0; // on a node, with no reach at all, is as it should be
                row.node = {nearest};
                row.weight = {1};
            }
        }
    });
    Influences influences;
    influences.node_count = static_cast<std::uint32_t>(nodes.position.size());
    std::size_t count = 0;
    for (const VertexRow& row : rows) {
        influences.node.insert(influences.node.end(), row.node.begin(), row.node.end());
        influences.weight.insert(influences.weight.end(), row.weight.begin(), row.weight.end());
        influences.row.push_back(static_cast<std::uint32_t>(influences.node.size()));
        count += row.alone;
    }
    if (alone)
        *alone = count;
    return to_dyadic(influences);
}

} // namespace cinch
