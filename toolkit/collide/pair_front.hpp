// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "toolkit/collide/kernel/box_kernel.hpp"
#include "toolkit/hierarchy/lazy_refit.hpp"

namespace cinch {

/// Which children a pair of overlapping BVs is replaced by: the larger one's, both's where they are alike. A matter of
/// the rest shapes alone, so that the order of the leaves is.
BoxTest children_of_pair(const LazyRefit& a, const LazyRefit& b, BvPair bvs);

/// The front of BV pairs of two trees: where the last traversal ended. The next one begins there, goes down where pairs
/// overlap, and a level up where all children of a pair are apart and so is the pair. It spares the tests above the
/// front, but not their BVs' bounds: what is above has no merged ones. An option, to compare with the cut that each
/// tree keeps (LazyRefit).
class PairFront {
public:
    void reset();
    /// The pairs of leaves that overlap, in the order of a traversal from the roots, which are current; brings BVs of
    /// both trees up to date as it goes. `input` is for test_boxes. Returns how many pairs it tested.
    std::size_t advance(LazyRefit& a, LazyRefit& b, const BoxInput& input, std::vector<BvPair>& leaves);

private:
    struct Node { // a pair that was tested
        BvPair bvs;
        std::uint32_t first_child = 0, children = 0; // 0 children: on the front
        bool overlaps = false;
    };
    void compact();

    std::vector<Node> nodes_; // the roots first, children after parents and together; some may be dead: below the front
    std::size_t dead_ = 0;
    std::vector<std::uint32_t> some_, next_;
};

} // namespace cinch
