// SPDX-License-Identifier: GPL-3.0-or-later
// A collider that is used wrongly says so; it never answers from a frame that is not there.
#include <cfenv>

#include <catch2/catch.hpp>

#include "tests/collide/random_bodies.hpp"

using namespace cinch;
using namespace cinch::test;

namespace {

template <class B, class S>
concept can_be_added = requires(Collider collider, B bvh, S surface)
{
    collider.add(std::forward<B>(bvh), std::forward<S>(surface));
};

static_assert(can_be_added<Bvh&, DeformableSurface&> && can_be_added<const Bvh&, const DeformableSurface&>);
static_assert(can_be_added<Bvh, DeformableSurface&> && can_be_added<Bvh, const DeformableSurface&>,
              "a BVH that is moved in is kept");
static_assert(!can_be_added<Bvh&, DeformableSurface> && !can_be_added<const Bvh&, const DeformableSurface> &&
                  !can_be_added<Bvh, DeformableSurface> && !can_be_added<Bvh, const DeformableSurface>,
              "a surface is referred to");
static_assert(!can_be_added<const Bvh, DeformableSurface&> && !can_be_added<const Bvh, DeformableSurface>,
              "what cannot be moved in is referred to");

Bodies some_bodies(std::size_t count)
{
    Dice dice(91);
    Bodies out;
    for (std::size_t b = 0; b < count; ++b)
        out.surface.push_back(soft(b % 2 ? fish(120) : brain(120), 8));
    for (int f = 0; f < 3; ++f) {
        std::vector<Maps> maps;
        for (std::size_t b = 0; b < count; ++b)
            maps.push_back(around(dice, 8, dice.rotation(), 0.4 * dice.point(), 0.05));
        out.add_frame(maps);
    }
    return out;
}

/// Every query, by the message of what it throws.
void check_refused(Collider& collider, const std::string& when)
{
    CHECK_THROWS_AS(collider.pairs(), std::logic_error);
    for (const std::string& what : {when, std::string("call update() with one frame per body")}) {
        CHECK_THROWS_WITH(collider.pairs(), Catch::Contains(what));
        CHECK_THROWS_WITH(collider.any(), Catch::Contains(what));
        CHECK_THROWS_WITH(collider.unknown(), Catch::Contains(what));
        for (const Query query : {Query::pairs, Query::any, Query::leaves}) {
            std::size_t calls = 0;
            CHECK_THROWS_WITH(collider.find(query, [&](std::span<const TrianglePair>) { return ++calls, true; }),
                              Catch::Contains(what));
            CHECK(calls == 0);
        }
    }
}

} // namespace

TEST_CASE("a query before the first update is refused, with and without bodies")
{
    const Bodies bodies = some_bodies(2);
    const std::vector<Bvh> trees = bodies.trees({16, 16});
    Collider collider{LazyOptions{}};
    check_refused(collider, "before the first update()");
    collider.update({});
    CHECK(collider.pairs().empty());
    collider.add(trees[0], bodies.surface[0]);
    check_refused(collider, "after add()");
    collider.add(trees[1], bodies.surface[1]);
    collider.update(bodies.frame[0]);
    CHECK((sorted(collider.pairs()) == bodies.truth()[0]));
    Collider never{LazyOptions{}};
    never.add(trees[0], bodies.surface[0]);
    check_refused(never, "after add()");
}

TEST_CASE("a tree that the collider builds has the rest data of every method")
{
    const Bodies bodies = some_bodies(2);
    for (const Method method : all_methods) {
        INFO(name_of(method));
        LazyOptions options;
        options.methods = method;
        options.update = Update::lazy;
        Collider collider(options);
        for (const DeformableSurface& surface : bodies.surface)
            collider.add(surface);
        collider.update(bodies.frame[0]);
        CHECK((sorted(collider.pairs()) == bodies.truth()[0]));
    }
}

