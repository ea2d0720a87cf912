// SPDX-License-Identifier: GPL-3.0-or-later
// Whole queries at every power of two that a double has, where floats overflow and underflow long before.
#include <limits>

#include <catch2/catch.hpp>

#include "tests/collide/pair_cases.hpp"
#include "tests/collide/random_bodies.hpp"
#include "tests/support.hpp"

using namespace cinch;
using namespace cinch::test;

namespace {

using Powers = std::array<int, 3>; ///< of two, one per axis

TriangleMesh mesh_of(const std::vector<TrianglePoints>& triangles)
{
    TriangleMesh mesh;
    for (const TrianglePoints& t : triangles) {
        const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
        mesh.vertices.insert(mesh.vertices.end(), t.begin(), t.end());
        mesh.triangles.push_back({first, first + 1, first + 2});
    }
    return mesh;
}

Positions scaled(Positions positions, const Powers& powers)
{
    for (Vec3& x : positions)
        for (std::size_t r = 0; r < 3; ++r)
            x[static_cast<int>(r)] = std::ldexp(x[static_cast<int>(r)], powers[r]);
    return positions;
}
TriangleMesh scaled(TriangleMesh mesh, const Powers& powers)
{
    mesh.vertices = scaled(std::move(mesh.vertices), powers);
    return mesh;
}
bool is_exact(const Positions& positions, const Powers& powers)
{
    return scaled(scaled(positions, powers), {-powers[0], -powers[1], -powers[2]}) == positions;
}

/// Two bodies of a few triangles each, and which of them intersect, by the clipper.
struct Scene {
    std::vector<DeformableSurface> surface;
    Pairs truth;

