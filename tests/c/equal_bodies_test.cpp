// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies that intersect, characters, scenes and baked files through C: the same as in C++.
#include <catch2/catch.hpp>

#include <cstring>
#include <fstream>
#include <thread>

#include "cinch/collider.hpp"
#include "cinch/environment.hpp"
#include "cinch/simulate.hpp"
#include "tests/c/c_surface.hpp"

using namespace cinch;
using namespace cinch::test;

namespace {

const std::string tube = CINCH_DATA "/scenes/tube.glb";

std::vector<AffineMap> shifted(std::vector<AffineMap> maps, double by)
{
    for (AffineMap& map : maps)
        map.m[0][3] += by;
    return maps;
}

cinch_body_frame frame_of(const std::vector<AffineMap>& maps)
{
    cinch_body_frame frame{};
    frame.maps = maps[0].m[0];
    frame.map_count = maps.size();
    return frame;
}

// All pairs of the frame by a query, the last one.
std::vector<TrianglePair> c_pairs(cinch_collider* collider, std::int32_t query)
{
    std::size_t count = 0;
    REQUIRE(cinch_collider_query(collider, query, &count) == CINCH_OK);
    std::vector<TrianglePair> pairs(count);
    REQUIRE(cinch_collider_get_pairs(collider, count ? &pairs[0].body_a : nullptr, count) == CINCH_OK);
    return pairs;
}

std::vector<TrianglePair> pairs_of(Collider& collider, Query query)
{
    std::vector<TrianglePair> all;
    collider.find(query, [&](std::span<const TrianglePair> some) {
        all.insert(all.end(), some.begin(), some.end());
        return true;
    });
    return all;
}

std::int32_t not_0_and_2(void* asked, std::uint32_t a, std::uint32_t b)
{
    ++*static_cast<int*>(asked);
    return !(a == 0 && b == 2);
}

// Every task on a thread of its own; counts its calls.
void on_threads(void* context, std::size_t count, cinch_task task, void* work)
{
    ++*static_cast<int*>(context);
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < 3; ++t)
        threads.emplace_back([=] {
            for (std::size_t i = t; i < count; i += 3)
                task(work, i);
        });
    for (std::thread& thread : threads)
        thread.join();
}

} // namespace

TEST_CASE("pairs of triangles through C are those of C++, with filters, options of bodies, positions and removal")
{
    const Example e = example(500, 25);
    const Handle<cinch_surface> surface = c_surface(e.surface);
    for (const int k : {6, 18}) {
        LazyOptions options;
        options.kdop = k;
        LazyOptions own = options;
        own.methods = Method::eq12;
        own.precision = Precision::float64;
        own.update = Update::lazy;
        Collider truth(options);
        truth.add(e.surface);
        truth.add(e.surface, own);
        const Bvh bvh = build_bvh(e.surface, ClusterSize{16, 16});
        truth.add(bvh, e.surface);

        cinch_body_options c_options{}, c_own{};
        c_options.kdop = k;
        c_own.methods = CINCH_METHOD_EQ12;
        c_own.float64 = 1;
        c_own.update = 1;
        Handle<cinch_collider> collider;
        Handle<cinch_bvh> tree;
        std::uint32_t id = 77;
        REQUIRE(cinch_collider_new(&c_options, collider.out()) == CINCH_OK);
        REQUIRE(cinch_bvh_build(surface.get(), 16, 16, CINCH_DETAIL_ALL, tree.out()) == CINCH_OK);
        REQUIRE(cinch_collider_add(collider.get(), surface.get(), nullptr, nullptr, &id) == CINCH_OK);
        REQUIRE(cinch_collider_add(collider.get(), surface.get(), nullptr, &c_own, &id) == CINCH_OK);
        REQUIRE(cinch_collider_add(collider.get(), surface.get(), tree.get(), nullptr, &id) == CINCH_OK);
        CHECK(id == 2);
        int asked = 0;
        for (std::size_t f = 0; f < e.frames.size(); ++f) {
            const auto a = e.frames[f], b = shifted(a, 0.4), c = shifted(a, -0.3);
            std::vector<Vec3> positions(e.surface.mesh.vertices.size());
            evaluate(e.surface.mesh.vertices, e.surface.weights, b, positions);
            BodyFrame frames[] = {{a}, {b}, {c}};
            cinch_body_frame c_frames[] = {frame_of(a), frame_of(b), frame_of(c)};
            if (f == 1) {
                frames[1].positions = positions;
                c_frames[1].positions = positions[0].data();
                c_frames[1].position_count = positions.size();
            }
            truth.update(frames);
            REQUIRE(cinch_collider_update(collider.get(), c_frames, 3) == CINCH_OK);
            REQUIRE(truth.pairs().size() > 10);
            CHECK(c_pairs(collider.get(), CINCH_QUERY_PAIRS) == truth.pairs());
            CHECK(c_pairs(collider.get(), CINCH_QUERY_LEAVES) == pairs_of(truth, Query::leaves));
            CHECK(c_pairs(collider.get(), CINCH_QUERY_ANY).size() == 1);
            if (f == 1) {
                truth.set_filter([](BodyId x, BodyId y) { return !(x == 0 && y == 2); });
                REQUIRE(cinch_collider_set_filter(collider.get(), not_0_and_2, &asked) == CINCH_OK);
            }
        }
        CHECK(asked > 0);
        truth.remove(1);
        REQUIRE(cinch_collider_remove(collider.get(), 1) == CINCH_OK);
        std::size_t count = 0;
        std::uint32_t ids[3];
        REQUIRE(cinch_collider_get_bodies(collider.get(), 0, ids, 3, &count) == CINCH_OK);
        CHECK((count == 2 && ids[0] == 0 && ids[1] == 2));
        const auto still = e.frames[0];
        auto unknown = still;
        unknown[3].m[1][1] = NAN;
        const BodyFrame frames[] = {{still}, {unknown}};
        const cinch_body_frame c_frames[] = {frame_of(still), frame_of(unknown)};
        truth.update(frames);
        REQUIRE(cinch_collider_update(collider.get(), c_frames, 2) == CINCH_OK);
        CHECK(c_pairs(collider.get(), CINCH_QUERY_PAIRS) == truth.pairs());
        REQUIRE(cinch_collider_get_bodies(collider.get(), 1, ids, 3, &count) == CINCH_OK);
        CHECK((count == 1 && ids[0] == truth.unknown().at(0)));
        cinch_query_counts counts;
        REQUIRE(cinch_collider_get_counts(collider.get(), &counts) == CINCH_OK);
        CHECK(counts.box_tests == truth.counts().box_tests);
    }
}

