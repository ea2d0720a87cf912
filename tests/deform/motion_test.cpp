// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include "toolkit/deform/motion.hpp"

using namespace cinch;

namespace {

Vec3 moved(const Motion& motion, const Vec3& p) { return apply(linearise(motion, p), p); }

} // namespace

TEST_CASE("a node's map has the motion's value and Jacobian at the node")
{
    const Vec3 p(0.7, -0.4, 0.9);
    for (const char* name : {"strong", "mild", "twist", "bend", "pull", "rotate"}) {
        INFO(name);
        const Motion motion = *named_motion(name);
        const AffineMap map = linearise(motion, p);
        constexpr double h = 1e-5;
        for (int c = 0; c < 3; ++c) {
            const Vec3 step = h * Vec3::Unit(c);
            const Vec3 difference = (moved(motion, p + step) - moved(motion, p - step)) / (2 * h);
            for (int r = 0; r < 3; ++r)
                CHECK(map.m[r][c] == Approx(difference[r]).margin(1e-8));
        }
    }
}

TEST_CASE("the ingredients are the standard ones")
{
    const Vec3 p(0.7, -0.4, 0.9);
    const Vec3 twisted = Eigen::AngleAxisd(1.2 * 0.9, Vec3::UnitZ()) * p;
    CHECK((moved({1, 0, 0, 0}, p) - twisted).norm() < 1e-14);
    const double phi = 0.9 * 0.7, r = 1 / 0.9;
    CHECK((moved({0, 1, 0, 0}, p) - Vec3((r + 0.9) * std::sin(phi), -0.4, (r + 0.9) * std::cos(phi) - r)).norm() <
          1e-14);
    const Vec3 pulled = p + 0.8 * std::exp(-4 * (p - Vec3(1.2, 0, 0)).squaredNorm()) * Vec3(0.6, 0.8, 0.3);
    CHECK((moved({0, 0, 1, 0}, p) - pulled).norm() < 1e-14);
    const Vec3 rotated = Eigen::AngleAxisd(0.7, Vec3(1, 1, 0.5).normalized()) * p;
    CHECK((moved({0, 0, 0, 0.7}, p) - rotated).norm() < 1e-14);
    CHECK_FALSE(named_motion("wiggle"));
}

TEST_CASE("frames grow from rest to the full motion")
{
    const std::vector<Vec3> nodes{{0.1, 0.2, 0.3}, {-1, 0.5, 0}};
    const Motion strong = *named_motion("strong");
    const Clip clip = scripted_clip(strong, nodes, 4);
    REQUIRE(clip.frame_count() == 4);
    for (std::size_t j = 0; j < nodes.size(); ++j)
        for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 4; ++c) {
                CHECK(clip.frame(0)[j].m[r][c] == identity_map.m[r][c]);
                CHECK(clip.frame(3)[j].m[r][c] == linearise(strong, nodes[j]).m[r][c]);
            }
    CHECK(scripted_clip(strong, nodes, 1).frame(0)[0].m[0][0] == linearise(strong, nodes[0]).m[0][0]);
}
