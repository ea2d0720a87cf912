// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies, places and motions that nobody would choose.
#include <limits>

#include <catch2/catch.hpp>

#include "tests/collide/random_bodies.hpp"
#include "tests/support.hpp"
#include "toolkit/collide/collider_parts.hpp"

using namespace cinch;
using namespace cinch::test;

namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();

// The options that differ most in what they compute.
std::vector<LazyOptions> some_options()
{
    std::vector<LazyOptions> all(6);
    all[1].update = Update::full;
    all[2].update = Update::lazy;
    all[2].kdop = 26;
    all[3].keep_cut = false;
    all[3].kdop = 14;
    all[4].precision = Precision::float64;
    all[4].update = Update::lazy;
    all[5].methods = Method::eq12;
    all[5].rest_shape = RestShape::obb;
    all[5].kdop = 18;
    return all;
}

// `unknown`: bodies, per frame.
void check_all(const Bodies& bodies, const std::vector<std::vector<std::uint32_t>>& unknown = {},
               ClusterSize leaf = {16, 16})
{
    std::vector<Pairs> truth;
    for (std::size_t f = 0; f < bodies.frame.size(); ++f) {
        std::vector<Positions> positions;
        std::vector<bool> left_out(bodies.surface.size(), false);
        for (std::size_t b = 0; b < bodies.surface.size(); ++b)
            positions.push_back(positions_of(bodies.surface[b], bodies.frame[f][b]));
        if (!unknown.empty())
            for (const std::uint32_t b : unknown[f])
                left_out[b] = true;
        truth.push_back(brute_force(bodies.surfaces(), positions, left_out));
    }
    const std::vector<Bvh> trees = bodies.trees(leaf);
    std::vector<Pairs> first;
    for (const LazyOptions& options : some_options()) {
        Collider collider(options);
        for (std::size_t b = 0; b < trees.size(); ++b)
            collider.add(trees[b], bodies.surface[b]);
        for (std::size_t f = 0; f < bodies.frame.size(); ++f) {
            collider.update(bodies.frame[f]);
            const Pairs found = collider.pairs();
            INFO("k " << options.kdop << ", update " << static_cast<int>(options.update) << ", frame " << f << ": "
                      << difference(truth[f], sorted(found)));
            REQUIRE((sorted(found) == truth[f]));
            REQUIRE((collider.unknown() == (unknown.empty() ? std::vector<std::uint32_t>{} : unknown[f])));
            if (first.size() == f)
                first.push_back(found);
            REQUIRE((found == first[f]));
        }
    }
}

std::size_t pairs_of(const Bodies& bodies)
{
    std::size_t count = 0;
    for (const Pairs& some : bodies.truth())
        count += some.size();
    return count;
}

Bodies two(TriangleMesh a, TriangleMesh b, std::size_t nodes)
{
    Bodies out;
    out.surface.push_back(soft(std::move(a), nodes));
    out.surface.push_back(soft(std::move(b), nodes));
    return out;
}

} // namespace

TEST_CASE("transforms that are not finite: the body is reported, no pair of the others is lost, and all is well in the "
          "next frame")
{
    Dice dice(21);
    Bodies bodies;
    for (int b = 0; b < 4; ++b)
        bodies.surface.push_back(soft(brain(150), 12));
    bodies.surface[3].weights.node_count = 13; // a simulation node without influence
    std::vector<Maps> good;
    for (int b = 0; b < 4; ++b)
        good.push_back(around(dice, bodies.surface[static_cast<std::size_t>(b)].weights.node_count, dice.rotation(),
                              0.4 * dice.point(), 0.05));
    std::vector<std::vector<std::uint32_t>> unknown;
    bodies.add_frame(good);
    unknown.push_back({});
    for (const double bad : {not_a_number, inf, -inf, 1e308, -1.7e308})
        for (const std::size_t row : {0u, 2u})
            for (const std::size_t column : {0u, 3u}) {
                std::vector<Maps> some = good;
                some[1][5].m[row][column] = bad;
                some[3][12].m[row][column] = bad;
                bodies.add_frame(some);
                unknown.push_back({1});
                if (column == 3)
                    continue; // bad frames in a row too
                for (Maps& maps : some)
                    maps = around(dice, maps.size(), dice.rotation(), 0.4 * dice.point(), 0.05);
                bodies.add_frame(some);
                unknown.push_back({});
            }
    std::vector<Maps> all_bad = good;
    for (Maps& maps : all_bad)
        maps[3].m[1][1] = not_a_number;
    bodies.add_frame(all_bad);
    unknown.push_back({0, 1, 2, 3});
    bodies.add_frame(good);
    unknown.push_back({});
    check_all(bodies, unknown);

    Bodies given;
    given.surface = bodies.surface;
    std::vector<Positions> places;
    for (std::size_t b = 0; b < 4; ++b)
        places.push_back(positions_of(bodies.surface[b], bodies.frame[0][b]));
    given.add_positions(places);
    for (const double bad : {not_a_number, inf, -inf}) {
        std::vector<Positions> some = places;
        some[2][77][1] = bad;
        given.add_positions(some);
        given.add_positions(places);
    }
    check_all(given, {{}, {2}, {}, {2}, {}, {2}, {}});
}