TEST_CASE("a character through C: surface, frames, and bounds for all times of its clips")
{
    const Character character = read_gltf(tube, Coverage::whole, Morphs::read);
    const DeformableSurface surface = surface_of(character);
    const Bvh bvh = build_bvh(surface, 8);
    Handle<cinch_character> c_character;
    Handle<cinch_surface> c_of;
    std::size_t clips = 0;
    REQUIRE(cinch_character_read(tube.c_str(), 0, c_character.out()) == CINCH_OK);
    REQUIRE(cinch_character_get_surface(c_character.get(), c_of.out(), &clips) == CINCH_OK);
    REQUIRE(clips == character.animations.size());
    Handle<cinch_bvh> c_tree;
    REQUIRE(cinch_bvh_build(c_of.get(), 8, 0, CINCH_DETAIL_ALL, c_tree.out()) == CINCH_OK);
    for (const std::size_t clip : {std::size_t{0}, CINCH_REST}) {
        const Character::Animation& animation = clip ? character.rest : character.animations[0];
        cinch_clip_info info;
        REQUIRE(cinch_character_get_clip(c_character.get(), clip, &info) == CINCH_OK);
        CHECK(info.name == animation.name);
        const Clip frames = clip ? rest_pose(character) : sample(character, animation, 10);
        Handle<cinch_clip> c_frames;
        std::size_t count = 0;
        REQUIRE(cinch_character_sample(c_character.get(), clip, 10, c_frames.out(), &count) == CINCH_OK);
        REQUIRE(count == frames.frame_count());
        for (std::size_t f = 0; f < count; ++f) {
            std::vector<AffineMap> maps(surface.weights.node_count);
            double time = 0;
            REQUIRE(cinch_clip_get_frame(c_frames.get(), f, &time, maps[0].m[0], maps.size(), nullptr, 0) == CINCH_OK);
            CHECK(time == frames.time_s(f));
            CHECK(std::memcmp(maps.data(), frames.frame(f).data(), maps.size() * sizeof(AffineMap)) == 0);
        }
        ClipBounder bound(character, animation, surface, bvh);
        Handle<cinch_clip_bounder> bounder;
        REQUIRE(cinch_clip_bounder_new(c_character.get(), clip, c_tree.get(), nullptr, bounder.out()) == CINCH_OK);
        const double middle = (info.first_s + info.last_s) / 2, times[] = {info.first_s, middle, middle, info.last_s};
        std::vector<double> truth(6 * bvh.bvs.size()), out(2 * truth.size());
        REQUIRE(cinch_clip_bounder_bound(bounder.get(), times, 2, 0.01, out.data(), 2 * bvh.bvs.size()) == CINCH_OK);
        for (std::size_t i = 0; i < 2; ++i) {
            bound(times[2 * i], times[2 * i + 1], truth);
            CHECK(std::memcmp(truth.data(), &out[i * truth.size()], 8 * truth.size()) == 0);
        }
    }
}