    template <class Integer>
    Scene(const std::vector<TrianglePoints>& a, const std::vector<TrianglePoints>& b, Integer&& exact)
    {
        surface.push_back(rigid(mesh_of(a)));
        surface.push_back(rigid(mesh_of(b)));
        for (std::uint32_t i = 0; i < a.size(); ++i)
            for (std::uint32_t j = 0; j < b.size(); ++j)
                if (exact(i, j))
                    truth.push_back({0, i, 1, j});
    }
};

/// Whole numbers of at most 10: random triangles, and those that are points, needles and in one plane.
Scene whole_numbers(std::uint64_t seed)
{
    std::mt19937_64 random(seed);
    std::array<std::vector<SmallTriangle>, 2> small;
    std::array<std::vector<TrianglePoints>, 2> points;
    for (std::size_t b = 0; b < 2; ++b)
        for (int t = 0; t < 14; ++t) {
            small[b].push_back(
                collapse(random_triangle(random, t % 7 == 2 || t % 7 == 3 ? 5 : 10), std::min(6, 1 + t % 7)));
            for (auto& v : small[b].back())
                v[0] = std::clamp(v[0], -10, 10);
            points[b].push_back(doubles(small[b].back()));
        }
    return {points[0], points[1], [&](std::size_t i, std::size_t j) {
                return Clipper<Int128>::intersect(integers(small[0][i]), integers(small[1][j]));
            }};
}

/// Random triangles, and others that touch these up to rounding.
Scene touching(std::uint64_t seed)
{
    Random random{std::mt19937_64(seed)};
    std::array<std::vector<TrianglePoints>, 2> points;
    for (int t = 0; t < 12; ++t) {
        points[0].push_back({random.point(), random.point(), random.point()});
        points[1].push_back(near_touching(random, points[0].back()));
    }
    return {points[0], points[1],
            [&](std::size_t i, std::size_t j) { return exact_intersect(points[0][i], points[1][j]); }};
}

std::vector<LazyOptions> some_options()
{
    std::vector<LazyOptions> all(5);
    all[1].update = Update::lazy;
    all[1].kdop = 26;
    all[2].update = Update::full;
    all[2].kdop = 14;
    all[3].precision = Precision::float64;
    all[3].update = Update::lazy;
    all[4].keep_cut = false;
    all[4].kdop = 18;
    return all;
}

std::string text(const Powers& powers)
{
    return std::to_string(powers[0]) + " " + std::to_string(powers[1]) + " " + std::to_string(powers[2]);
}

std::vector<DeformableSurface> scaled(const std::vector<DeformableSurface>& surfaces, const Powers& powers)
{
    std::vector<DeformableSurface> out = surfaces;
    for (DeformableSurface& s : out)
        s.mesh = scaled(s.mesh, powers);
    return out;
}

/// Queries one frame and compares with the pairs expected, or, where there are none given, with brute force on the
/// vertices of evaluate_vertex. `may_be_unknown`: a body may be reported instead, so near the end of doubles.
std::size_t check(Collider& collider, const std::vector<DeformableSurface>& surface,
                  const std::vector<BodyFrame>& frame, const Pairs* expected, const std::string& what,
                  bool may_be_unknown = false)
{
    collider.update(frame);
    std::vector<bool> left_out(surface.size(), false);
    for (const std::uint32_t b : collider.unknown()) {
        left_out[b] = true;
        if (!may_be_unknown)
            FAIL(what << ": unknown");
    }
    const Pairs found = sorted(collider.pairs());
    Pairs truth;
    if (!expected || !collider.unknown().empty()) {
        std::vector<const DeformableSurface*> surfaces;
        std::vector<Positions> positions;
        for (std::size_t b = 0; b < surface.size(); ++b) {
            surfaces.push_back(&surface[b]);
            positions.push_back(positions_of(surface[b], frame[b]));
        }
        truth = brute_force(surfaces, positions, left_out);
        expected = &truth;
    }
    if (found != *expected)
        FAIL(what << ": " << difference(*expected, found));
    return found.size();
}

void add(Collider& collider, const std::vector<DeformableSurface>& surface, RestDetail detail = RestDetail::inner)
{
    for (const DeformableSurface& s : surface)
        collider.add(build_bvh(s, ClusterSize{16, 16}, detail), s);
}

constexpr int least = -1074, most = 1019; // 10·2^1019 is finite

void check_every_power(const Scene& scene, std::uint64_t seed)
{
    Dice dice(seed);
    const auto options = some_options();
    std::vector<std::unique_ptr<Collider>> unscaled; // of the rest surface as it is, through all powers
    for (const LazyOptions& o : options) {
        unscaled.push_back(std::make_unique<Collider>(o));
        add(*unscaled.back(), scene.surface);
    }
    const Maps identity(1, identity_map);
    for (int power = least; power <= most; power += power_stride())
        for (int i = 0; i < 3 * repeats(); ++i) {
            Powers powers{power, power, power};
            const bool alike = i % 3 < 2;
            if (!alike)
                for (std::size_t r = 0; r < 1 + dice.below(3); ++r) // an axis of its own, or each
                    powers[dice.below(3)] = static_cast<int>(dice.below(most - least + 1)) + least;
            const std::size_t turn = static_cast<std::size_t>(power - least + i) % options.size();
            const std::string what = "powers " + text(powers) + ", options " + std::to_string(turn);
            const bool exact =
                is_exact(scene.surface[0].mesh.vertices, powers) && is_exact(scene.surface[1].mesh.vertices, powers);
            const Pairs* const expected = exact ? &scene.truth : nullptr;
            const bool extreme = *std::max_element(powers.begin(), powers.end()) > 1000;
            const auto by = [](const Powers& e) {
                AffineMap map = identity_map;
                for (std::size_t r = 0; r < 3; ++r)
                    map.m[r][r] = std::ldexp(1.0, e[r]);
                return Maps(1, map);
            };
            if (i % 3 != 1) {
                std::vector<Positions> given;
                for (const DeformableSurface& s : scene.surface)
                    given.push_back(scaled(s.mesh.vertices, powers));
                check(*unscaled[turn], scene.surface, {{{}, given[0]}, {{}, given[1]}}, expected, "given, " + what);
                if (!alike && power % 4)
                    continue;
                const Maps maps = by(powers);
                check(*unscaled[turn], scene.surface, {{maps}, {maps}}, expected, "by motion, " + what, extreme);
            } else {
                const std::vector<DeformableSurface> rest = scaled(scene.surface, powers);
                LazyOptions box = options[turn]; // such trees are quick to build
                box.methods = Method::limited;
                Collider own(power % 8 ? box : options[turn]);
                add(own, rest, power % 8 ? RestDetail::boxes : RestDetail::inner);
                check(own, rest, {{identity}, {identity}}, expected, "at rest, " + what, extreme);
                const int back = std::clamp(-power, -1000, 1000); // to where it was before, or near it
                const Maps undone = by({back, back, back});
                check(own, rest, {{undone}, {undone}}, expected, "scaled back, " + what,
                      extreme || power + back > 1000);
            }
        }
}

} // namespace