TEST_CASE("places far from the origin, each body's own or the same, at rest and in motion")
{
    Dice dice(22);
    for (const double far : {1e3, 1e6, 1e9, 1e14, 1e20, 1e38, 3e38, 1e41}) {
        TriangleMesh there = brain(80);
        const Vec3 away = (far < 1e10 ? far : 0) * dice.point();
        for (Vec3& v : there.vertices)
            v += away;
        Bodies bodies = two(brain(90), there, 11);
        const Eigen::Matrix3d r = dice.rotation();
        const Vec3 place = far * dice.point();
        for (const Vec3& target : {Vec3::Zero().eval(), place, Vec3(place[0], 0, 0)})
            for (int f = 0; f < 2; ++f)
                bodies.add_frame({around(dice, 11, r, target + 0.2 * dice.point(), far < 1e7 ? 0.03 : 0),
                                  around(dice, 11, r, target - r * away + 0.2 * dice.point(), 0)});
        // One body's origin moves on its own.
        bodies.add_frame({around(dice, 11, r, place, 0), Maps(11, moved_by(-away))});
        INFO("far " << far);
        CHECK(pairs_of(bodies) > 0);
        check_all(bodies);
        Bodies given;
        given.surface = bodies.surface;
        for (const auto& frame : bodies.frame)
            given.add_positions({positions_of(bodies.surface[0], frame[0]), positions_of(bodies.surface[1], frame[1])});
        check_all(given);
    }
}

TEST_CASE("scales from subnormal to where floats and doubles overflow")
{
    Dice dice(23);
    for (const double scale : {1e-320, 1e-300, 1e-160, 1e-60, 1e-45, 1e-38, 1e-20, 1e-6, 1e6, 1e20, 1e30, 1e37, 2e38,
                               1e39, 1e60, 1e150, 1e290}) {
        INFO("scale " << scale);
        TriangleMesh a = brain(60), b = fish(60);
        for (TriangleMesh* mesh : {&a, &b})
            for (Vec3& v : mesh->vertices)
                v *= scale;
        Bodies at_rest = two(a, b, 6), by_motion = two(brain(60), fish(60), 6);
        for (int f = 0; f < 3; ++f) {
            const Eigen::Matrix3d r = dice.rotation();
            at_rest.add_frame({around(dice, at_rest.surface[0].weights.node_count, r, 0.3 * scale * dice.point(),
                                      0), // tiny ones have one
                               Maps(at_rest.surface[1].weights.node_count, identity_map)});
            by_motion.add_frame({around(dice, 6, scale * r, 0.3 * scale * dice.point(), 0),
                                 around(dice, 6, scale * dice.rotation(), Vec3::Zero(), 0)});
        }
        Bodies given;
        given.surface = by_motion.surface;
        for (const auto& frame : by_motion.frame)
            given.add_positions({positions_of(given.surface[0], frame[0]), positions_of(given.surface[1], frame[1])});
        for (const Bodies* bodies : {&at_rest, &by_motion, &given}) {
            CHECK(pairs_of(*bodies) > 0);
            check_all(*bodies);
        }
    }
}

