// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "cinch/deform.hpp"
#include "toolkit/collide/triangle_pair.hpp"
#include "toolkit/hierarchy/lazy_refit.hpp"

namespace cinch {

/// Pairs of triangles of two deformed bodies by exact predicates on the vertices of evaluate_vertex, or those given.
/// Remembers the last triangle of each.
class ExactPair {
public:
    ExactPair(const DeformableSurface& a, const BodyFrame& frame_a, const DeformableSurface& b,
              const BodyFrame& frame_b)
        : a_{a, frame_a, {}, {}, {}}, b_{b, frame_b, {}, {}, {}}
    {
    }
    bool intersect(std::uint32_t triangle_a, std::uint32_t triangle_b)
    {
        a_.place(triangle_a);
        b_.place(triangle_b);
        for (int r = 0; r < 3; ++r)
            if (a_.high[r] < b_.low[r] || b_.high[r] < a_.low[r]) { // exact; false for NaN
                ++in_double_;
                return false;
            }
        OrientationCounts counts;
        const bool answer = cinch::intersect(a_.points, b_.points, &counts);
        ++(counts.in_expansion + counts.in_integer > 0 ? in_exact_ : in_double_);
        return answer;
    }
    std::uint64_t in_double() const { return in_double_; } ///< decided by filtered signs
    std::uint64_t in_exact() const { return in_exact_; }   ///< with at least one sign by exact arithmetic

private:
    struct Body {
        const DeformableSurface& surface;
        BodyFrame frame;
        TrianglePoints points;
        Vec3 low, high;
        std::uint32_t triangle = ~0u;

        void place(std::uint32_t t)
        {
            if (t == triangle)
                return;
            triangle = t;
            for (std::size_t c = 0; c < 3; ++c) {
                const std::uint32_t k = surface.mesh.triangles[t][c];
                points[c] = frame.positions.empty()
                                ? evaluate_vertex(surface.mesh.vertices[k], surface.weights.of(k), frame.maps)
                                : frame.positions[k];
            }
            low = points[0].cwiseMin(points[1]).cwiseMin(points[2]);
            high = points[0].cwiseMax(points[1]).cwiseMax(points[2]);
        }
    };
    Body a_, b_;
    std::uint64_t in_double_ = 0, in_exact_ = 0;
};

} // namespace cinch
