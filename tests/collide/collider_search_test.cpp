// SPDX-License-Identifier: GPL-3.0-or-later
// A search for lost pairs: random scenes whose sizes, places, shapes and transforms are as unlike each other as numbers
// allow.
#include <catch2/catch.hpp>

#include "tests/collide/random_bodies.hpp"
#include "tests/support.hpp"

using namespace cinch;
using namespace cinch::test;

namespace {

/// A power of two: near 1, or where float or double overflow or underflow, or anywhere up to 2^±`most`.
int power(Dice& dice, int most)
{
    static const std::vector<int> edges{-1040, -512, -340, -150, -127, -75, -63, -40, -24, 0,   0,   0,   24,
                                        40,    42,   45,   60,   63,   84,  100, 104, 116, 120, 127, 340, 512};
    switch (dice.below(4)) {
    case 0:
        return static_cast<int>(dice.below(5)) - 2;
    case 1:
        return static_cast<int>(dice.below(static_cast<std::size_t>(2 * most + 1))) - most;
    default:
        return std::clamp(dice.of(edges) + static_cast<int>(dice.below(7)) - 3, -most, most);
    }
}

TriangleMesh shape(Dice& dice)
{
    TriangleMesh mesh;
    switch (dice.below(7)) {
    case 0:
        mesh = brain(40);
        break;
    case 1:
        mesh = ring_sphere(20);
        break;
    case 2:
        mesh = chessboard(3);
        break;
    case 3:
        mesh = box({2, 2, 2}, {2, 2, 2});
        break;
    default:
        mesh = soup(dice, 1 + dice.below(24), std::exp2(-6 * dice.unit()));
        break;
    }
    if (dice.below(3) == 0) { // flat or a needle: each axis by a power of its own
        Vec3 by = Vec3::Ones();
        for (int r = 0; r < 3; ++r)
            if (dice.below(2))
                by[r] = std::ldexp(1.0, power(dice, 60));
        for (Vec3& v : mesh.vertices)
            v = v.cwiseProduct(by / by.maxCoeff());
    }
    return mesh;
}

struct Search {
    Dice dice;
    Bodies bodies;
    std::vector<Eigen::Matrix3d> to_world; ///< of each body's rest surface about `centre`, before its size there
    std::vector<Vec3> centre;

    explicit Search(std::uint64_t seed) : dice(seed)
    {
        const std::size_t count = 2 + dice.below(3);
        for (std::size_t b = 0; b < count; ++b) {
            TriangleMesh mesh = shape(dice);
            const double size = std::ldexp(1.0, power(dice, 300));
            const Vec3 away = dice.below(2)
                                  ? Vec3(Vec3::Zero())
                                  : Vec3(size * std::ldexp(1.0, static_cast<int>(dice.below(40))) * dice.point());
            for (Vec3& v : mesh.vertices)
                v = size * v + away;
            const auto nodes = static_cast<std::uint32_t>(1 + dice.below(9));
            bodies.surface.push_back(nodes == 1 ? rigid(std::move(mesh))
                                                : patchy(dice, std::move(mesh), nodes, 1 + dice.below(4)));
            to_world.push_back(Eigen::Matrix3d::Identity() / size);
            centre.push_back(away);
        }
        const int common = power(dice, 300);
        for (int f = 0; f < 3; ++f)
            add_frame(common);
    }

