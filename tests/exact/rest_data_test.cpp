// SPDX-License-Identifier: GPL-3.0-or-later
// Rest data of surfaces that sit parallel to the axes, lie flat, repeat themselves or shrink to segments and points.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include <CGAL/QP_functions.h>
#include <CGAL/QP_models.h>
#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include "cinch/refit.hpp"
#include "cinch/surface.hpp"
#include "exact/oriented_check.hpp"
#include "exact/verifier.hpp"
#include "tests/support.hpp"

using namespace cinch;
using namespace cinch::exact;

namespace {

using Random = std::mt19937_64;

int whole(Random& random, int low, int high)
{
    return low + static_cast<int>(random() % static_cast<std::uint64_t>(high - low + 1));
}

// One of the 48 maps that exchange and reflect the coordinates.
Vec3 turned(const Vec3& x, int which)
{
    std::array<int, 3> place = {0, 1, 2};
    for (int i = 0; i < which / 8; ++i)
        std::next_permutation(place.begin(), place.end());
    Vec3 y;
    for (int s = 0; s < 3; ++s)
        y[s] = (which >> s & 1 ? -1 : 1) * x[place[static_cast<std::size_t>(s)]];
    return y;
}

void add_box(TriangleMesh& mesh, const Vec3& low, const Vec3& size)
{
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (int i = 0; i < 8; ++i)
        mesh.vertices.push_back(low + Vec3(i & 1 ? size[0] : 0, i & 2 ? size[1] : 0, i & 4 ? size[2] : 0));
    for (const auto& t : {Triangle{0, 2, 1}, Triangle{1, 2, 3}, Triangle{4, 5, 6}, Triangle{5, 7, 6}, Triangle{0, 1, 4},
                          Triangle{1, 5, 4}, Triangle{2, 6, 3}, Triangle{3, 6, 7}, Triangle{0, 4, 2}, Triangle{2, 4, 6},
                          Triangle{1, 3, 5}, Triangle{3, 7, 5}})
        mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
}

// A soup of boxes with whole coordinates: sizes of 0 make them flat, segments or points, and some come twice.
TriangleMesh stack(Random& random)
{
    TriangleMesh mesh;
    const int flat = whole(random, 0, 5),
              turn = whole(random, 0, 47); // of the whole stack: one of three coordinates, or none
    for (int boxes = whole(random, 1, 6); boxes > 0; --boxes) {
        Vec3 low, size;
        for (int s = 0; s < 3; ++s) {
            low[s] = s == flat ? 0 : whole(random, -4, 4);
            size[s] = s == flat ? 0 : whole(random, 0, 3);
        }
        for (int copies = whole(random, 0, 4) == 0 ? 2 : 1; copies > 0; --copies)
            add_box(mesh, low, size);
    }
    const double scale = std::ldexp(1, whole(random, 0, 3) == 0 ? whole(random, -1000, 900) : whole(random, -3, 3));
    const Vec3 shift = whole(random, 0, 3) == 0 ? Vec3(whole(random, -999, 999), 1e6, -1e9) : Vec3::Zero();
    Eigen::Quaterniond tilt = Eigen::Quaterniond::Identity();
    if (whole(random, 0, 3) == 0)
        tilt = Eigen::Quaterniond(1, whole(random, -4, 4), whole(random, -4, 4), whole(random, -4, 4)).normalized();
    for (Vec3& x : mesh.vertices)
        x = (tilt * turned(x, turn) + shift) * scale;
    return mesh;
}

DeformableSurface skinned(TriangleMesh mesh, Random& random)
{
    Influences influences;
    influences.node_count = 5;
    for (std::size_t k = 0; k < mesh.vertices.size(); ++k) {
        const auto first = influences.node.size();
        for (std::uint32_t j = 0; j < 5; ++j)
            if (whole(random, 0, 2) == 0) {
                influences.node.push_back(j);
                influences.weight.push_back(whole(random, 1, 3));
            }
        if (influences.node.size() == first) {
            influences.node.push_back(0);
            influences.weight.push_back(1);
        }
        influences.row.push_back(static_cast<std::uint32_t>(influences.node.size()));
    }
    return {std::move(mesh), to_dyadic(influences)};
}

// x ∈ centre + {Σ β_i axis_i : |β_i| ≤ 1}, exactly, by CGAL's quadratic programming.
bool in_box(const OrientedBox& box, const Vec3& x)
{
    CGAL::Quadratic_program<Exact> program(CGAL::EQUAL, true, Exact(-1), true, Exact(1));
    for (int r = 0; r < 3; ++r) {
        for (int i = 0; i < 3; ++i)
            program.set_a(i, r, Exact(box.axis[i][r]));
        program.set_b(r, Exact(x[r]) - Exact(box.centre[r]));
    }
    return !CGAL::solve_linear_program(program, Exact()).is_infeasible();
}

bool contains(const OrientedBox& box, const Vec3& x)
{
    const DirectedRounding upward;
    return OrientedCheck(box).contains(x);
}

} // namespace

