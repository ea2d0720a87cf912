// SPDX-License-Identifier: GPL-3.0-or-later
// What fails through C says what the exception of C++ says.
#include <catch2/catch.hpp>

#include "cinch/collider.hpp"
#include "cinch/simulate.hpp"
#include "tests/c/c_surface.hpp"

using namespace cinch;
using namespace cinch::test;

namespace {

// The status, and the sentence of what the C++ call throws.
template <class Exception, class F> void same_sentence(cinch_status wanted, cinch_status got, F&& f)
{
    CHECK(got == wanted);
    const std::string said = cinch_error_message();
    try {
        f();
        FAIL("C++ takes what C refuses: " + said);
    } catch (const Exception& error) {
        CHECK(said == error.what());
    }
}

} // namespace

TEST_CASE("errors through C have the sentences of the exceptions")
{
    const Example e = example(300, 12);
    const Handle<cinch_surface> surface = c_surface(e.surface);
    const Bvh bvh = build_bvh(e.surface, 4), boxes = build_bvh(e.surface, 4, RestDetail::boxes);
    Handle<cinch_bvh> c_bvh, c_boxes, none;
    REQUIRE(cinch_bvh_build(surface.get(), 4, 0, CINCH_DETAIL_ALL, c_bvh.out()) == CINCH_OK);
    REQUIRE(cinch_bvh_build(surface.get(), 4, 0, CINCH_DETAIL_BOXES, c_boxes.out()) == CINCH_OK);
    using Invalid = std::invalid_argument;
    const cinch_status argument = CINCH_ERROR_ARGUMENT;

    same_sentence<Invalid>(argument, cinch_bvh_build(surface.get(), 0, 0, 0, none.out()),
                           [&] { build_bvh(e.surface, 0); });
    same_sentence<Invalid>(argument, cinch_bvh_build(surface.get(), 0, 9, 0, none.out()), [&] {
        build_bvh(e.surface, ClusterSize{0, 9});
    });

    Handle<cinch_refitter> refitter;
    cinch_refit_options options{};
    options.kdop = 8;
    same_sentence<Invalid>(argument, cinch_refitter_new(c_bvh.get(), &options, refitter.out()), [&] {
        RefitOptions own;
        own.kdop = 8;
        Refitter(bvh, e.surface, own);
    });
    same_sentence<Invalid>(argument, cinch_refitter_new(c_boxes.get(), nullptr, refitter.out()),
                           [&] { Refitter(boxes, e.surface, {}); });
    REQUIRE(cinch_refitter_new(c_bvh.get(), nullptr, refitter.out()) == CINCH_OK);
    Refitter refit(bvh, e.surface, {});
    std::vector<double> supports(6 * bvh.bvs.size());
    const std::vector<AffineMap>& maps = e.frames[0];
    const double* const m = maps[0].m[0];
    auto c_refit = [&](std::size_t map_count, std::size_t weight_count, std::size_t support_count) {
        return cinch_refitter_refit(refitter.get(), 1, m, map_count, m, weight_count, supports.data(), support_count,
                                    nullptr);
    };
    same_sentence<Invalid>(argument, c_refit(3, 0, bvh.bvs.size()), [&] { refit(std::span(maps).first(3), supports); });
    same_sentence<Invalid>(argument, c_refit(maps.size(), 0, 1), [&] { refit(maps, std::span(supports).first(6)); });
    same_sentence<Invalid>(argument, c_refit(maps.size(), 2, bvh.bvs.size()),
                           [&] { refit(maps, std::span(supports).first(2), supports); });

    Handle<cinch_crowd> crowd;
    same_sentence<Invalid>(argument, cinch_crowd_new(c_boxes.get(), nullptr, crowd.out()),
                           [&] { CrowdRefitter(boxes, e.surface); });
    REQUIRE(cinch_crowd_new(c_bvh.get(), nullptr, crowd.out()) == CINCH_OK);
    same_sentence<Invalid>(argument, cinch_crowd_refit(crowd.get(), m, 1, supports.data(), 0),
                           [&] { CrowdRefitter(bvh, e.surface)(std::span(maps).first(1), {}); });

    Handle<cinch_collider> collider;
    Collider truth;
    std::size_t count = 0;
    std::uint32_t id = 0;
    REQUIRE(cinch_collider_new(nullptr, collider.out()) == CINCH_OK);
    auto c_query = [&] { return cinch_collider_query(collider.get(), CINCH_QUERY_PAIRS, &count); };
    auto query = [&] { truth.pairs(); };
    same_sentence<std::logic_error>(CINCH_ERROR_ORDER, c_query(), query);
    REQUIRE(cinch_collider_add(collider.get(), surface.get(), nullptr, nullptr, &id) == CINCH_OK);
    truth.add(e.surface);
    same_sentence<std::logic_error>(CINCH_ERROR_ORDER, c_query(), query);
    same_sentence<Invalid>(argument, cinch_collider_update(collider.get(), nullptr, 0), [&] { truth.update({}); });
    same_sentence<std::logic_error>(CINCH_ERROR_ORDER, c_query(), query);
    same_sentence<Invalid>(argument, cinch_collider_remove(collider.get(), 5), [&] { truth.remove(5); });
    cinch_body_options own{};
    own.lanes = 4;
    same_sentence<Invalid>(argument, cinch_collider_add(collider.get(), surface.get(), nullptr, &own, &id), [&] {
        LazyOptions other;
        other.lanes = 4;
        truth.add(e.surface, other);
    });
    for (const std::size_t positions : {0, 5}) {
        cinch_body_frame frame{};
        frame.maps = m;
        frame.map_count = positions ? maps.size() : 2;
        frame.positions = e.surface.mesh.vertices[0].data();
        frame.position_count = positions;
        const BodyFrame same[] = {
            {std::span(maps).first(frame.map_count), std::span(e.surface.mesh.vertices).first(positions)}};
        same_sentence<Invalid>(argument, cinch_collider_update(collider.get(), &frame, 1), [&] { truth.update(same); });
        same_sentence<std::logic_error>(CINCH_ERROR_ORDER, c_query(), query);
    }
}

