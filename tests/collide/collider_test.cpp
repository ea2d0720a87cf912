// SPDX-License-Identifier: GPL-3.0-or-later
#include <set>

#include <catch2/catch.hpp>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include "cinch/bounds.hpp"
#include "tests/collide/random_bodies.hpp"
#include "tests/support.hpp"
#include "toolkit/collide/collider_parts.hpp"
#include "toolkit/hierarchy/lazy_refit.hpp"

using namespace cinch;
using namespace cinch::test;

namespace {

const std::vector<Methods> every_method = [] {
    std::vector<Methods> all(all_methods.begin(), all_methods.end());
    all.insert(all.end(), {Method::local | Method::support, Method::eq12 | Method::sphere});
    return all;
}();
constexpr Update every_update[] = {Update::lazy, Update::full, Update::automatic};
struct Leaf {
    ClusterSize size;
    std::size_t lanes;
};
constexpr Leaf every_leaf[] = {{{1, 3}, 4}, {{1, 3}, 16}, {{4, 4}, 4},   {{4, 6}, 8},
                               {{8, 8}, 8}, {{8, 8}, 16}, {{16, 16}, 16}};

// Three bodies that overlap, teleport, part, come back as they were, and change shape.
Bodies three_bodies(std::size_t vertices)
{
    Dice dice(11);
    Bodies out;
    out.surface.push_back(soft(brain(vertices), 14));
    out.surface.push_back(soft(fish(vertices), 9));
    out.surface.push_back(patchy(dice, ring_sphere(vertices / 2), 20, 5));
    auto frame = [&](double apart, double strength) {
        std::vector<Maps> all;
        for (const DeformableSurface& s : out.surface)
            all.push_back(around(dice, s.weights.node_count, dice.rotation(), apart * dice.point(), strength));
        out.add_frame(all);
    };
    for (const double apart : {0.5, 0.52, 0.3, 8.0, 0.6})
        frame(apart, 0.05);
    out.add_frame(out.maps[4]);
    out.add_frame(out.maps[0]);
    frame(0.5, 0.6); // explodes
    frame(1.2, 0.1);
    return out;
}

// Says where: one line per option.
std::string text(const LazyOptions& o)
{
    return name_of(o.methods) + ", k " + std::to_string(o.kdop) + ", " + std::string(name_of(o.precision)) +
           ", update " + std::to_string(static_cast<int>(o.update)) + ", shape " +
           std::to_string(static_cast<int>(o.rest_shape)) + (o.keep_cut ? "" : ", front of pairs") + ", lanes " +
           std::to_string(o.lanes);
}

void check_in_order(const Bodies& bodies, const std::vector<Bvh>& trees, const LazyOptions& options,
                    const std::vector<Pairs>& truth, std::vector<Pairs>& order)
{
    INFO(text(options));
    Collider collider(options);
    for (std::size_t b = 0; b < trees.size(); ++b)
        collider.add(trees[b], bodies.surface[b]);
    for (std::size_t f = 0; f < bodies.frame.size(); ++f) {
        collider.update(bodies.frame[f]);
        const Pairs found = collider.pairs();
        INFO("frame " << f << ": " << difference(truth[f], sorted(found)));
        if (order.size() == f)
            order.push_back(in_order_of_trees(collider, truth[f]));
        REQUIRE(order[f].size() == truth[f].size());
        REQUIRE((found == order[f]));
        REQUIRE(collider.unknown().empty());
    }
}

} // namespace

TEST_CASE("the pairs are those of brute force, in the order of the trees, for every method, k, precision and shape")
{
    const Bodies bodies = three_bodies(110);
    const std::vector<Pairs> truth = bodies.truth();
    std::size_t pairs = 0;
    for (const Pairs& some : truth)
        pairs += some.size();
    REQUIRE(pairs > 1000);
    REQUIRE(truth[3].empty());
    REQUIRE((truth[5] == truth[4]));
    Dice dice(1);
    for (const Leaf& leaf : share_of(every_leaf)) {
        const std::vector<Bvh> trees = bodies.trees(leaf.size, RestDetail::all);
        std::vector<Pairs> order;
        for (const Methods methods : every_method)
            for (const int kdop : kdops) {
                LazyOptions options;
                options.methods = methods;
                options.kdop = kdop;
                options.precision = dice.below(2) ? Precision::float32 : Precision::float64;
                options.update = every_update[dice.below(3)];
                options.rest_shape = dice.below(2) ? RestShape::aabb : RestShape::obb;
                options.keep_cut = dice.below(3) != 0;
                options.lanes = leaf.lanes;
                check_in_order(bodies, trees, options, truth, order);
            }
    }
}

