// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include "cinch/bounds.hpp"
#include "tests/collide/random_bodies.hpp"
#include "toolkit/collide/pair_front.hpp"
#include "toolkit/hierarchy/lazy_refit.hpp"

using namespace cinch;
using namespace cinch::test;

namespace {

using Leaves = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

Leaves plain(const std::vector<BvPair>& pairs)
{
    Leaves out;
    for (const BvPair& p : pairs)
        out.emplace_back(p.a, p.b);
    return out;
}

bool overlap(const LazyRefit& a, const LazyRefit& b, std::uint32_t p, std::uint32_t q, std::size_t side,
             std::size_t axes)
{
    for (std::size_t d = 0; d < axes; ++d)
        if (a.dop(p)[d] + b.dop(q)[side + d] < 0 || a.dop(p)[side + d] + b.dop(q)[d] < 0)
            return false;
    return true;
}

// From the roots down, all the way, breadth first.
Leaves afresh(LazyRefit& a, LazyRefit& b, int kdop)
{
    Leaves level{{0, 0}}, next, leaves;
    for (; !level.empty(); level.swap(next)) {
        next.clear();
        for (const auto& [p, q] : level) {
            a.want(p);
            b.want(q);
            a.supply();
            b.supply();
            if (!overlap(a, b, p, q, dop_side(kdop), static_cast<std::size_t>(kdop) / 2))
                continue;
            if (a.link(p).is_leaf() && b.link(q).is_leaf()) {
                leaves.emplace_back(p, q);
                continue;
            }
            const BoxTest t = children_of_pair(a, b, {p, q});
            for (std::uint32_t i = 0; i <= t.a >> 31; ++i)
                for (std::uint32_t j = 0; j <= t.b >> 31; ++j)
                    next.emplace_back((t.a & ~BoxTest::both) + i, (t.b & ~BoxTest::both) + j);
        }
    }
    return leaves;
}

} // namespace

TEST_CASE(
    "a front that is kept finds the leaf pairs of a traversal from the roots, in its order, and does not grow for ever")
{
    Dice dice(91);
    const DeformableSurface one = soft(brain(300), 14), other = soft(fish(250), 9);
    for (const int kdop : {6, 18})
        for (const ClusterSize leaf : {ClusterSize{16, 16}, ClusterSize{1, 3}}) {
            LazyOptions options;
            options.update = Update::lazy;
            options.keep_cut = false;
            options.kdop = kdop;
            const Bvh of_one = build_bvh(one, leaf, RestDetail::inner),
                      of_other = build_bvh(other, leaf, RestDetail::inner);
            LazyRefit a(of_one, one, options), b(of_other, other, options);
            PairFront kept;
            AlignedVector<float> no_shift(dop_floats(kdop), 0.0f);
            const BoxInput input{dop_side(kdop), a.dop(0), b.dop(0), no_shift.data()};
            std::size_t found = 0, most = 0, last = 0;
            Maps maps_a, maps_b;
            for (int frame = 0; frame < 60; ++frame) {
                if (frame % 7 != 6) { // else as it was
                    const double apart = frame % 10 == 9 ? 5 : frame % 10 == 5 ? 0 : 1.2;
                    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.1 * frame, Vec3(0, 0.6, 0.8)).toRotationMatrix();
                    maps_a = around(dice, 14, Eigen::Matrix3d::Identity(), {0, 0, 0}, 0.03);
                    maps_b = around(dice, 9, turn, {apart, 0.1 * dice.unit(), 0}, 0.03);
                }
                a.begin({maps_a});
                b.begin({maps_b});
                std::vector<BvPair> leaves;
                const std::size_t tests = kept.advance(a, b, input, leaves);
                const Leaves truth = afresh(a, b, kdop);
                REQUIRE((plain(leaves) == truth));
                PairFront fresh;
                std::vector<BvPair> again;
                const std::size_t from_the_roots = fresh.advance(a, b, input, again);
                REQUIRE((plain(again) == truth));
                found += truth.size();
                most = std::max(most, from_the_roots);
                last = tests;
                REQUIRE(tests <= 2 * most); // it is no larger than the largest traversal so far, and what it raises
                if (frame % 7 == 6)
                    REQUIRE(tests <= 2 * from_the_roots); // what was raised is on the front, and what overlaps below it
            }
            // Apart for long: it goes up to the roots, level by level.
            for (int frame = 0; frame < 40; ++frame) {
                a.begin({maps_a});
                maps_b = Maps(9, moved_by({50, 0, 0}));
                b.begin({maps_b});
                std::vector<BvPair> leaves;
                last = kept.advance(a, b, input, leaves);
                REQUIRE(leaves.empty());
            }
            CHECK(last == 1);
            CHECK(found > 1000);
            kept.reset();
        }
}
