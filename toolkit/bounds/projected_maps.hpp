// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "toolkit/deform/aligned.hpp"
#include <cstddef>
#include <cstdint>
#include <span>

#include "toolkit/bounds/weight_space.hpp"
#include "toolkit/surface/skin.hpp"

namespace cinch {

/// Rows of 4 values that a simulation node's projected map takes: one per axis, and one place per axis and one more.
constexpr std::size_t projected_rows(std::size_t axes) { return axes + axes / 4 + 1; }

/// What projecting needs to know of a surface at rest.
struct RestExtent {
    Vec3 origin = Vec3::Zero();       ///< of the packed rest coordinates
    Vec3 about_origin = Vec3::Zero(); ///< greatest |x − origin| over all boxes, per coordinate
    Vec3 absolute = Vec3::Zero();     ///< greatest |x| over all vertices
    double influences = 0;            ///< most simulation nodes of a vertex
};

/// The transforms of one frame along the axes of a k-DOP. Per simulation node a record: for every axis q = Aᵀγ (3
/// values) and θ = γ·(A o + t − O), o the rest origin and O `origin`; then for every axis ν ≥ ‖q‖; in the last place an
/// upper bound on all errors that this node can cause (rounding.hpp), +∞ (and all else 0) if its transform is not
/// finite or too large for T.
template <class T> struct ProjectedMaps {
    int kdop = 6;
    Vec3 origin = Vec3::Zero();
    std::size_t unbounded = 0; ///< simulation nodes whose error is +∞
    double vertex_error = 0; ///< of the other nodes, the greatest error of an image of a vertex that is not of rounding
                             ///< to and in T: that of evaluate_vertex, and what shifting to the origins lost
    AlignedVector<T> value;  ///< records
    AlignedVector<T> octet; ///< the same by eights: of nodes 8i to 8i + 7 the first values, 8 in a row, then the second
                            ///< ones, …; or empty

    const T* of(std::uint32_t node) const
    {
        return value.data() + node * 4 * projected_rows(static_cast<std::size_t>(kdop / 2));
    }
};

/// The point nearest to `image` of a grid several times as coarse as the surface is large: (0, 0, 0) where that is
/// near.
Vec3 on_grid(const Vec3& image, const RestExtent& rest);

/// Octets speed up BVs that most simulation nodes influence, and change no result.
enum class Octets : std::uint8_t { wanted, left_out };

/// `out` keeps its memory. With Rounding::plain errors are 0 (or +∞).
template <class T> void project(std::span<const AffineMap> maps, const RestExtent& rest, int kdop, Rounding rounding,
                                ProjectedMaps<T>& out, Octets octets = Octets::wanted);

} // namespace cinch