TEST_CASE("after an update that threw queries are refused until one succeeds, and then all pairs are there")
{
    const Bodies bodies = some_bodies(4);
    const std::vector<Bvh> trees = bodies.trees({16, 16});
    const std::vector<Pairs> truth = bodies.truth();
    const Positions one{{0, 0, 0}};
    for (const bool keep_cut : {true, false})
        for (const Update update : {Update::lazy, Update::full, Update::automatic}) {
            LazyOptions options;
            options.keep_cut = keep_cut;
            options.update = update;
            Collider collider(options);
            for (std::size_t b = 0; b < trees.size(); ++b)
                collider.add(trees[b], bodies.surface[b]);
            auto check_well = [&](std::size_t f) {
                collider.update(bodies.frame[f]);
                REQUIRE((sorted(collider.pairs()) == truth[f]));
            };
            auto check_thrown = [&](const std::vector<BodyFrame>& frame) {
                CHECK_THROWS_AS(collider.update(frame), std::invalid_argument);
                check_refused(collider, "after an update() that threw");
            };
            check_thrown({}); // before any that succeeded
            check_well(0);
            for (std::size_t bad = 0; bad < 4; ++bad) {
                std::vector<BodyFrame> frame = bodies.frame[1];
                frame[bad].maps = frame[bad].maps.first(5); // too few simulation nodes
                check_thrown(frame);
                check_well(1);
                frame = bodies.frame[2];
                frame[bad].positions = one;
                check_thrown(frame);
                check_thrown(frame);
                check_well(2);
            }
            check_thrown(std::vector<BodyFrame>(bodies.frame[0].begin(), bodies.frame[0].begin() + 3));
            check_well(0);
            REQUIRE(std::fesetround(FE_UPWARD) == 0);
            CHECK_THROWS_AS(collider.update(bodies.frame[0]), std::runtime_error);
            std::fesetround(FE_TONEAREST);
            check_refused(collider, "after an update() that threw");
            check_well(1);
        }
}

TEST_CASE("a body added after an update needs another one, and one that is refused changes nothing")
{
    const Bodies bodies = some_bodies(3);
    const std::vector<Bvh> trees = bodies.trees({16, 16});
    const Bvh whole = build_bvh(bodies.surface[2], bodies.surface[2].mesh.triangles.size());
    Collider collider{LazyOptions{}};
    for (std::size_t b = 0; b < 2; ++b)
        collider.add(trees[b], bodies.surface[b]);
    const auto first_two = std::span(bodies.frame[0]).first(2);
    collider.update(first_two);
    const Pairs before = collider.pairs();
    CHECK(!before.empty());
    CHECK_THROWS_AS(collider.add(whole, bodies.surface[2]), std::invalid_argument); // one leaf of all triangles
    CHECK((collider.pairs() == before));
    collider.add(trees[2], bodies.surface[2]);
    check_refused(collider, "after add()");
    CHECK_THROWS_AS(collider.update(first_two), std::invalid_argument);
    collider.update(bodies.frame[0]);
    CHECK((sorted(collider.pairs()) == bodies.truth()[0]));
}

TEST_CASE("a sink that throws leaves the frame as it was")
{
    const Bodies bodies = some_bodies(3);
    const std::vector<Bvh> trees = bodies.trees({16, 16});
    Collider collider{LazyOptions{}};
    for (std::size_t b = 0; b < 3; ++b)
        collider.add(trees[b], bodies.surface[b]);
    for (std::size_t f = 0; f < bodies.frame.size(); ++f) {
        collider.update(bodies.frame[f]);
        for (const Query query : {Query::pairs, Query::any, Query::leaves})
            CHECK_THROWS_AS(
                collider.find(query, [](std::span<const TrianglePair>) -> bool { throw std::out_of_range("enough"); }),
                std::out_of_range);
        CHECK((sorted(collider.pairs()) == bodies.truth()[f]));
    }
}

TEST_CASE("a BVH that is moved in is kept for every method")
{
    const Bodies bodies = some_bodies(2);
    const std::vector<Pairs> truth = bodies.truth();
    for (const Method method : all_methods) {
        LazyOptions options;
        options.methods = method;
        options.update = Update::lazy;
        Collider moved(options), lent(options);
        const std::vector<Bvh> trees = bodies.trees({16, 16});
        for (std::size_t b = 0; b < 2; ++b) {
            moved.add(build_bvh(bodies.surface[b], ClusterSize{16, 16}), bodies.surface[b]);
            lent.add(trees[b], bodies.surface[b]);
        }
        const bool refers = Methods(Method::sphere | Method::corners | Method::vertices).contains(method);
        CHECK((moved.bytes() > lent.bytes()) == refers);
        for (std::size_t f = 0; f < truth.size(); ++f) {
            moved.update(bodies.frame[f]);
            CHECK((sorted(moved.pairs()) == truth[f]));
        }
    }
}
