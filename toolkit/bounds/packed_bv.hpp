// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "cinch/bounds.hpp"
#include "toolkit/bounds/packed_moments.hpp"

namespace cinch {

/// The kinds for many simulation nodes take them in blocks of 8, one virtual lane each; the last one is repeated, with
/// no weight, to fill a block. Those for few take them one by one. Points stand in blocks of 4, the last one repeated.
inline constexpr std::size_t block_lanes = 8;
constexpr std::size_t blocks_of(std::size_t count) { return (count + block_lanes - 1) / block_lanes; }
constexpr std::size_t quads_of(std::size_t points) { return (points + 3) / 4; }
constexpr bool takes_one_by_one(Method kind)
{
    return kind == Method::support || kind == Method::linear || kind == Method::moments;
}

/// One BV as the kernels read it: rest data in T (float or double), rounded outward, relative to a rest origin that all
/// BVs of a tree share. Its simulation nodes and values stand in two contiguous runs. Values of the kinds for many, per
/// block of simulation nodes 8 each of:
///   convex, eq12, limited   l, r
///   local                   l, r, centre (3), half (3), radius: the box cut by a ball about its centre
/// Of those for few, per block of extreme points the x of 4 points relative to the pivot, their y and their z; then per
/// simulation node:
///   support                 centre (3), half (3), l, r, mean
///   linear                  gradient (3), residual, moment (3), mean
/// and moments as packed_moments.hpp says,
/// with r = h − l. The real weights lie in [l, l + r], and Σ mean = 1 exactly.
template <class T> struct PackedBv {
    Method kind = Method::convex; ///< convex, eq12, limited, local, support, linear or moments
    std::uint32_t count = 0;      ///< simulation nodes
    std::uint32_t points = 0;     ///< extreme points, lifted for moments; 0 for the kinds for many
    std::uint32_t first_node = 0;
    std::uint32_t also = 0; ///< place of a second bound of the same BV to intersect with; 0 if there is none
    std::uint32_t guard =
        0; ///< place of the BV's Eq. 12, taken too where this bound may exceed it clearly (guard-inl.hpp); 0: never
    bool guarded = false; ///< local alone: the bound itself never exceeds Eq. 12 clearly
    std::uint64_t first_value = 0;
    T centre[4] = {0, 0, 0, 1}, half[4] = {}; ///< rest box, and a 1 for θ
    T axis[3][3] = {};                        ///< and its axes instead of `half` if it is oriented
    bool oriented = false;
    T pivot[4] = {0, 0, 0, 1}; ///< origin of the points and of the model of weights, and a 1 for θ
    T slack = 0; ///< max q·y over all vertices is at most that over the points + slack·‖q‖, also as computed
    T sum_l = 0, sum_r = 0; ///< about; they only steer λ, but sum_l = 0 if and only if every l is
    T start = 0;            ///< λ begins at mean b + start·(greatest b − mean b)
    T error_factor = 1;     ///< of the per-node error, see rounding.hpp

    static constexpr std::size_t rows(Method kind)
    {
        return kind == Method::local ? 9 : 2;
    } ///< of a block; kinds for many
    static constexpr std::size_t values(Method kind)
    {
        return kind == Method::moments ? moment_values : kind == Method::support ? 9 : 8;
    } ///< of a simulation node; kinds for few
    /// Before those of the simulation nodes; kinds for few.
    std::size_t values_before() const
    {
        return kind == Method::moments ? moment_values_before(points) : 12 * quads_of(points);
    }
};

} // namespace cinch
