// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "cinch/bvh.hpp"
#include "toolkit/bounds/bound_moments.hpp"
#include "toolkit/bounds/packed_bv.hpp"
#include "toolkit/bounds/projected_maps.hpp"
#include "toolkit/deform/aligned.hpp"

namespace cinch {

/// Rest data of BVs as the kernels read it.
template <class T> struct PackedBvs {
    std::vector<PackedBv<T>> bvs;
    std::vector<std::uint32_t> node;
    AlignedVector<T> value;
};

/// How one BV is to be bounded.
struct BvChoice {
    Method kind;
    double start = 0;                      ///< PackedBv::start
    const OrientedBox* oriented = nullptr; ///< to be taken instead of the other box, where all of it is normal in T
    bool guarded = false;                  ///< PackedBv::guarded
    const RestMoments* moments = nullptr;  ///< of the kind moments
};

/// Appends one BV, everything rounded outward to T; `x` are the rest vertices. Throws std::length_error for a BV of
/// more simulation nodes than most_nodes_in_float or most_nodes_in_double.
template <class T> void pack_bv(const RestBv& rest, std::span<const Vec3> x, const RestExtent& extent,
                                const BvChoice& choice, PackedBvs<T>& out);

} // namespace cinch
