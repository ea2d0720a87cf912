// SPDX-License-Identifier: Apache-2.0
// Internal to Collider, and for those who measure it.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "cinch/collider.hpp"
#include "toolkit/collide/kernel/box_kernel.hpp"
#include "toolkit/collide/kernel/cluster_kernel.hpp"
#include "toolkit/collide/pair_front.hpp"
#include "toolkit/hierarchy/lazy_refit.hpp"

namespace cinch {

/// The collider itself; bodies are places here, and ids outside.
struct Collider::Parts {
public:
    explicit Parts(const LazyOptions& options) : options_(options) {}

    BodyId add(const Bvh& bvh, std::unique_ptr<const Bvh> own_bvh, const DeformableSurface& surface,
               const LazyOptions& own, std::span<const MorphTarget> targets = {});
    void remove(BodyId body);
    void set_filter(std::function<bool(BodyId, BodyId)> wanted) { wanted_ = std::move(wanted); }
    void update(std::span<const BodyFrame> frames);
    bool find(Query query, const Sink& sink);

    const LazyOptions& options() const { return options_; }
    std::span<const BodyId> ids() const { return ids_; }
    const std::vector<BodyId>& unknown() const;
    const QueryCounts& counts() const { return counts_; }
    std::span<const LazyRefit> trees() const { return trees_; } ///< one per body, in the order of ids()
    std::size_t bytes() const;

private:
    struct Body {
        std::unique_ptr<const Bvh> bvh; ///< if it was moved in and the tree refers to it
        const DeformableSurface* surface;
    };
    // Two bodies whose roots overlap.
    struct BodyPair {
        std::uint32_t a = 0, b = 0;
        AlignedVector<float> shift; ///< see BoxInput
        ClusterInput clusters;
        std::size_t begin = 0, end = 0; ///< of its BV pairs in level_
        std::vector<BvPair> leaves;     ///< that overlap, in order
        std::size_t tested = 0;         ///< of these
    };
    // Some of the work of a body pair, for one task.
    struct Piece {
        std::size_t pair, begin, end;
        std::vector<TriangleHit> hits;
        std::vector<ClusterPair> clusters;
        std::vector<TrianglePair> found;
        QueryCounts counts;
    };

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
    std::vector<BodyId> ids_; ///< one per body, ascending
    BodyId next_id_ = 0;
    std::function<bool(BodyId, BodyId)> wanted_;
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