TEST_CASE("a scene through C takes the steps of C++")
{
    const std::string beam = CINCH_DATA "/scenes/beam.json";
    SceneSimulation truth{std::filesystem::path(beam)};
    Handle<cinch_simulation> scene;
    REQUIRE(cinch_simulation_read(beam.c_str(), scene.out()) == CINCH_OK);
    for (int f = 0; f < 3; ++f) {
        const std::vector<AffineMap> maps = truth.transforms(0);
        std::vector<AffineMap> c_maps(maps.size());
        std::size_t count = 0;
        REQUIRE(cinch_simulation_get_maps(scene.get(), 0, c_maps[0].m[0], maps.size(), &count) == CINCH_OK);
        REQUIRE(count == maps.size());
        CHECK(std::memcmp(maps.data(), c_maps.data(), count * sizeof(AffineMap)) == 0);
        truth.advance();
        REQUIRE(cinch_simulation_advance(scene.get()) == CINCH_OK);
    }
    cinch_simulation_state state;
    REQUIRE(cinch_simulation_get_state(scene.get(), &state) == CINCH_OK);
    CHECK((state.frame == 3 && state.time_s == truth.time_s() && state.frames == truth.frame_count()));
    Handle<cinch_surface> surface;
    const char* name = nullptr;
    REQUIRE(cinch_simulation_get_body(scene.get(), 0, &name, surface.out()) == CINCH_OK);
    CHECK(name == truth.name(0));
    cinch_surface_sizes sizes;
    scene = {}; // the surface stays
    REQUIRE(cinch_surface_get_sizes(surface.get(), &sizes) == CINCH_OK);
    CHECK(sizes.vertices == truth.surface(0)->mesh.vertices.size());
}

TEST_CASE("an executor of C does what oneTBB does, and one that does not do its work is an error")
{
    const Example e = example(3000, 60);
    const Handle<cinch_surface> surface = c_surface(e.surface);
    std::vector<double> supports[2];
    int calls = 0;
    for (std::vector<double>& out : supports) {
        Handle<cinch_bvh> bvh;
        Handle<cinch_refitter> refitter;
        REQUIRE(cinch_bvh_build(surface.get(), 4, 0, CINCH_DETAIL_ALL, bvh.out()) == CINCH_OK);
        REQUIRE(cinch_refitter_new(bvh.get(), nullptr, refitter.out()) == CINCH_OK);
        cinch_bvh_sizes sizes;
        REQUIRE(cinch_bvh_get_sizes(bvh.get(), &sizes) == CINCH_OK);
        out.resize(6 * sizes.bvs);
        const double* const maps = e.frames[1][0].m[0];
        REQUIRE(cinch_refitter_refit(refitter.get(), 1, maps, 60, nullptr, 0, out.data(), sizes.bvs, nullptr) ==
                CINCH_OK);
        REQUIRE(cinch_use_executor(on_threads, &calls) == CINCH_OK);
        if (calls == 0)
            continue;
        const cinch_run idle = [](void*, std::size_t, cinch_task, void*) {};
        const cinch_run twice = [](void*, std::size_t count, cinch_task task, void* work) {
            for (std::size_t i = 0; i < 2 * count; ++i)
                task(work, i / 2 + (i == 1 ? count : 0));
            task(work, count);
        };
        std::vector<double> again(out.size());
        REQUIRE(cinch_use_executor(idle, nullptr) == CINCH_OK);
        CHECK(cinch_refitter_refit(refitter.get(), 1, maps, 60, nullptr, 0, again.data(), sizes.bvs, nullptr) ==
              CINCH_ERROR_RUNTIME);
        CHECK(std::string(cinch_error_message()).starts_with("the executor did 0 of "));
        REQUIRE(cinch_use_executor(twice, nullptr) == CINCH_OK);
        CHECK(cinch_refitter_refit(refitter.get(), 1, maps, 60, nullptr, 0, again.data(), sizes.bvs, nullptr) ==
              CINCH_OK);
        CHECK(again == out);
    }
    REQUIRE(cinch_use_executor(nullptr, nullptr) == CINCH_OK);
    CHECK(calls > 0);
    CHECK(supports[0] == supports[1]);
}
