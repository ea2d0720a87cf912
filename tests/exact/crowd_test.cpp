// SPDX-License-Identifier: GPL-3.0-or-later
// Boxes of crowds: proven, as tight as the formula that proves nothing, the same everywhere.
#include <cmath>
#include <limits>
#include <random>

#include <catch2/catch.hpp>
#include <tbb/global_control.h>

#include "cinch/refit.hpp"
#include "exact/verifier.hpp"
#include "tests/support.hpp"
#include "toolkit/deform/kernel/targets.hpp"

using namespace cinch;
using namespace cinch::exact;

namespace {

// A crowd of one body per frame.
struct Bodies {
    test::Example e;
    Bvh bvh;
    std::vector<AffineMap> maps;

    // `scale`: of the rest shape; `stretch` and `far`: of the maps.
    Bodies(std::size_t vertices, std::size_t nodes, double scale, double stretch, double far)
        : e(test::example(vertices, nodes))
    {
        for (Vec3& x : e.surface.mesh.vertices)
            x *= scale;
        bvh = build_bvh(e.surface, 3);
        double sign = 1;
        for (auto& frame : e.frames)
            for (AffineMap& map : frame) {
                sign = -sign;
                for (int r = 0; r < 3; ++r) {
                    for (int c = 0; c < 3; ++c)
                        map.m[r][c] *= stretch;
                    map.m[r][3] = (map.m[r][3] * scale + far * (r + 1)) * stretch + sign * 1e-3 * scale * stretch;
                }
                maps.push_back(map);
            }
    }
    std::size_t nodes() const { return e.surface.weights.node_count; }

    std::vector<Aabb> boxes(const CrowdOptions& options) const
    {
        const CrowdRefitter refit(bvh, e.surface, options);
        std::vector<Aabb> out(refit.bvs().size() * e.frames.size());
        refit(maps, out);
        return out;
    }

    // Bounds that either statement finds fault with.
    std::size_t violated(const CrowdOptions& options) const
    {
        const CrowdRefitter refit(bvh, e.surface, options);
        const std::vector<Aabb> all = boxes(options);
        const Verifier verifier(e.surface, bvh);
        std::size_t count = 0;
        for (std::size_t f = 0; f < e.frames.size(); ++f) {
            std::vector<double> supports(6 * bvh.bvs.size(), HUGE_VAL);
            for (std::size_t b = 0; b < refit.bvs().size(); ++b)
                for (int c = 0; c < 3; ++c) {
                    const Aabb& box = all[f * refit.bvs().size() + b];
                    double* s = &supports[6 * refit.bvs()[b] + 2 * static_cast<std::size_t>(c)];
                    s[0] = box.upper[c];
                    s[1] = -box.lower[c];
                }
            const FrameVerdict verdict = verifier.check(e.frames[f], Method::vertices, 6, supports);
            count += static_cast<std::size_t>(
                std::count_if(verdict.failed.begin(), verdict.failed.end(), [](auto mask) { return mask != 0; }));
        }
        return count;
    }
};

} // namespace

TEST_CASE("boxes of crowds hold every vertex, at all scales and places, and without room for rounding they do not")
{
    std::size_t unproven = 0;
    for (const double scale : {1.0, 1e-9, 1e-35, 1e-300, 1e9, 1e30, 1e200})
        for (const double stretch : {1.0, 1e-6, 1e8, 1e100})
            for (const double far : {0.0, 1e7, -1e15})
                for (const int level : {0, 4, 100}) {
                    CAPTURE(scale, stretch, far, level);
                    if (!(std::abs(far) * scale * stretch < 1e290))
                        continue; // a transform that overflows
                    const Bodies bodies(90, 11, scale, stretch, far * scale);
                    CHECK(bodies.violated({level, Rounding::proven}) == 0);
                    unproven += bodies.violated({level, Rounding::plain});
                }
    CHECK(unproven > 1000);
    for (const std::size_t nodes : {1u, 7u, 8u, 9u, 24u, 40u}) {
        CAPTURE(nodes);
        const Bodies bodies(300, nodes, 1, 1, 0.5);
        for (const int level : {0, 1, 2, 5, 9})
            CHECK(bodies.violated({level, Rounding::proven}) == 0);
    }
}