TEST_CASE("the pairs are those of brute force, in the order of the trees, for every update, leaf and precision")
{
    const Bodies bodies = three_bodies(260);
    const std::vector<Pairs> truth = bodies.truth();
    for (const Leaf& leaf : share_of(every_leaf)) {
        const std::vector<Bvh> trees = bodies.trees(leaf.size);
        std::vector<Pairs> order;
        for (const Update update : every_update)
            for (const bool keep_cut : {true, false})
                for (const Precision precision : {Precision::float32, Precision::float64}) {
                    LazyOptions options;
                    options.update = update;
                    options.keep_cut = keep_cut;
                    options.precision = precision;
                    options.lanes = leaf.lanes;
                    check_in_order(bodies, trees, options, truth, order);
                }
    }
}

TEST_CASE("the same pairs in the same order for 1, 2 and 7 threads")
{
    const tbb::global_control seven(tbb::global_control::max_allowed_parallelism, 7);
    const Bodies bodies = three_bodies(test_share() < 1 ? 500 : 3000);
    const std::vector<Pairs> truth = bodies.truth();
    const std::vector<Bvh> trees = bodies.trees({16, 16});
    for (const bool keep_cut : {true, false})
        for (const Update update : share_of(every_update)) {
            LazyOptions options;
            options.update = update;
            options.keep_cut = keep_cut;
            std::vector<std::vector<Pairs>> lists;
            for (const int threads : {1, 2, 7})
                tbb::task_arena(threads).execute([&] {
                    Collider collider(options);
                    for (std::size_t b = 0; b < trees.size(); ++b)
                        collider.add(trees[b], bodies.surface[b]);
                    lists.emplace_back();
                    for (const auto& frame : bodies.frame) {
                        collider.update(frame);
                        lists.back().push_back(collider.pairs());
                    }
                });
            for (std::size_t f = 0; f < truth.size(); ++f) {
                INFO(text(options) << ", frame " << f << ": " << difference(truth[f], sorted(lists[0][f])));
                REQUIRE((sorted(lists[0][f]) == truth[f]));
                REQUIRE((lists[1][f] == lists[0][f]));
                REQUIRE((lists[2][f] == lists[0][f]));
            }
        }
}

TEST_CASE("vertices may be given instead of transforms, or in turns with them")
{
    Bodies bodies = three_bodies(260);
    Dice dice(2);
    const std::size_t by_maps = bodies.frame.size();
    for (std::size_t f = 0; f < by_maps; ++f) {
        std::vector<Positions> given;
        for (std::size_t b = 0; b < bodies.surface.size(); ++b) {
            given.push_back(positions_of(bodies.surface[b], bodies.frame[f][b]));
            for (Vec3& x : given.back()) // what no transforms give
                x += 0.02 * dice.point();
        }
        bodies.add_positions(given);
        if (f % 3 == 0)
            bodies.add_frame(bodies.maps[f]);
    }
    std::vector<BodyFrame> mixed = bodies.frame[0];
    mixed[1] = bodies.frame[by_maps][1];
    bodies.frame.push_back(mixed);
    const std::vector<Pairs> truth = bodies.truth();
    for (const Leaf& leaf : share_of(every_leaf)) {
        const std::vector<Bvh> trees = bodies.trees(leaf.size);
        std::vector<Pairs> order;
        for (const int kdop : kdops)
            for (const bool keep_cut : {true, false}) {
                LazyOptions options;
                options.kdop = kdop;
                options.keep_cut = keep_cut;
                options.lanes = leaf.lanes;
                check_in_order(bodies, trees, options, truth, order);
            }
    }
}

