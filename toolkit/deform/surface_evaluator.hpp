// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "toolkit/deform/aligned.hpp"
#include "toolkit/deform/surface.hpp"

namespace cinch {

/// Evaluates all vertices of one surface, frame after frame, by SIMD: groups of 8 vertices that lie near each other, one in a lane, go
/// through the simulation nodes that influence any of them, with weight 0 where a node does not. The positions are those of
/// evaluate_vertex, bit for bit: a term of 0 changes no sum that began at +0.
/// The surface must stay as it is, and alive.
class SurfaceEvaluator {
public:
    explicit SurfaceEvaluator(const DeformableSurface& surface);

    /// `out` has a place per vertex. In parallel. Non-finite maps give non-finite coordinates where they have weight, and nowhere else.
    void operator()(std::span<const AffineMap> maps, std::span<Vec3> out) const;

private:
    struct alignas(64) Group {
        double rest[3][8];
        std::uint32_t vertex[8];            ///< the last one repeated where there are fewer
        std::uint32_t first = 0, count = 0; ///< in node_; weights at 8 times that
    };

    const DeformableSurface* surface_;
    AlignedVector<Group> groups_;
    std::vector<std::uint32_t> node_;
    AlignedVector<double> weight_;
};

} // namespace cinch
