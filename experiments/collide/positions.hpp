// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cinch/deform.hpp"
#include "experiments/collide/backend.hpp"
#include "toolkit/collide/triangle_pair.hpp"

namespace cinch {

/// What all backends share that evaluate every vertex: the vertices of evaluate_vertex, by SIMD, and the exact test.
class Positions {
public:
    explicit Positions(const CollideScene& scene);

    void evaluate(std::size_t frame);
    const std::vector<Vec3>& of(std::size_t body) const { return positions_[body]; }
    const TriangleMesh& mesh(std::size_t body) const { return scene_.bodies[body].surface.mesh; }
    std::size_t bodies() const { return positions_.size(); }
    TrianglePoints triangle(std::size_t body, std::uint32_t t) const
    {
        const Triangle& corners = mesh(body).triangles[t];
        return {positions_[body][corners[0]], positions_[body][corners[1]], positions_[body][corners[2]]};
    }
    /// Their boxes first, then exactly.
    bool intersect(std::size_t a, std::uint32_t triangle_a, std::size_t b, std::uint32_t triangle_b) const;
    std::size_t bytes() const;

private:
    const CollideScene& scene_;
    std::vector<SurfaceEvaluator<double>> evaluators_;
    std::vector<std::vector<Vec3>> positions_;
};

} // namespace cinch