TEST_CASE("rest data of boxes parallel to the axes, flat, exchanged, reflected, repeated and degenerate hold")
{
    Random random(1);
    for (std::size_t n = 0; n < test::share_of(300); ++n) {
        const DeformableSurface surface = skinned(stack(random), random);
        for (const std::size_t leaf : {1u, 3u, 16u}) {
            INFO("soup " << n << ", leaves of " << leaf);
            const Bvh bvh = build_bvh(surface, leaf);
            const Verifier verifier(surface, bvh);
            for (const std::string& fault : verifier.rest_data_faults())
                REQUIRE(fault == "");
            std::vector<AffineMap> maps(5);
            for (AffineMap& map : maps)
                for (auto& row : map.m)
                    for (double& m : row)
                        m = whole(random, -3, 3) * 0.3;
            for (const RestShape shape : {RestShape::aabb, RestShape::obb})
                for (const int k : {6, 26}) {
                    const Method method = shape == RestShape::obb ? Method::limited : Method::best;
                    std::vector<double> supports(bvh.bvs.size() * static_cast<std::size_t>(k));
                    refit(bvh, surface, maps, {method, k, Rounding::proven, Precision::float32, 1, shape}, supports);
                    const FrameVerdict verdict = verifier.check(maps, method, k, supports, shape);
                    REQUIRE(std::count(verdict.failed.begin(), verdict.failed.end(), 0) ==
                            static_cast<std::ptrdiff_t>(verdict.failed.size()));
                }
        }
    }
}

TEST_CASE("a verifier of a tree that lacks rest data is refused")
{
    Random random(2);
    const DeformableSurface surface = skinned(stack(random), random);
    for (const RestDetail detail : {RestDetail::boxes, RestDetail::inner}) {
        const Bvh bvh = build_bvh(surface, 3, detail);
        CHECK_THROWS_AS(Verifier(surface, bvh), std::invalid_argument);
    }
}

TEST_CASE("a point lies in an oriented box if and only if a linear program says so, whatever the axes")
{
    Random random(2);
    std::size_t inside = 0, outside = 0;
    for (std::size_t n = 0; n < test::share_of(4000); ++n) {
        OrientedBox box;
        box.centre = Vec3(whole(random, -2, 2), whole(random, -2, 2), whole(random, -2, 2));
        for (Vec3& axis : box.axis)
            axis = Vec3(whole(random, -2, 2), whole(random, -2, 2), whole(random, -2, 2));
        if (whole(random, 0, 1)) // flat, or less
            box.axis[2] = whole(random, -1, 1) * box.axis[0] + whole(random, -1, 1) * box.axis[1];
        if (whole(random, 0, 3) == 0)
            box.axis[1] = whole(random, -1, 1) * box.axis[0];
        Vec3 x = box.centre;
        for (const Vec3& axis : box.axis)
            x += 0.25 * whole(random, -5, 5) * axis;
        if (whole(random, 0, 3) == 0)
            x[whole(random, 0, 2)] += 0.25;
        INFO("case " << n);
        const bool expected = in_box(box, x);
        (expected ? inside : outside) += 1;
        REQUIRE(contains(box, x) == expected);
        // the same box under other names of its axes
        std::swap(box.axis[0], box.axis[whole(random, 1, 2)]);
        box.axis[1] = -box.axis[1];
        REQUIRE(contains(box, x) == expected);
    }
    CHECK(inside > test::share_of(500));
    CHECK(outside > test::share_of(500));
}

TEST_CASE("an oriented box that is not finite contains everything or nothing")
{
    const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
    const OrientedBox unit{Vec3::Zero(), {Vec3::UnitX(), -Vec3::UnitY(), Vec3::UnitZ()}};
    CHECK(contains(unit, Vec3(1, -1, 1)));
    CHECK_FALSE(contains(unit, Vec3(1, -1, std::nextafter(1, 2))));
    OrientedBox damaged = unit;
    damaged.axis[1][0] = nan;
    CHECK_FALSE(contains(damaged, Vec3::Zero()));
    damaged = unit;
    damaged.centre[2] = inf;
    CHECK_FALSE(contains(damaged, Vec3::Zero()));
    damaged = unit;
    damaged.axis[1][1] = -inf;
    CHECK(contains(damaged, Vec3(0, 5, 0)));
}
