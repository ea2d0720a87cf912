// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

#include "cinch/deform.hpp"
#include "tests/support.hpp"
#include "toolkit/deform/kernel/targets.hpp"

using namespace cinch;

static_assert(std::is_constructible_v<SurfaceEvaluator<double>, DeformableSurface&> &&
              std::is_constructible_v<SurfaceEvaluator<float>, const DeformableSurface&>);
static_assert(!std::is_constructible_v<SurfaceEvaluator<double>, DeformableSurface> &&
                  !std::is_constructible_v<SurfaceEvaluator<float>, const DeformableSurface>,
              "a temporary would be gone at the first call");

TEST_CASE("SIMD evaluation in double has the bits of the scalar one, on every target")
{
    for (const std::size_t vertices : {5u, 12u, 301u}) {
        const test::Example e = test::example(vertices, 17);
        const SurfaceEvaluator<double> evaluate(e.surface);
        for (const auto& frame : e.frames)
            for (const std::string& target : kernel_targets()) {
                INFO(target);
                REQUIRE(force_kernel_target(target));
                std::vector<Vec3> simd(vertices, Vec3::Constant(7)), scalar = simd;
                evaluate(frame, simd);
                force_kernel_target("");
                cinch::evaluate(e.surface.mesh.vertices, e.surface.weights, frame, scalar);
                CHECK(std::memcmp(simd.data(), scalar.data(), vertices * sizeof(Vec3)) == 0);
            }
    }
}

TEST_CASE("SIMD evaluation in float is near, also far from the origin")
{
    test::Example e = test::example(301, 17);
    for (const double offset : {0.0, 1e6})
        for (auto frame : e.frames) {
            for (AffineMap& m : frame)
                for (auto& row : m.m)
                    row[3] += offset;
            const SurfaceEvaluator<float> evaluate(e.surface);
            std::vector<Vec3> simd(301), scalar(301);
            evaluate(frame, simd);
            cinch::evaluate(e.surface.mesh.vertices, e.surface.weights, frame, scalar);
            for (std::size_t k = 0; k < simd.size(); ++k)
                CHECK((simd[k] - scalar[k]).norm() < 1e-5);
        }
}

TEST_CASE("a map that is not finite spoils what it moves, and nothing else")
{
    test::Example e = test::example(301, 17);
    auto frame = e.frames[2];
    std::vector<Vec3> before(301), after(301);
    cinch::evaluate(e.surface.mesh.vertices, e.surface.weights, frame, before);
    frame[3].m[1][2] = std::numeric_limits<double>::infinity();
    auto check = [&](const auto& evaluate, double off) {
        evaluate(frame, after);
        std::size_t moved = 0;
        for (std::size_t k = 0; k < after.size(); ++k) {
            const auto row = e.surface.weights.of(k).node;
            const bool touched = std::find(row.begin(), row.end(), 3u) != row.end();
            moved += touched;
            if (touched)
                CHECK_FALSE(after[k].allFinite());
            else
                CHECK((after[k] - before[k]).norm() <= off);
        }
        CHECK(moved > 0);
        CHECK(moved < 301);
    };
    check(SurfaceEvaluator<double>(e.surface), 0);
    check(SurfaceEvaluator<float>(e.surface), 1e-5);
}
