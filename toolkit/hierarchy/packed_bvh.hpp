// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "cinch/bvh.hpp"
#include "toolkit/bounds/kernel/bound_kernel.hpp"
#include "toolkit/bounds/pack_bv.hpp"
#include "toolkit/hierarchy/moments.hpp"

namespace cinch {

/// What the kernels need of a Bvh, in T, each BV with one kind of bound. Stands alone: the Bvh may go.
template <class T> struct PackedBvh
    : PackedBvs<T> {                  ///< bvs: as Bvh::bvs, then those that PackedBv::also and guard name
    std::vector<std::uint32_t> place; ///< without leaves: where in bvs each BV stands; else empty
    RestExtent rest;

    std::size_t bytes() const
    {
        return this->bvs.size() * sizeof(PackedBv<T>) + (place.size() + this->node.size()) * sizeof(std::uint32_t) +
               this->value.size() * sizeof(T);
    }
};

/// One kind of bound for a BV or two, and where their λ begin (PackedBv::start).
struct ChosenKind {
    Method kind = Method::support;
    std::optional<Method> also;
    double start = 0, also_start = 0;
    bool oriented = false; ///< over the oriented box; convex, eq12 and limited only
    bool guarded = false;  ///< never clearly looser than Eq. 12: local by itself, others with one in reserve
};

/// Of all BVs of a tree, and what those of the kind moments need.
struct ChosenKinds {
    std::vector<ChosenKind> of;
    MomentData moments{};
};

/// What `best` is chosen for. Twice the time must be worth it: the width has at most a share of what it had. Refits
/// weigh the times of kinds, and are never clearly looser than Eq. 12; for queries, which can look closer where it
/// matters, two kinds take twice the time of any one, there is no guard, and moments are not tried: they would change
/// few BVs, by little.
struct KindPolicy {
    double worth_twice;
    bool weighs_times, guarded;
    std::size_t most_moments; ///< most simulation nodes of a BV for which moments are tried
};
inline constexpr KindPolicy for_refits{0.985, true, true, 160}, for_queries{0.85, false, false, 0};

/// Coordinates of the packed rest data: any origin will do, but the same for all that share a frame's projected maps.
RestExtent rest_extent(const Bvh& bvh, const DeformableSurface& surface, RestShape shape = RestShape::aabb);

/// For convex, eq12, limited and linear that kind; for local and support that kind with λ begun where it did best on
/// synthetic deformations; for `best` whichever of linear, support, local and moments did best there, or two of them,
/// by what is worth the time. The deformations are random quadratic ones, each simulation node moving as at the mean of
/// the vertices it influences. Deterministic.
ChosenKinds choose_kinds(const Bvh& bvh, const DeformableSurface& surface, Method method,
                         RestShape shape = RestShape::aabb, KindPolicy policy = for_refits);

/// Rounds everything outward to T. Leaves are left out if they are not wanted. Throws std::length_error for a BV
/// of more simulation nodes than most_nodes_in_float or most_nodes_in_double.
template <class T>
PackedBvh<T> pack(const Bvh& bvh, const DeformableSurface& surface, const ChosenKinds& kinds, bool leaves = true);

} // namespace cinch
