// SPDX-License-Identifier: GPL-3.0-or-later
// What an engine asks of a collider: bodies that come and go, pairs that are not wanted, its own jobs, its own
// floating-point environment.
#include <algorithm>
#include <cfenv>
#include <thread>

#include <catch2/catch.hpp>

#include "cinch/collider.hpp"
#include "cinch/environment.hpp"
#include "cinch/refit.hpp"
#include "tests/support.hpp"

using namespace cinch;

namespace {

// Three bodies of one surface, the second and third a little aside.
struct Crowd {
    test::Example e = test::example(300, 20);
    std::vector<std::vector<AffineMap>> maps;

    Crowd()
    {
        for (const double aside : {0.0, 0.2, 0.4}) {
            maps.push_back(e.frames[1]);
            for (AffineMap& map : maps.back())
                map.m[0][3] += aside;
        }
    }
    std::vector<TrianglePair> pairs(Collider& collider, const std::vector<std::size_t>& which) const
    {
        std::vector<BodyFrame> frames;
        for (const std::size_t i : which)
            frames.push_back({maps[i], {}});
        collider.update(frames);
        return collider.pairs();
    }
};

std::vector<TrianglePair> only(std::vector<TrianglePair> pairs, auto&& wanted)
{
    std::erase_if(pairs, [&](const TrianglePair& p) { return !wanted(p.body_a, p.body_b); });
    return pairs;
}

// Runs what it is given on threads of its own, last piece first.
class Backwards : public Executor {
public:
    std::size_t calls = 0;

    void run(std::size_t count, const std::function<void(std::size_t)>& task) override
    {
        ++calls;
        for (std::size_t i = count; i-- > 0;)
            std::thread([&] { task(i); }).join();
    }
};

} // namespace

TEST_CASE("a body that is taken away is in no pair, and the others keep their ids and pairs")
{
    const Crowd crowd;
    Collider collider;
    for (int i = 0; i < 3; ++i)
        CHECK(collider.add(crowd.e.surface) == static_cast<BodyId>(i));
    const auto all = crowd.pairs(collider, {0, 1, 2});
    REQUIRE(only(all, [](BodyId a, BodyId b) { return a == 0 && b == 2; }).size() > 0);
    collider.remove(1);
    CHECK_THROWS_AS(collider.pairs(), std::logic_error); // the frame is of other bodies
    CHECK_THROWS_AS(collider.remove(1), std::invalid_argument);
    CHECK((std::vector<BodyId>(collider.bodies().begin(), collider.bodies().end()) == std::vector<BodyId>{0, 2}));
    CHECK((crowd.pairs(collider, {0, 2}) == only(all, [](BodyId a, BodyId b) { return a != 1 && b != 1; })));
    CHECK(collider.add(crowd.e.surface) == 3); // no id comes twice
    CHECK(crowd.pairs(collider, {0, 2, 1}).size() == all.size());
    for (const BodyId id : {0u, 2u, 3u})
        collider.remove(id);
    CHECK(crowd.pairs(collider, {}).empty());
}

TEST_CASE("a filter leaves out the pairs of bodies that it does not want, and nothing else")
{
    const Crowd crowd;
    for (const bool keep_cut : {true, false}) {
        LazyOptions options;
        options.keep_cut = keep_cut;
        Collider collider(options);
        for (int i = 0; i < 3; ++i)
            collider.add(crowd.e.surface);
        const auto all = crowd.pairs(collider, {0, 1, 2});
        const auto wanted = [](BodyId a, BodyId b) { return a + b != 2; };
        collider.set_filter(wanted);
        const auto some = crowd.pairs(collider, {0, 1, 2});
        CHECK(some.size() < all.size());
        CHECK((some == only(all, wanted)));
        collider.set_filter({});
        CHECK((crowd.pairs(collider, {0, 1, 2}) == all));
    }
}

TEST_CASE("each body may have methods of its own, with the same pairs, but not another k-DOP")
{
    const Crowd crowd;
    Collider usual, own;
    for (int i = 0; i < 3; ++i)
        usual.add(crowd.e.surface);
    LazyOptions options;
    for (const Method method : {Method::vertices, Method::eq12, Method::best}) {
        options.methods = method;
        options.precision = method == Method::eq12 ? Precision::float64 : Precision::float32;
        own.add(crowd.e.surface, options);
    }
    CHECK((crowd.pairs(own, {0, 1, 2}) == crowd.pairs(usual, {0, 1, 2})));
    options.kdop = 14;
    CHECK_THROWS_AS(own.add(crowd.e.surface, options), std::invalid_argument);
    CHECK(own.bodies().size() == 3);
}

TEST_CASE("an engine's jobs give the same bits as oneTBB")
{
    const Crowd crowd;
    const Bvh bvh = build_bvh(crowd.e.surface, 1);
    std::vector<double> here(bvh.bvs.size() * 6), there(here);
    Refitter refit(bvh, crowd.e.surface, {});
    Collider collider;
    for (int i = 0; i < 3; ++i)
        collider.add(crowd.e.surface);
    refit(crowd.maps[0], here);
    const auto pairs = crowd.pairs(collider, {0, 1, 2});
    Backwards backwards;
    {
        const UseExecutor use(backwards);
        refit(crowd.maps[0], there);
        CHECK((crowd.pairs(collider, {0, 1, 2}) == pairs));
    }
    CHECK(backwards.calls > 0);
    CHECK((there == here));
    const std::size_t calls = backwards.calls;
    refit(crowd.maps[0], there);
    CHECK(backwards.calls == calls); // oneTBB again
}

TEST_CASE("the default environment can be had for a while, whatever the thread's is")
{
    const Crowd crowd;
    const Bvh bvh = build_bvh(crowd.e.surface, 4);
    std::vector<double> supports(bvh.bvs.size() * 6);
    std::fesetround(FE_UPWARD);
    bool refused = false, done = false;
    int after = 0;
    try {
        refit(bvh, crowd.e.surface, crowd.maps[0], {}, supports);
    } catch (const std::runtime_error&) {
        refused = true;
    }
    {
        const DefaultArithmetic guard;
        refit(bvh, crowd.e.surface, crowd.maps[0], {}, supports);
        done = true;
    }
    after = std::fegetround();
    std::fesetround(FE_TONEAREST);
    CHECK(refused);
    CHECK(done);
    CHECK(after == FE_UPWARD);
}
