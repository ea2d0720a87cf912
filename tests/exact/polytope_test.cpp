// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include "cinch/refit.hpp"
#include "exact/polytope.hpp"
#include "tests/support.hpp"

using namespace cinch;
using namespace cinch::exact;

TEST_CASE("volumes of known k-DOPs are exact, planes without a facet are named")
{
    const Polytope box = polytope(6, std::vector<double>{1, 1, 2, 0, 0.5, 0.25});
    CHECK(box.volume == "3/1");
    CHECK(box.vertices == 8);
    CHECK(box.redundant.empty());

    // The cube [−1, 1]³ with its 8 corners cut at |x|+|y|+|z| ≤ 2: each loses a tetrahedron of edge 1, volume 1/6.
    std::vector<double> cut{1, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2, 2, 2, 2};
    const Polytope truncated = polytope(14, cut);
    CHECK(truncated.volume == "20/3");
    CHECK(truncated.vertices == 12); // a cuboctahedron, degenerate: four facets at every vertex
    CHECK(truncated.redundant.empty());
    cut[6] = 3; // touches a corner only
    CHECK(polytope(14, cut).volume == "41/6");
    CHECK(polytope(14, cut).redundant == std::vector<int>{6});
    cut[6] = 4; // does not touch at all
    CHECK(polytope(14, cut).redundant == std::vector<int>{6});
}

TEST_CASE("flat and empty sets have no volume")
{
    CHECK(polytope(6, std::vector<double>{1, 1, 2, -2, 1, 1}).volume == "0/1");
    CHECK(polytope(6, std::vector<double>{1, 1, 2, -3, 1, 1}).volume == "0/1");
    CHECK(polytope(6, std::vector<double>(6, 0x1p999)).vertices == 8);
    CHECK_THROWS_AS(polytope(6, std::vector<double>(6, 0x1p1001)), std::length_error);
    // Flat across no axis: x + y + z ≤ −1 on [−⅓ …] meets the box in a point only.
    CHECK(polytope(14, std::vector<double>{1, 1, 1, 1, 1, 1, -3, 3, 9, 9, 9, 9, 9, 9}).volume == "0/1");
}

TEST_CASE("bounds hold the true k-DOP: volumes are ordered, and fall with k")
{
    const test::Example e = test::example(300, 20);
    const Bvh bvh = build_bvh(e.surface, 8);
    for (std::size_t bv : {0u, 3u, 20u}) {
        double last = 1e300;
        for (int k : {6, 14, 26}) {
            std::vector<double> s(bvh.bvs.size() * static_cast<std::size_t>(k));
            refit(bvh, e.surface, e.frames[2], {Method::limited, k}, s);
            const Polytope bound =
                polytope(k, std::span(s).subspan(bv * static_cast<std::size_t>(k), static_cast<std::size_t>(k)));
            const Polytope truth = true_polytope(e.surface, bvh, bv, e.frames[2], k);
            CHECK(truth.approximate_volume > 0);
            CHECK(bound.approximate_volume > truth.approximate_volume);
            CHECK(truth.approximate_volume < last);
            last = truth.approximate_volume;
        }
    }
}
