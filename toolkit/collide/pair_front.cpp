// SPDX-License-Identifier: Apache-2.0
#include "toolkit/collide/pair_front.hpp"
#include "toolkit/hierarchy/lazy_refit.hpp"

#include <algorithm>

namespace cinch {
namespace {

bool are_leaves(const LazyRefit& a, const LazyRefit& b, BvPair p)
{
    return a.link(p.a).is_leaf() && b.link(p.b).is_leaf();
}

} // namespace

BoxTest children_of_pair(const LazyRefit& a, const LazyRefit& b, BvPair bvs)
{
    const LazyRefit::Link &p = a.link(bvs.a), &q = b.link(bvs.b);
    const bool open_a = !p.is_leaf() && (q.is_leaf() || !(2 * p.size < q.size)),
               open_b = !q.is_leaf() && (p.is_leaf() || !(2 * q.size < p.size));
    return {open_a ? p.child | BoxTest::both : bvs.a, open_b ? q.child | BoxTest::both : bvs.b};
}

void PairFront::reset()
{
    nodes_.assign(1, {});
    dead_ = 0;
}

std::size_t PairFront::advance(LazyRefit& a, LazyRefit& b, const BoxInput& input, std::vector<BvPair>& leaves)
{
    if (nodes_.empty())
        reset();
    std::size_t tests = 0;
    auto test = [&](const std::vector<std::uint32_t>& list) {
        for (const std::uint32_t n : list) {
            a.want(nodes_[n].bvs.a);
            b.want(nodes_[n].bvs.b);
        }
        a.supply();
        b.supply();
        for (const std::uint32_t n : list) {
            const BoxTest one{nodes_[n].bvs.a, nodes_[n].bvs.b};
            BvPair out[4];
            nodes_[n].overlaps = test_boxes(input, {&one, 1}, out) != out;
        }
        tests += list.size();
    };

    // The front as it is, in order from the roots, and from there down.
    some_.clear();
    std::vector<std::uint32_t> queue{0}, interior;
    for (std::size_t i = 0; i < queue.size(); ++i) {
        const Node& node = nodes_[queue[i]];
        if (node.children == 0) {
            some_.push_back(queue[i]);
            continue;
        }
        interior.push_back(queue[i]);
        for (std::uint32_t c = 0; c < node.children; ++c)
            queue.push_back(node.first_child + c);
    }
    while (!some_.empty()) {
        test(some_);
        next_.clear();
        for (const std::uint32_t n : some_) {
            if (!nodes_[n].overlaps || are_leaves(a, b, nodes_[n].bvs))
                continue;
            const BoxTest below = children_of_pair(a, b, nodes_[n].bvs);
            const std::uint32_t a0 = below.a & ~BoxTest::both, b0 = below.b & ~BoxTest::both;
            nodes_[n].first_child = static_cast<std::uint32_t>(nodes_.size());
            for (std::uint32_t i = a0; i < a0 + 1 + (below.a != a0); ++i)
                for (std::uint32_t j = b0; j < b0 + 1 + (below.b != b0); ++j) {
                    next_.push_back(static_cast<std::uint32_t>(nodes_.size()));
                    nodes_.push_back({{i, j}});
                    ++nodes_[n].children;
                }
        }
        some_.swap(next_);
    }

    // A level up where nothing below overlaps; parents stand before children in `interior`.
    std::vector<std::uint32_t> raise;
    for (const std::uint32_t n : interior) {
        const auto below = std::span(nodes_).subspan(nodes_[n].first_child, nodes_[n].children);
        if (std::none_of(below.begin(), below.end(),
                         [](const Node& child) { return child.children > 0 || child.overlaps; }))
            raise.push_back(n);
    }
    test(raise);
    for (const std::uint32_t n : raise)
        if (!nodes_[n].overlaps) {
            dead_ += nodes_[n].children;
            nodes_[n].children = 0;
        }

    leaves.clear();
    queue.assign(1, 0);
    for (std::size_t i = 0; i < queue.size(); ++i) {
        const Node& node = nodes_[queue[i]];
        if (node.children == 0 && node.overlaps && are_leaves(a, b, node.bvs))
            leaves.push_back(node.bvs);
        for (std::uint32_t c = 0; c < node.children; ++c)
            queue.push_back(node.first_child + c);
    }
    if (2 * dead_ > nodes_.size())
        compact();
    return tests;
}

void PairFront::compact()
{
    std::vector<Node> kept{nodes_[0]};
    for (std::size_t i = 0; i < kept.size(); ++i) {
        const std::uint32_t from = kept[i].first_child, count = kept[i].children;
        kept[i].first_child = static_cast<std::uint32_t>(kept.size());
        kept.insert(kept.end(), nodes_.begin() + from, nodes_.begin() + from + count);
    }
    nodes_ = std::move(kept);
    dead_ = 0;
}

} // namespace cinch
