// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "toolkit/deform/aligned.hpp"
#include "toolkit/deform/surface.hpp"

namespace cinch {

/// Evaluates all vertices of one surface, frame after frame, by SIMD: groups of 8 vertices that lie near each other, one in a lane, go
/// through the simulation nodes that influence any of them, with weight 0 where a node does not. The surface must stay as it is,
/// and alive.
///
/// In double the positions are those of evaluate_vertex, bit for bit: a term of 0 changes no sum that began at +0. In float they are
/// within 1e-5 of the greatest distance of a node's image of the surface from the mean one: for pictures and files, not for proofs.
template <class T> class SurfaceEvaluator {
public:
    explicit SurfaceEvaluator(const DeformableSurface& surface);
    explicit SurfaceEvaluator(const DeformableSurface&& surface) = delete; ///< it would refer to what is gone

    /// `out` has a place per vertex. In parallel. Non-finite maps give non-finite coordinates where they have weight, and nowhere else.
    void operator()(std::span<const AffineMap> maps, std::span<Vec3> out) const;

private:
    struct alignas(64) Group {
        T rest[3][8];                       ///< about centre_
        std::uint32_t vertex[8];            ///< the last one repeated where there are fewer
        std::uint32_t first = 0, count = 0; ///< in node_; weights at 8 times that
    };

    const DeformableSurface* surface_;
    Vec3 centre_ = Vec3::Zero(); ///< 0 in double
    AlignedVector<Group> groups_;
    std::vector<std::uint32_t> node_;
    AlignedVector<T> weight_;
};

extern template class SurfaceEvaluator<double>;
extern template class SurfaceEvaluator<float>;

} // namespace cinch