    void add_frame(int common)
    {
        const double whole = std::ldexp(1.0, common);
        const Vec3 place = dice.below(2)
                               ? Vec3(Vec3::Zero())
                               : Vec3(whole * std::ldexp(1.0, static_cast<int>(dice.below(45))) * dice.point());
        std::vector<Maps> frame;
        for (std::size_t b = 0; b < bodies.surface.size(); ++b) {
            const double size = dice.below(3)
                                    ? whole
                                    : whole * std::ldexp(1.0, dice.below(2) ? -static_cast<int>(dice.below(40))
                                                                            : static_cast<int>(dice.below(20)));
            Eigen::Matrix3d a = size * dice.rotation() * to_world[b];
            if (dice.below(4) == 0)
                a.row(static_cast<int>(dice.below(3))) *= std::ldexp(1.0, -static_cast<int>(dice.below(80)));
            const double strength = dice.below(2) ? 0 : std::exp2(-20 * dice.unit());
            Maps maps;
            for (std::uint32_t j = 0; j < bodies.surface[b].weights.node_count; ++j) {
                Eigen::Matrix3d own = a;
                for (int r = 0; r < 3; ++r)
                    for (int s = 0; s < 3; ++s)
                        own(r, s) *= 1 + strength * dice.symmetric();
                Vec3 t = place - own * centre[b] + 0.5 * size * strength * dice.point() +
                         (dice.below(3) ? Vec3(Vec3::Zero()) : Vec3(0.3 * size * dice.point()));
                if (dice.below(20) == 0) // an entry of a size of its own
                    own(static_cast<int>(dice.below(3)), static_cast<int>(dice.below(3))) *=
                        std::ldexp(1.0, static_cast<int>(dice.below(80)) - 40);
                if (dice.below(40) == 0)
                    t[static_cast<int>(dice.below(3))] += std::ldexp(dice.symmetric(), power(dice, 300));
                maps.push_back(affine(own, t));
            }
            frame.push_back(std::move(maps));
        }
        bodies.add_frame(frame);
        if (dice.below(2) == 0)
            return;
        std::vector<Positions> given; // the same, or about that
        for (std::size_t b = 0; b < bodies.surface.size(); ++b) {
            given.push_back(positions_of(bodies.surface[b], bodies.frame.back()[b]));
            for (Vec3& x : given.back()) {
                if (dice.below(30) == 0)
                    x[static_cast<int>(dice.below(3))] = std::ldexp(dice.symmetric(), power(dice, 1020));
                for (double& c : x) // given positions are finite
                    c = std::isfinite(c) ? c : 0;
            }
        }
        bodies.add_positions(given);
    }
};

LazyOptions any_options(Dice& dice)
{
    LazyOptions o;
    static const std::vector<Methods> methods{Method::best,
                                              Method::best,
                                              Method::limited,
                                              Method::eq12,
                                              Method::local,
                                              Method::support,
                                              Method::linear,
                                              Method::convex,
                                              Method::sphere,
                                              Method::vertices,
                                              Method::local | Method::support};
    o.methods = dice.of(methods);
    o.kdop = std::array{6, 14, 18, 26}[dice.below(4)];
    o.update = std::array{Update::lazy, Update::full, Update::automatic}[dice.below(3)];
    o.precision = dice.below(3) ? Precision::float32 : Precision::float64;
    o.rest_shape = dice.below(3) ? RestShape::aabb : RestShape::obb;
    o.keep_cut = dice.below(3) != 0;
    return o;
}

} // namespace

TEST_CASE("no pair is lost and none is too many in random scenes of all sizes, far places and hostile transforms")
{
    const auto scenes = static_cast<std::uint64_t>(std::max(1.0, 300 * test_share()));
    std::size_t pairs = 0, unknown = 0;
    for (std::uint64_t seed = 0; seed < scenes; ++seed) {
        Search scene(seed);
        const Bodies& bodies = scene.bodies;
        std::vector<std::vector<Positions>> positions(bodies.frame.size());
        for (std::size_t f = 0; f < bodies.frame.size(); ++f)
            for (std::size_t b = 0; b < bodies.surface.size(); ++b)
                positions[f].push_back(positions_of(bodies.surface[b], bodies.frame[f][b]));
        for (int i = 0; i < 2; ++i) {
            const LazyOptions options = any_options(scene.dice);
            Collider collider(options);
            const ClusterSize leaf = scene.dice.below(2) ? ClusterSize{16, 16} : ClusterSize{1, 3};
            for (const DeformableSurface& s : bodies.surface)
                collider.add(build_bvh(s, leaf), s);
            for (std::size_t f = 0; f < bodies.frame.size(); ++f) {
                collider.update(bodies.frame[f]);
                std::vector<bool> left_out(bodies.surface.size(), false);
                for (const std::uint32_t b : collider.unknown()) {
                    left_out[b] = true;
                    ++unknown;
                }
                const Pairs found = sorted(collider.pairs()),
                            truth = brute_force(bodies.surfaces(), positions[f], left_out);
                pairs += truth.size();
                if (found != truth)
                    FAIL("seed " << seed << ", frame " << f << ", " << name_of(options.methods) << ", k "
                                 << options.kdop << ", " << name_of(options.precision) << ", update "
                                 << static_cast<int>(options.update) << ": " << difference(truth, found));
                REQUIRE(collider.any() == !truth.empty());
            }
        }
    }
    CAPTURE(pairs, unknown);
    CHECK(pairs > 10 * scenes);
    CHECK(unknown < scenes);
}
