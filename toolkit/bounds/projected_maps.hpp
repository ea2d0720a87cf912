// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include "toolkit/bounds/aligned.hpp"

#include "toolkit/bounds/weight_space.hpp"
#include "toolkit/surface/skin.hpp"

namespace cinch {

/// How many lanes the kernels use for the k/2 axes of a k-DOP. The last one is never an axis: it carries errors.
constexpr std::size_t lanes_of(int kdop) { return kdop == 6 ? 4 : kdop == 14 ? 8 : kdop == 18 ? 12 : 16; }

/// What projecting needs to know of a surface at rest.
struct RestExtent {
    Vec3 origin = Vec3::Zero();     ///< of the packed rest coordinates
    Vec3 about_origin = Vec3::Zero(); ///< greatest |x − origin| over all boxes, per coordinate
    Vec3 absolute = Vec3::Zero();   ///< greatest |x| over all vertices
    double influences = 0;          ///< most simulation nodes of a vertex
};

/// The transforms of one frame along the axes of a k-DOP: per simulation node q_s = (Aᵀγ)_s for s = 0, 1, 2 and
/// θ = γ·(A o + t − O) and ν ≥ ‖q‖, each `lanes` values of T, o the rest origin and O `origin`. The last lane has q = 0 and θ = an
/// upper bound on all errors that this node can cause (rounding.hpp), +∞ if its transform is not finite or too large for T.
template <class T> struct ProjectedMaps {
    static constexpr std::size_t rows = 5;

    int kdop = 6;
    Vec3 origin = Vec3::Zero();
    std::size_t unbounded = 0; ///< simulation nodes whose error is +∞
    AlignedVector<T> value;    ///< simulation node × 5 × lanes

    const T* of(std::uint32_t node) const { return value.data() + node * rows * lanes_of(kdop); }
};

/// `out` keeps its memory. With Rounding::plain errors are 0 (or +∞).
template <class T>
void project(std::span<const AffineMap> maps, const RestExtent& rest, int kdop, Rounding rounding, ProjectedMaps<T>& out);

} // namespace cinch