TEST_CASE("faults of files through C have the sentences of InputError")
{
    const TemporaryFolder folder;
    const std::string mesh = folder.write("a.off", "OFF\n1 1 0\n0 0 0\n3 0 0 1\n").string(),
                      glb = folder.write("a.glb", "glTF").string(), scene = folder.write("a.json", "{").string(),
                      tube = CINCH_DATA "/scenes/tube.glb";
    Handle<cinch_surface> surface;
    Handle<cinch_character> character;
    Handle<cinch_simulation> simulation;
    const cinch_status input = CINCH_ERROR_INPUT;
    same_sentence<InputError>(input, cinch_surface_read(mesh.c_str(), mesh.c_str(), surface.out()),
                              [&] { read_mesh(mesh); });
    same_sentence<InputError>(input, cinch_character_read(glb.c_str(), 0, character.out()), [&] { read_gltf(glb); });
    same_sentence<InputError>(input, cinch_simulation_read(scene.c_str(), simulation.out()),
                              [&] { SceneSimulation{std::filesystem::path(scene)}; });

    std::size_t clips = 0;
    Handle<cinch_bvh> c_bvh;
    Handle<cinch_clip_bounder> bounder;
    REQUIRE(cinch_character_read(tube.c_str(), 0, character.out()) == CINCH_OK);
    REQUIRE(cinch_character_get_surface(character.get(), surface.out(), &clips) == CINCH_OK);
    REQUIRE(cinch_bvh_build(surface.get(), 64, 0, CINCH_DETAIL_ALL, c_bvh.out()) == CINCH_OK);
    REQUIRE(cinch_clip_bounder_new(character.get(), 0, c_bvh.get(), nullptr, bounder.out()) == CINCH_OK);
    const Character truth = read_gltf(tube, Coverage::whole, Morphs::read);
    const DeformableSurface truth_surface = surface_of(truth);
    const Bvh bvh = build_bvh(truth_surface, 64);
    ClipBounder bound(truth, truth.animations[0], truth_surface, bvh);
    std::vector<double> supports(6 * bvh.bvs.size());
    const double times[] = {1, 9};
    same_sentence<std::invalid_argument>(
        CINCH_ERROR_ARGUMENT, cinch_clip_bounder_bound(bounder.get(), times, 1, 0.01, supports.data(), bvh.bvs.size()),
        [&] { bound(1, 9, supports); });
}
