// SPDX-License-Identifier: Apache-2.0
#pragma once

/// \file
/// A tree of bounding volumes over a surface in rest state, and what each knows of its vertices.

#include <cstdint>
#include <span>
#include <vector>

#include "cinch/bounds.hpp"

namespace cinch {

/// W' = { w : Σ_j w_j = 1, l_j ≤ w_j ≤ h_j }, the limited convex weight space of one BV (Eq. 9). A view; owns nothing.
struct WeightSpace {
    std::span<const double> l; ///< multiples of 2^-53 in [0, 1]
    std::span<const double> h; ///< the same, ≥ l
};

/// The real box centre ± half contains its vertices.
struct RestBox {
    Vec3 centre = Vec3::Zero(); ///< in the unit of the surface
    Vec3 half = Vec3::Zero();   ///< half extents, ≥ 0
};

/// The real parallelepiped centre + Σ β_i axis_i, |β_i| ≤ 1, contains its vertices. Its axes are nearly orthogonal: an
/// OBB.
struct OrientedBox {
    Vec3 centre = Vec3::Zero();                                ///< in the unit of the surface
    Vec3 axis[3] = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()}; ///< half extents, with direction
};

/// w_j ≈ mean + gradient·y over a BV's vertices, y = x − pivot. Exactly, for every vertex: |w_j − mean − gradient·y| ≤
/// residual and |(w_j − mean) y_i| ≤ moment_i. The means of a BV are multiples of 2^-53 that sum to exactly 1.
struct WeightModel {
    double mean = 0;              ///< of w_j
    Vec3 gradient = Vec3::Zero(); ///< of w_j, per unit of length
    double residual = 0;          ///< of the affine model, at most
    Vec3 moment = Vec3::Zero();   ///< per coordinate, at most
};

/// What one BV knows of its vertices in rest state. A view; owns nothing.
struct RestBv {
    RestBox box;                         ///< of all vertices
    std::span<const std::uint32_t> node; ///< simulation nodes that influence it
    WeightSpace space;                   ///< parallel to `node`
    std::span<const RestBox> local;     ///< parallel to `node`: holds the vertices that the simulation node influences,
    std::span<const double> radius;     ///< and so does the ball of this radius about the box's centre
    Vec3 pivot = Vec3::Zero();          ///< origin of y in the weight model and of the points
    std::span<const WeightModel> model; ///< parallel to `node`
    std::span<const std::uint32_t>
        point;        ///< extreme vertices: max q·x over all vertices is at most that over these + slack·‖q‖
    double slack = 0; ///< see `point`
    std::uint32_t vertex_influences = 0; ///< most simulation nodes of any one of its vertices
};

/// Most triangles, and most different vertices, of a cluster. At least 1 and 3.
struct ClusterSize {
    std::size_t triangles = 16; ///< at most
    std::size_t vertices = 16;  ///< different ones, at most
};

/// One bounding volume in rest state: rest box, and where its triangles, children and influences lie in the Bvh.
struct Bv {
    RestBox box;                      ///< contains every rest vertex
    OrientedBox oriented;             ///< and so does this one
    Vec3 pivot = Vec3::Zero();        ///< mean of the rest vertices, see WeightModel
    double slack = 0;                 ///< see RestBv::point
    std::uint32_t first_triangle = 0; ///< in Bvh::triangle
    std::uint32_t triangle_count = 0; ///< from there on
    std::uint32_t first_child = 0;    ///< the other child is first_child + 1; 0 for a leaf (the root is nobody's child)
    std::uint32_t first_influence = 0;   ///< in Bvh::node, l, h, local, radius, model
    std::uint32_t influence_count = 0;   ///< from there on
    std::uint32_t first_point = 0;       ///< in Bvh::point
    std::uint32_t point_count = 0;       ///< from there on
    std::uint32_t vertex_influences = 0; ///< most simulation nodes of any one of its vertices

    /// Whether it has no children.
    bool is_leaf() const { return first_child == 0; }
};

/// How much of the rest data is prepared; it takes most of the time.
enum class RestDetail : std::uint8_t {
    boxes, ///< what convex, corners, eq12 and limited need: boxes and weight intervals
    inner, ///< everything but the extreme points of the leaves: enough for queries, whose leaves come from their
           ///< vertices
    all,
};

/// A binary tree of BVs over a surface, in flat arrays. BVs stand level by level, the root first, children after
/// parents.
struct Bvh {
    RestDetail detail = RestDetail::all; ///< what was prepared
    std::vector<Bv> bvs;                 ///< empty for a mesh without triangles
    std::vector<std::uint32_t> level;    ///< level i is BVs [level[i], level[i+1]); the last entry is bvs.size()
    std::vector<std::uint32_t> triangle; ///< a permutation of the mesh's triangles
    std::vector<std::uint32_t> node;  ///< per BV ascending: every simulation node that influences any of its vertices
    std::vector<double> l;            ///< per entry of `node` the least weight over the BV's vertices
    std::vector<double> h;            ///< and the greatest one
    std::vector<RestBox> local;       ///< per entry of `node` a box around the BV's vertices that it influences
    std::vector<double> radius;       ///< per entry of `node` of a ball about that box's centre around these vertices
    std::vector<WeightModel> model;   ///< per entry of `node`
    std::vector<std::uint32_t> point; ///< extreme vertices of the BVs

    /// Of all arrays.
    std::size_t bytes() const
    {
        auto size = [](const auto& all) { return all.size() * sizeof(all[0]); };
        return size(bvs) + size(level) + size(triangle) + size(node) + size(l) + size(h) + size(local) + size(radius) +
               size(model) + size(point);
    }
    /// What one BV knows, as views of the arrays. bv < bvs.size().
    RestBv rest(std::size_t bv) const
    {
        const Bv& b = bvs[bv];
        auto mine = [&](const auto& all) {
            return all.empty() ? std::span(all) : std::span(all).subspan(b.first_influence, b.influence_count);
        };
        return {b.box,
                mine(node),
                {mine(l), mine(h)},
                mine(local),
                mine(radius),
                b.pivot,
                mine(model),
                std::span(point).subspan(b.first_point, b.point_count),
                b.slack,
                b.vertex_influences};
    }
};

/// Median split along the longest axis of the covariance of the triangles' centroids, down to at most `leaf_triangles`
/// ≥ 1 per leaf; ties are split by index, so the depth is logarithmic whatever the geometry. Deterministic.
Bvh build_bvh(const DeformableSurface& surface, std::size_t leaf_triangles, RestDetail detail = RestDetail::all);

/// The same split over clusters of triangles, each of which becomes a leaf: fewer and fuller leaves, each a patch of
/// the surface.
Bvh build_bvh(const DeformableSurface& surface, ClusterSize leaf, RestDetail detail = RestDetail::all);

/// The vertices of one BV's triangles, each once, in order of first use.
std::vector<std::uint32_t> vertices_of(const DeformableSurface& surface, const Bvh& bvh, const Bv& bv);

} // namespace cinch