TEST_CASE("one vertex far off the others: what overflows in a part of a body does not hide the rest")
{
    constexpr double places_far[] = {1e39, 1e10, 1e30, 1e38, 3e38, 1e100, 1e300};
    for (const double far : share_of(places_far)) {
        Bodies bodies;
        for (int b = 0; b < 2; ++b)
            bodies.surface.push_back(soft(ring_sphere(200), 8));
        std::vector<Positions> places{bodies.surface[0].mesh.vertices, bodies.surface[1].mesh.vertices};
        for (Vec3& x : places[1])
            x += Vec3(0.9, 0.1, 0.2);
        bodies.add_positions(places);
        for (const std::size_t vertex : {0u, 1u, 60u, 100u, 150u, 199u})
            for (const double sign : {1.0, -1.0})
                for (const int axis : {0, 1, 2}) {
                    std::vector<Positions> some = places;
                    some[vertex % 2][vertex][axis] = sign * far;
                    bodies.add_positions(some);
                }
        INFO("far " << far);
        check_all(bodies);
        check_all(bodies, {}, {1, 3});
    }
}

TEST_CASE("mirrored, singular and huge-against-small transforms")
{
    Dice dice(24);
    Bodies bodies = two(brain(150), fish(150), 10);
    const std::vector<Vec3> diagonals{{-1, 1, 1},     {-1, -1, -1},     {1, 1, 0},
                                      {1, 0, 0},      {0, 0, 0},        {1e-9, 1, 1},
                                      {1e5, 1, 1e-5}, {1e30, 1e-30, 1}, {1e-40, 1e-40, 1e-40}};
    for (const Vec3& d : diagonals) {
        const Eigen::Matrix3d a = d.asDiagonal();
        for (const Eigen::Matrix3d& m : {a, Eigen::Matrix3d(dice.rotation() * a)}) {
            bodies.add_frame({around(dice, 10, m, 0.1 * dice.point(), 0), Maps(10, identity_map)});
            Maps mixed(10, identity_map);
            for (std::size_t j = 0; j < 10; j += 2)
                mixed[j] = affine(m, 0.1 * dice.point());
            bodies.add_frame({mixed, around(dice, 10, m, Vec3::Zero(), 0.01)});
        }
    }
    CHECK(pairs_of(bodies) > 1000);
    check_all(bodies);
}

TEST_CASE("faces that touch exactly: coplanar, by an edge, by a corner, and bodies in the same place")
{
    Bodies bodies;
    bodies.surface.push_back(rigid(box({2, 2, 2}, {4, 4, 4})));
    bodies.surface.push_back(rigid(box({2, 2, 2}, {3, 3, 3})));
    bodies.surface.push_back(rigid(chessboard(6)));
    bodies.surface.push_back(rigid(box({2, 2, 2}, {4, 4, 4})));
    const Vec3 above(0, 0, 100);
    for (const Vec3& t : {Vec3(2, 0, 0), Vec3(2, 1, 0), Vec3(2, 2, 0), Vec3(2, 2, 2), Vec3(0, 0, 0), Vec3(1, 0, 0),
                          Vec3(2 + 0x1p-51, 0, 0), Vec3(2 - 0x1p-52, 0, 0)})
        for (const Vec3& whole :
             {Vec3(0, 0, 0), Vec3(1 << 20, -(1 << 21), 3)}) // exact far away too, but for the last two
            bodies.add_frame({Maps(1, moved_by(whole)), Maps(1, moved_by(whole + t)),
                              Maps(1, moved_by(whole + Vec3(-3, -3, 1))),
                              Maps(1, moved_by(whole + (t[0] > 1 ? above : t)))});
    CHECK(pairs_of(bodies) > 5000);
    check_all(bodies);
    check_all(bodies, {}, {1, 3});

    Dice dice(25);
    Bodies same;
    for (int b = 0; b < 3; ++b)
        same.surface.push_back(soft(brain(120), 10));
    for (int f = 0; f < 3; ++f)
        same.add_frame(std::vector<Maps>(3, around(dice, 10, dice.rotation(), 1e3 * dice.point(), 0.1 * f)));
    CHECK(pairs_of(same) >= 3 * 3 * same.surface[0].mesh.triangles.size());
    check_all(same);
}

