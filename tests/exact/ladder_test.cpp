// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include <catch2/catch.hpp>

#include "cinch/bvh.hpp"
#include "exact/formulas.hpp"
#include "exact/optimum.hpp"
#include "tests/support.hpp"

using namespace cinch;
using namespace cinch::exact;

TEST_CASE("the order of the ladder on exact values: local <= limited <= eq12 <= corners, and eq12 <= convex")
{
    const test::Example e = test::example(300, 25);
    const Bvh bvh = build_bvh(e.surface, 2);
    std::size_t strictly = 0;
    for (std::size_t frame : {1u, 2u})
        for (std::size_t bv = 0; bv < bvh.bvs.size(); ++bv) {
            const RestBv rest = bvh.rest(bv);
            for (const Axis& axis : axes_of(14))
                for (const bool against : {false, true}) {
                    std::vector<Exact> common, local;
                    for (std::size_t j = 0; j < rest.node.size(); ++j) {
                        const AffineMap& map = e.frames[frame][rest.node[j]];
                        const auto wide = extremum<Exact>(rest.box.centre, rest.box.half, map, axis);
                        const auto narrow = extremum<Exact>(rest.local[j].centre, rest.local[j].half, map, axis);
                        common.push_back(against ? wide.minus : wide.plus);
                        local.push_back(against ? narrow.minus : narrow.plus);
                    }
                    std::vector<Exact> sorted = common;
                    std::sort(sorted.begin(), sorted.end(), [](const Exact& x, const Exact& y) { return y < x; });
                    const Exact limited = optimum(rest.space, common)->value,
                                over_local = optimum(rest.space, local)->value;
                    const Exact eq12 = sorted.size() > 1 ? dual_value(rest.space, common, sorted[1]) : sorted[0];
                    REQUIRE(over_local <= limited);
                    REQUIRE(limited <= eq12);
                    REQUIRE(eq12 <= sorted[0]);
                    REQUIRE(eq12 <= best_corner(rest.space, common));
                    strictly += over_local < limited;
                }
        }
    CHECK(strictly > 100);
}