TEST_CASE("the room for rounding is some millionths of what boxes are about")
{
    const Bodies bodies(400, 22, 1, 1, 0);
    for (const int level : {0, 6}) {
        const auto proven = bodies.boxes({level, Rounding::proven}), plain = bodies.boxes({level, Rounding::plain});
        REQUIRE(proven.size() == plain.size());
        for (std::size_t b = 0; b < proven.size(); ++b) {
            CHECK((proven[b].upper.array() >= plain[b].upper.array()).all());
            CHECK((proven[b].lower.array() <= plain[b].lower.array()).all());
            CHECK((proven[b].upper - plain[b].upper).maxCoeff() < 2e-5);
            CHECK((plain[b].lower - proven[b].lower).maxCoeff() < 2e-5);
        }
    }
}

TEST_CASE("boxes of crowds: the levels of the tree, leaves above included, cover every triangle once")
{
    const Bodies bodies(150, 9, 1, 1, 0);
    for (const int level : {0, 1, 3, 6, 50}) {
        const CrowdRefitter refit(bodies.bvh, bodies.e.surface, {level, Rounding::proven});
        std::size_t triangles = 0;
        for (const std::uint32_t bv : refit.bvs())
            triangles += bodies.bvh.bvs[bv].triangle_count;
        CHECK(triangles == bodies.e.surface.mesh.triangles.size());
        CHECK(refit.bytes() > 0);
    }
}

TEST_CASE("boxes of crowds: the same bits for any number of threads and on every target of this machine")
{
    Bodies bodies(200, 21, 1, 1, 3);
    const auto frames = bodies.e.frames;
    for (int n = 0; n < 20; ++n) // more bodies than a thread takes at once
        bodies.e.frames.insert(bodies.e.frames.end(), frames.begin(), frames.end());
    bodies.maps.clear();
    for (const auto& frame : bodies.e.frames)
        bodies.maps.insert(bodies.maps.end(), frame.begin(), frame.end());
    const auto expected = bodies.boxes({5, Rounding::proven});
    for (const std::size_t threads : {1u, 2u, 7u}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        CHECK((bodies.boxes({5, Rounding::proven}) == expected));
    }
    for (const std::string& target : kernel_targets()) {
        REQUIRE(force_kernel_target(target));
        INFO(target);
        CHECK((bodies.boxes({5, Rounding::proven}) == expected));
    }
    force_kernel_target("");
}

TEST_CASE("boxes of crowds: a map that is not finite makes infinite what it reaches, of its body alone")
{
    const Bodies good(200, 21, 1, 1, 0);
    const auto expected = good.boxes({6, Rounding::proven});
    const CrowdRefitter refit(good.bvh, good.e.surface, {6, Rounding::proven});
    for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL, 1e308})
        for (int entry = 0; entry < 12; ++entry) {
            Bodies bodies = good;
            bodies.maps[bodies.nodes() + 5].m[entry / 4][entry % 4] = bad;
            const auto boxes = bodies.boxes({6, Rounding::proven});
            std::size_t infinite_boxes = 0;
            for (std::size_t i = 0; i < boxes.size(); ++i) {
                const std::size_t body = i / refit.bvs().size();
                const RestBv rest = good.bvh.rest(refit.bvs()[i % refit.bvs().size()]);
                const bool reached = std::find(rest.node.begin(), rest.node.end(), 5u) != rest.node.end();
                if (body != 1) {
                    CHECK(boxes[i] == expected[i]);
                } else if (reached && std::abs(bad) != 1e308) {
                    CHECK(boxes[i].upper[entry / 4] == HUGE_VAL);
                    CHECK(boxes[i].lower[entry / 4] == -HUGE_VAL);
                    ++infinite_boxes;
                } else if (!reached) { // in doubles
                    CHECK((boxes[i].upper - expected[i].upper).cwiseAbs().maxCoeff() < 1e-5);
                    CHECK((boxes[i].lower - expected[i].lower).cwiseAbs().maxCoeff() < 1e-5);
                }
            }
            CHECK((infinite_boxes > 0 || std::abs(bad) == 1e308));
        }
    std::vector<Aabb> few(3);
    CHECK_THROWS_AS(refit(good.maps, few), std::invalid_argument);
    CHECK_THROWS_AS(refit(std::span(good.maps).first(5), few), std::invalid_argument);
    CHECK_THROWS_AS(CrowdRefitter(good.bvh, good.e.surface, {-1, Rounding::proven}), std::invalid_argument);
}