TEST_CASE("any and leaves: right, stopped where told, and no obstacle for what is asked next")
{
    const Bodies bodies = three_bodies(260);
    const std::vector<Pairs> truth = bodies.truth();
    for (const Leaf& leaf : share_of(every_leaf))
        for (const bool keep_cut : {true, false})
            for (const Update update : every_update) {
                LazyOptions options;
                options.lanes = leaf.lanes;
                options.keep_cut = keep_cut;
                options.update = update;
                const std::vector<Bvh> trees = bodies.trees(leaf.size);
                Collider collider(options);
                for (std::size_t b = 0; b < trees.size(); ++b)
                    collider.add(trees[b], bodies.surface[b]);
                std::vector<std::vector<std::uint32_t>> first_of(
                    trees.size()); // triangle of the mesh to the first of its leaf
                for (std::size_t b = 0; b < trees.size(); ++b) {
                    first_of[b].resize(bodies.surface[b].mesh.triangles.size());
                    for (const Bv& bv : trees[b].bvs)
                        if (bv.is_leaf())
                            for (std::uint32_t t = 0; t < bv.triangle_count; ++t)
                                first_of[b][trees[b].triangle[bv.first_triangle + t]] =
                                    trees[b].triangle[bv.first_triangle];
                }
                for (std::size_t f = 0; f < bodies.frame.size(); ++f) {
                    INFO(text(options) << ", frame " << f);
                    collider.update(bodies.frame[f]);
                    std::size_t calls = 0;
                    Pairs first;
                    const bool found = collider.find(Query::any, [&](std::span<const TrianglePair> some) {
                        ++calls;
                        first.assign(some.begin(), some.end());
                        return true;
                    });
                    REQUIRE(found == !truth[f].empty());
                    REQUIRE(calls == (found ? 1 : 0));
                    REQUIRE(first.size() == calls);
                    if (found)
                        REQUIRE(std::binary_search(truth[f].begin(), truth[f].end(), first[0]));
                    REQUIRE(collider.any() == found);
                    std::size_t deformed = 0;
                    for (const LazyRefit& tree : collider.parts().trees())
                        deformed += tree.counts().leaves;
                    REQUIRE(collider.counts().updates.leaves == deformed); // of the frame, not of the queries

                    Pairs leaves;
                    collider.find(Query::leaves, [&](std::span<const TrianglePair> some) {
                        leaves.insert(leaves.end(), some.begin(), some.end());
                        return true;
                    });
                    const std::set<TrianglePair> all(leaves.begin(), leaves.end());
                    REQUIRE(all.size() == leaves.size());
                    for (const TrianglePair& p : truth[f])
                        REQUIRE(all.count(
                            {p.body_a, first_of[p.body_a][p.triangle_a], p.body_b, first_of[p.body_b][p.triangle_b]}));

                    REQUIRE((sorted(collider.pairs()) == truth[f]));
                    calls = 0;
                    REQUIRE(collider.find(Query::pairs,
                                          [&](std::span<const TrianglePair>) { return ++calls, false; }) == found);
                    REQUIRE(calls == (found ? 1 : 0));
                    if (f % 2)
                        REQUIRE((sorted(collider.pairs()) == truth[f]));
                }
            }
}

TEST_CASE("one body is in no pair, and wrong sizes are refused")
{
    const Bodies bodies = three_bodies(110);
    const std::vector<Bvh> trees = bodies.trees({16, 16});
    Collider collider{LazyOptions{}};
    collider.update({});
    CHECK(collider.pairs().empty());
    collider.add(trees[0], bodies.surface[0]);
    collider.update(std::span(bodies.frame[0]).first(1));
    CHECK(collider.pairs().empty());
    CHECK_FALSE(collider.any());
    CHECK_THROWS_AS(collider.update({}), std::invalid_argument);
    CHECK_THROWS_AS(collider.update(bodies.frame[0]), std::invalid_argument);
    const BodyFrame few{std::span(bodies.maps[0][0]).first(3)};
    CHECK_THROWS_AS(collider.update({&few, 1}), std::invalid_argument);
    const Positions one{{0, 0, 0}};
    const BodyFrame short_of_vertices{{}, one};
    CHECK_THROWS_AS(collider.update({&short_of_vertices, 1}), std::invalid_argument);
    LazyOptions narrow;
    narrow.lanes = 8;
    Collider too_narrow(narrow);
    CHECK_THROWS_AS(too_narrow.add(trees[0], bodies.surface[0]), std::invalid_argument);
}