TEST_CASE("whole numbers at every power of two, alike for all axes or not: colliders agree with an exact clipper")
{
    const Scene scene = whole_numbers(31);
    REQUIRE(scene.truth.size() > 15);
    check_every_power(scene, 32);
}

TEST_CASE("touching triangles at every power of two, alike for all axes or not: colliders agree with an exact clipper")
{
    const Scene scene = touching(33);
    REQUIRE(scene.truth.size() > 15);
    check_every_power(scene, 34);
}

TEST_CASE("a body of one size on the surface of a body of another, at every power of two")
{
    Dice dice(35);
    const auto options = some_options();
    constexpr int least_size = -1060, most_size = 1010;
    std::vector<DeformableSurface> surface;
    for (int b = 0; b < 3; ++b)
        surface.push_back(rigid(b == 1 ? ring_sphere(12) : soup(dice, 8, 0.7)));
    std::vector<std::unique_ptr<Collider>> colliders;
    for (const LazyOptions& o : options) {
        colliders.push_back(std::make_unique<Collider>(o));
        add(*colliders.back(), surface);
    }
    std::size_t pairs = 0;
    for (int power = least_size; power <= most_size; power += power_stride())
        for (int i = 0; i < repeats(); ++i) {
            std::array<int, 3> size;
            for (int& s : size)
                s = dice.below(2) ? std::clamp(power + static_cast<int>(dice.below(81)) - 40, least_size, most_size)
                                  : static_cast<int>(dice.below(most_size - least_size + 1)) + least_size;
            size[dice.below(3)] = power;
            std::vector<Positions> given;
            std::vector<Maps> maps;
            for (std::size_t b = 0; b < 3; ++b) {
                const Eigen::Matrix3d turned = dice.rotation();
                Positions p = surface[b].mesh.vertices;
                // A point of the body comes to 0, so that what is tiny meets it there.
                const Triangle& t = dice.of(surface[b].mesh.triangles);
                const double s = dice.unit(), u = (1 - s) * dice.unit();
                const Vec3 middle = p[t[0]] + s * (p[t[1]] - p[t[0]]) + u * (p[t[2]] - p[t[0]]);
                for (Vec3& x : p)
                    x = turned * (x - middle);
                given.push_back(scaled(std::move(p), {size[b], size[b], size[b]}));
                const double scale = std::ldexp(1.0, size[b]);
                maps.push_back(Maps(1, affine(scale * turned, -scale * (turned * middle))));
            }
            const std::size_t turn = static_cast<std::size_t>(power - least_size + i) % options.size();
            const std::string what = "sizes " + text(size) + ", options " + std::to_string(turn);
            std::vector<BodyFrame> frame, moving;
            for (std::size_t b = 0; b < 3; ++b) {
                frame.push_back({{}, given[b]});
                moving.push_back({maps[b]});
            }
            pairs += check(*colliders[turn], surface, frame, nullptr, "given, " + what);
            pairs += check(*colliders[turn], surface, moving, nullptr, "by motion, " + what, power > 1000);
        }
    CHECK(pairs > static_cast<std::size_t>(1000 / power_stride()));
}
