// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <vector>

#include "toolkit/surface/shapes.hpp"

namespace cinch {
namespace {

using Distance = std::function<double(const Vec3&)>;

// Radius of the outermost crossing of the ray along the unit vector d: sphere tracing inwards, then bisection.
double outermost_radius(const Distance& distance, const Vec3& d)
{
    double outside = 3, inside = 0;
    for (;;) {
        const double step = std::max(0.8 * distance(outside * d), 2e-3);
        if (outside - step <= 0)
            break;
        if (distance((outside - step) * d) <= 0) {
            inside = outside - step;
            break;
        }
        outside -= step;
    }
    for (int i = 0; i < 12; ++i) {
        const double middle = 0.5 * (inside + outside);
        (distance(middle * d) > 0 ? outside : inside) = middle;
    }
    return outside;
}

Vec3 gradient(const Distance& distance, const Vec3& p)
{
    constexpr double h = 1e-5;
    Vec3 g;
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3 step = h * Vec3::Unit(axis);
        g[axis] = (distance(p + step) - distance(p - step)) / (2 * h);
    }
    return g;
}

using Neighbours = std::vector<std::vector<std::uint32_t>>;

// Jacobi sweeps of smoothing, each followed by Newton steps back onto the surface: rounds off the walls that rays from
// the origin leave where one part of the surface hides another.
void smooth(std::vector<Vec3>& point, const Neighbours& neighbours, const Distance& distance, int sweeps)
{
    std::vector<Vec3> next(point.size());
    while (sweeps-- > 0) {
        for (std::size_t k = 0; k < point.size(); ++k) {
            Vec3 mean = Vec3::Zero();
            for (std::uint32_t n : neighbours[k])
                mean += point[n];
            Vec3 p = point[k] + 0.5 * (mean / static_cast<double>(neighbours[k].size()) - point[k]);
            for (int newton = 0; newton < 2; ++newton) {
                const Vec3 g = gradient(distance, p);
                if (g.squaredNorm() > 1e-6)
                    p -= std::clamp(distance(p), -0.1, 0.1) / g.squaredNorm() * g;
            }
            next[k] = p;
        }
        point.swap(next);
    }
}

} // namespace

void wrap(TriangleMesh& sphere, const Distance& distance)
{
    std::vector<Vec3>& direction = sphere.vertices;
    const std::size_t count = direction.size();
    Neighbours neighbours(count);
    for (const Triangle& t : sphere.triangles)
        for (std::size_t i = 0; i < 3; ++i)
            neighbours[t[i]].push_back(t[(i + 1) % 3]); // closed and oriented: every neighbour once

    // The surface stays r(d)·d; only the directions move. Each goes to the mean of its neighbours, weighted by the
    // length of the edge on the surface, so that long edges (along a limb) draw vertices in until edges are even.
    std::vector<Vec3> next(count), point(count);
    auto place = [&] {
        for (std::size_t k = 0; k < count; ++k)
            point[k] = outermost_radius(distance, direction[k]) * direction[k];
    };
    for (int sweep = 0; sweep < 60; ++sweep) {
        place();
        for (std::size_t k = 0; k < count; ++k) {
            Vec3 sum = Vec3::Zero();
            double weight = 0;
            for (std::uint32_t n : neighbours[k]) {
                const double length = (point[n] - point[k]).norm();
                sum += length * direction[n];
                weight += length;
            }
            next[k] = (0.3 * direction[k] + 0.7 * sum / weight).normalized();
        }
        direction.swap(next);
    }
    place();
    smooth(point, neighbours, distance, 4);
    direction.swap(point);
}

} // namespace cinch
