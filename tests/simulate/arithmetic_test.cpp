// SPDX-License-Identifier: GPL-3.0-or-later
// A changed floating-point environment is refused wherever numbers are made that bounds rest on.
#include <cfenv>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "cinch/collider.hpp"
#include "cinch/deform.hpp"
#include "cinch/refit.hpp"
#include "tests/simulate/bodies.hpp"
#include "tests/support.hpp"
#include "toolkit/deform/motion.hpp"
#include "toolkit/deform/sample_nodes.hpp"
#include "toolkit/surface/character.hpp"
#include "toolkit/surface/read_mesh.hpp"
#include "toolkit/surface/shapes.hpp"
#include "toolkit/surface/skin.hpp"
#include "toolkit/surface/triangle_mesh.hpp"

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

using namespace cinch;

namespace {

struct Made {
    std::string what;
    std::function<void()> make;
};

// What is prepared outside, in the default environment, and everything that may be made from it.
struct World {
    test::Example e = test::example(60, 6);
    SimulationNodes nodes = sample_nodes(e.surface.mesh, 5, 0);
    Bvh bvh = build_bvh(e.surface, 4);
    std::vector<double> supports = std::vector<double>(bvh.bvs.size() * 6);
    std::vector<Vec3> positions = std::vector<Vec3>(e.surface.mesh.vertices.size());
    Refitter refitter{bvh, e.surface, {}};
    SurfaceEvaluator<double> evaluator{e.surface};
    Collider collider{LazyOptions{}};
    Clip clip = scripted_clip(*named_motion("mild"), nodes.position, 3);

    std::vector<Made> made()
    {
        const std::string triangle = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
        return {
            {"parse_obj", [] { parse_obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "a.obj"); }},
            {"parse_off", [=] { parse_off(triangle, "a.off"); }},
            {"parse_ply",
             [] {
                 parse_ply("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty "
                           "float z\nend_header\n0 0 0\n",
                           "a.ply");
             }},
            {"parse_stl",
             [] {
                 parse_stl("solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
                           "0\nendloop\nendfacet\nendsolid a\n",
                           "a.stl");
             }},
            {"parse_gltf", [] { parse_gltf("{}", "a.gltf"); }},
            {"parse_weights_text", [] { parse_weights_text("1 1\n1 0 1\n", "a", 1); }},
            {"parse_clips_text", [] { parse_clips_text("1\na 1 1\n0 1 0 0 0 0 1 0 0 0 0 1 0\n", "a", 1); }},
            {"named_shape", [] { named_shape("brain-3500"); }},
            {"centre_and_scale",
             [this] {
                 TriangleMesh mesh = e.surface.mesh;
                 centre_and_scale(mesh, 1);
             }},
            {"to_dyadic",
             [] {
                 to_dyadic({1, {0, 1}, {0}, {1}});
             }},
            {"sample_nodes", [this] { sample_nodes(e.surface.mesh, 5, 0); }},
            {"kernel_weights", [this] { kernel_weights(e.surface.mesh, nodes, 2); }},
            {"scripted_clip", [this] { scripted_clip(*named_motion("mild"), nodes.position, 3); }},
            {"a clip's frame", [this] { clip.frame(1); }},
            {"evaluate", [this] { evaluate(e.surface.mesh.vertices, e.surface.weights, e.frames[1], positions); }},
            {"SurfaceEvaluator", [this] { evaluator(e.frames[1], positions); }},
            {"build_bvh", [this] { build_bvh(e.surface, 4); }},
            {"build_bvh of clusters",
             [this] {
                 build_bvh(e.surface, ClusterSize{16, 16});
             }},
            {"Refitter", [this] { Refitter(bvh, e.surface, {}); }},
            {"a refit", [this] { refitter(e.frames[1], supports); }},
            {"Collider", [this] { Collider(LazyOptions{}).add(bvh, e.surface); }},
            {"an update",
             [this] {
                 const BodyFrame frame{e.frames[1]};
                 collider.update(std::span(&frame, 1));
             }},
            {"discretise", [this] { discretise(nodes.position, std::vector<double>(nodes.position.size(), 1.0), {}); }},
        };
    }
};

} // namespace

TEST_CASE("a changed floating-point environment is refused by everything that makes numbers, and by nothing afterwards")
{
    World world;
    world.collider.add(world.bvh, world.e.surface);
    std::vector<std::pair<std::string, std::function<void()>>> changes = {
        {"rounding upward", [] { std::fesetround(FE_UPWARD); }}};
#if defined(__SSE2__)
    const unsigned int saved = _mm_getcsr();
    changes.emplace_back("results flushed to zero", [=] { _mm_setcsr(saved | 0x8000u); });
    changes.emplace_back("subnormal operands taken for zero", [=] { _mm_setcsr(saved | 0x40u); });
#endif
    for (const Made& made : world.made()) {
        for (const auto& [name, change] : changes) {
            bool refused = false;
            change();
            try {
                made.make();
            } catch (const InputError&) { // an InputError is a std::runtime_error too
            } catch (const std::runtime_error&) {
                refused = true;
            }
            std::fesetround(FE_TONEAREST);
#if defined(__SSE2__)
            _mm_setcsr(saved);
#endif
            INFO(made.what << ", " << name);
            CHECK(refused);
        }
        INFO(made.what);
        if (made.what != "parse_gltf") // which has nothing to read
            CHECK_NOTHROW(made.make());
    }
}
