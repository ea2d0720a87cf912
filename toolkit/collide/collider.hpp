// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "toolkit/collide/kernel/box_kernel.hpp"
#include "toolkit/collide/kernel/cluster_kernel.hpp"
#include "toolkit/collide/pair_front.hpp"
#include "toolkit/collide/pair_list.hpp"
#include "toolkit/hierarchy/lazy_refit.hpp"

namespace cinch {

/// What is asked of a query.
enum class Query : std::uint8_t {
    pairs,  ///< all intersecting pairs of triangles
    any,    ///< whether there is one; stops at the first it finds
    leaves, ///< pairs of leaves whose k-DOPs overlap, each given by its first triangle: the least effort, no triangle is tested
};

/// What a query did.
struct QueryCounts {
    std::size_t body_pairs = 0; ///< whose roots overlap
    std::size_t box_tests = 0, leaf_pairs = 0;
    std::uint64_t triangle_tests = 0; ///< pairs of triangles whose boxes overlap
    std::uint64_t in_double = 0;      ///< of these, decided by the vertices of evaluate_vertex and filtered signs;
    std::uint64_t in_exact = 0;       ///< by exact arithmetic; all others by floats with proven margins
    LazyCounts updates;               ///< of all bodies, up to here in this frame
};

/// Finds the intersecting triangles of several deforming bodies, frame after frame: a sweep over the roots, then all pairs of trees level by
/// level, each level's BVs brought up to date together, then the leaves. A pair is one if the closed triangles whose vertices are those
/// of evaluate_vertex have a point in common, exactly. The list and its order are the same for every method, k, history, update and
/// number of threads; the order is that of the trees.
class Collider {
public:
    /// All bodies have the same options.
    explicit Collider(const LazyOptions& options) : options_(options) {}

    /// The surface must stay as it is, and alive; so must a BVH that is not moved in, where LazyRefit says so, which see for what is thrown.
    /// Queries need a new update() then.
    void add(const Bvh& bvh, const DeformableSurface& surface);
    void add(Bvh&& bvh, const DeformableSurface& surface); ///< keeps the BVH if it is needed
    void add(const Bvh& bvh, const DeformableSurface&& surface) = delete;
    void add(Bvh&& bvh, const DeformableSurface&& surface) = delete;
    void add(const Bvh&& bvh, const DeformableSurface& surface) = delete;
    void add(const Bvh&& bvh, const DeformableSurface&& surface) = delete;

    /// Begins a frame, one per body; what it points to must stay alive until after the query. Throws std::invalid_argument for sizes that do
    /// not fit, std::runtime_error for a changed floating-point environment; whatever it throws, there is no frame then.
    void update(std::span<const BodyFrame> frames);

    /// Queries the frame. `sink` gets the pairs in order, piece by piece, and says whether to go on. True if there are any. These and unknown()
    /// throw std::logic_error if there is no frame: before the first update(), after one that threw, and after add().
    using Sink = std::function<bool(std::span<const TrianglePair>)>;
    bool find(Query query, const Sink& sink);
    std::vector<TrianglePair> pairs();
    bool any();

    /// Bodies of which nothing is known in this frame (LazyRefit::known): to be taken as overlapping everything. They are in no pair.
    const std::vector<std::uint32_t>& unknown() const;
    const QueryCounts& counts() const { return counts_; } ///< of the frame so far
    std::span<const LazyRefit> trees() const { return trees_; }
    std::size_t bytes() const; ///< of everything but the surfaces and BVHs that were not moved in

private:
    struct Body {
        std::unique_ptr<const Bvh> bvh; ///< if it was moved in and the tree refers to it
        const DeformableSurface* surface;
    };
    // Two bodies whose roots overlap.
    struct BodyPair {
        std::uint32_t a = 0, b = 0;
        AlignedVector<float> shift;   ///< see BoxInput
        ClusterInput clusters;
        std::size_t begin = 0, end = 0; ///< of its BV pairs in level_
        std::vector<BvPair> leaves;   ///< that overlap, in order
        std::size_t tested = 0;       ///< of these
    };
    // Some of the work of a body pair, for one task.
    struct Piece {
        std::size_t pair, begin, end;
        std::vector<TriangleHit> hits;
        std::vector<ClusterPair> clusters;
        std::vector<TrianglePair> found;
        QueryCounts counts;
    };

    void add(const Bvh& bvh, std::unique_ptr<const Bvh> own, const DeformableSurface& surface);
    void require_frame() const;
    void sweep();
    void follow_fronts();
    void set_shift(BodyPair& pair) const;
    void descend(); ///< by one level
    void test_level();
    bool test_leaves(Query query, const Sink& sink);
    void test_piece(Piece& piece) const;
    bool list_leaves(const Sink& sink) const;

    LazyOptions options_;
    const char* no_frame_ = "before the first update()"; ///< why there is none, or null
    std::vector<Body> bodies_;
    std::vector<LazyRefit> trees_; ///< one per body
    std::vector<std::uint32_t> unknown_;
    QueryCounts counts_;

    std::vector<BodyPair> pairs_; ///< the first active_ are this frame's, by a, then b
    std::size_t active_ = 0;
    std::map<std::pair<std::uint32_t, std::uint32_t>, PairFront> fronts_; ///< with keep_cut = false
    std::vector<BvPair> level_, overlapping_;
    std::vector<BoxTest> tests_;
    std::vector<Piece> pieces_;
    std::vector<std::size_t> found_in_;
};

} // namespace cinch