TEST_CASE("small bodies that touch a large one from outside: their origins are as far apart as they are large")
{
    Dice dice(28);
    Bodies bodies;
    bodies.surface.push_back(rigid(box({4096, 4096, 4096}, {9, 9, 9})));
    for (int b = 0; b < 12; ++b)
        bodies.surface.push_back(b % 2 ? rigid(box({2, 2, 2}, {2, 2, 2})) : soft(brain(60), 6));
    for (int f = 0; f < 6; ++f) {
        const Vec3 whole = f < 3 ? Vec3(0, 0, 0) : Vec3(1 << 24, -(1 << 22), 1 << 20);
        std::vector<Maps> maps{Maps(1, moved_by(whole))};
        for (std::size_t b = 1; b < bodies.surface.size(); ++b) {
            Vec3 at = 2000 * dice.point(); // beside a face, touching it
            at[static_cast<int>(b % 3)] = (b % 6 < 3 ? 1 : -1) * 2049;
            for (double& x : at)
                x = std::round(x);
            maps.push_back(bodies.surface[b].weights.node_count == 1
                               ? Maps(1, moved_by(whole + at))
                               : around(dice, 6, dice.rotation(), whole + at, 0.01));
        }
        bodies.add_frame(maps);
    }
    CHECK(pairs_of(bodies) > 100);
    check_all(bodies);
    check_all(bodies, {}, {1, 3});
    const std::vector<Bvh> trees = bodies.trees({16, 16});
    Collider collider{LazyOptions{}};
    for (std::size_t b = 0; b < trees.size(); ++b)
        collider.add(trees[b], bodies.surface[b]);
    collider.update(bodies.frame[0]);
    CHECK((collider.parts().trees()[0].origin() - collider.parts().trees()[1].origin()).norm() > 1000);
}

TEST_CASE("nothing, one triangle, points and segments, all centroids alike, soups")
{
    Dice dice(26);
    const TriangleMesh unused{{{0, 0, 0}, {1, 1, 1}}, {}}, one{{{-1, -1, 0}, {1, -1, 0.1}, {0, 1, 0}}, {{0, 1, 2}}},
        point{{{0, 0, 0.03}}, {{0, 0, 0}}};
    const TriangleMesh points = soup(dice, 300, 0.3);
    TriangleMesh alike, shells;
    for (std::uint32_t i = 0; i < 200; ++i) { // the same centroid for all, of one shape or another
        alike.vertices.insert(alike.vertices.end(), {{1, 0, 0}, {0, 1, 0}, {-1, -1, 0}});
        alike.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
        const Vec3 p = dice.point(), q = dice.point();
        shells.vertices.insert(shells.vertices.end(), {p, q, -p - q});
        shells.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    Bodies bodies;
    for (const TriangleMesh* mesh :
         std::initializer_list<const TriangleMesh*>{&unused, &one, &point, &alike, &points, &shells})
        bodies.surface.push_back(patchy(dice, *mesh, 4, 3));
    bodies.surface.push_back({TriangleMesh{}, {}});
    bodies.surface.push_back(rigid({{{5, 5, 5}, {0, 0, 0.01}, {0, 0.1, 0.01}, {0.1, 0, 0.01}},
                                    {{1, 2, 3}, {1, 2, 3}, {3, 2, 1}, {1, 1, 2}}})); // twice the same
    for (const double strength : {0.0, 0.0, 0.1, 1.0, 0.0}) {
        std::vector<Maps> maps;
        for (const DeformableSurface& s : bodies.surface)
            maps.push_back(
                around(dice, s.weights.node_count, Eigen::Matrix3d::Identity(), strength * dice.point(), strength));
        bodies.add_frame(maps);
    }
    CHECK(pairs_of(bodies) > 1000);
    const ClusterSize leaves[] = {{4, 5}, {16, 16}, {8, 8}, {1, 3}};
    for (const ClusterSize leaf : share_of(leaves))
        check_all(bodies, {}, leaf);
}

TEST_CASE("forty bodies in a crowd")
{
    Dice dice(27);
    Bodies bodies;
    for (int b = 0; b < 40; ++b)
        bodies.surface.push_back(soft(b % 2 ? brain(70) : fish(60), 6));
    for (int f = 0; f < 4; ++f) {
        std::vector<Maps> maps;
        for (std::size_t b = 0; b < 40; ++b)
            maps.push_back(around(dice, 6, dice.rotation(),
                                  (f == 2 ? 8 : 2) * dice.point() + (b % 5 ? 0 : 1e5) * Vec3(1, 1, 1), 0.05));
        bodies.add_frame(maps);
    }
    CHECK(pairs_of(bodies) > 2000);
    check_all(bodies);
}
