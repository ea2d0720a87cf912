// SPDX-License-Identifier: GPL-3.0-or-later
// The filters where numbers overflow and underflow: at every power of two that a double has, and of two floats against
// each other.
#include <cstring>

#include <catch2/catch.hpp>

#include "tests/collide/pair_cases.hpp"
#include "tests/support.hpp"
#include "toolkit/collide/kernel/cluster_kernel.hpp"
#include "toolkit/deform/aligned.hpp"
#include "toolkit/deform/kernel/targets.hpp"
#include "toolkit/hierarchy/kernel/leaf_kernel.hpp"

using namespace cinch;
using namespace cinch::test;

namespace {

/// x·2^power in every coordinate, rounded where it is subnormal.
TrianglePoints scaled(TrianglePoints t, int power)
{
    for (Vec3& v : t)
        for (double& x : v)
            x = std::ldexp(x, power);
    return t;
}

// Triangles of floats about the place 0 with no errors of their own: what the kernel says of them without doubt must be
// true.
struct FloatLeaf {
    std::vector<TrianglePoints> truth;
    AlignedVector<float> slot;
    float dop[8] = {};

    FloatLeaf(std::size_t lanes, std::vector<TrianglePoints> triangles)
        : truth(std::move(triangles)), slot((leaf_slot_floats(lanes) + 15) / 16 * 16, 0.0f)
    {
        auto* const corner = reinterpret_cast<std::uint8_t*>(slot.data() + 3 * lanes);
        std::size_t place = 0;
        for (float& side : dop)
            side = -std::numeric_limits<float>::infinity();
        for (std::size_t t = 0; t < truth.size(); ++t)
            for (std::size_t c = 0; c < 3; ++c, ++place) {
                corner[c * lanes + t] = static_cast<std::uint8_t>(place);
                for (std::size_t r = 0; r < 3; ++r) {
                    double& x = truth[t][c][static_cast<int>(r)];
                    const float f = slot[r * lanes + place] = static_cast<float>(x);
                    x = static_cast<double>(f);
                    dop[r] = std::max(dop[r], f);
                    dop[4 + r] = std::max(dop[4 + r], -f);
                }
            }
        for (std::size_t r = 0; r < 3; ++r) {
            std::fill(slot.begin() + static_cast<std::ptrdiff_t>(r * lanes + place),
                      slot.begin() + static_cast<std::ptrdiff_t>((r + 1) * lanes), slot[r * lanes]);
            for (std::size_t t = truth.size(); t < lanes; ++t)
                corner[r * lanes + t] = corner[r * lanes];
        }
        place_of(slot.data(), lanes) = {{0, 0, 0}, 0, 0};
    }
};

// Of numbers from −1 to 1: a triangle whose plane contains 0, exactly or up to rounding, or any, or a flat one.
TrianglePoints about_zero(Random& random)
{
    TrianglePoints t{random.point(), random.point(), random.point()};
    switch (random.below(7)) {
    case 0:
        t[2] = -(t[0] + t[1]) / 2;
        break;
    case 1:
        t[2] = -t[random.below(2)] * random.unit();
        break; // an edge through 0
    case 2:
        for (Vec3& v : t) // whole numbers
            v = (v * 4).array().round().matrix() / 4;
        t[2] = -(t[0] + t[1]) / 2;
        break;
    case 3:
        t[random.below(3)] *= 0x1p-30;
        break;
    case 4:
        t[2] = t[0] + random.unit() * (t[1] - t[0]);
        break; // a needle
    case 5:
        for (Vec3& v : t)
            v[2] *= 0x1p-20; // flat
        break;
    default:
        break;
    }
    return t;
}

} // namespace

TEST_CASE("triangle pairs agree with an exact clipper at every power of two, the same or another for each axis")
{
    Random random{std::mt19937_64(6)};
    OrientationCounts counts;
    std::array<std::size_t, 2> answers{};
    for (int power = -1074; power <= 1023; power += power_stride())
        for (int i = 0; i < 18 * repeats(); ++i) {
            // Whole numbers of at most 10, less where they would overflow: all products with powers of two are exact.
            std::array<int, 3> e{power, power, power};
            if (i % 3 == 1)
                e[random.below(3)] = static_cast<int>(random.below(2095)) - 1074;
            if (i % 3 == 2)
                for (int& other : e)
                    other = static_cast<int>(random.below(2095)) - 1074;
            const int greatest = std::min(10, 1 << std::min(10, 1023 - std::max({e[0], e[1], e[2]})));
            const auto small = [&](int how) {
                SmallTriangle t =
                    collapse(random_triangle(random.bits, how == 3 || how == 4 ? greatest / 2 : greatest), how);
                for (auto& v : t)
                    for (int& x : v)
                        x = std::clamp(x, -greatest, greatest);
                return t;
            };
            const SmallTriangle a = small(1 + i % 6), b = small(1 + i / 6 % 6);
            const auto place = [&e](const SmallTriangle& t) {
                TrianglePoints out;
                for (std::size_t c = 0; c < 3; ++c)
                    for (std::size_t r = 0; r < 3; ++r)
                        out[c][static_cast<int>(r)] = std::ldexp(t[c][r], e[r]);
                return out;
            };
            const bool expected = Clipper<Int128>::intersect(integers(a), integers(b));
            ++answers[expected];
            if (intersect(place(a), place(b), &counts) != expected || intersect(place(b), place(a)) != expected)
                FAIL("powers " << e[0] << " " << e[1] << " " << e[2] << ": " << text(doubles(a), doubles(b)));
        }
    const auto some = static_cast<std::size_t>(100 / power_stride());
    CHECK(answers[0] > some);
    CHECK(answers[1] > some);
    CHECK(counts.in_double > some);
    CHECK(counts.in_expansion > some);
    CHECK(counts.in_integer > some);
}

TEST_CASE("triangle pairs that touch up to rounding agree with an exact clipper in every order, at every power of two")
{
    Random random{std::mt19937_64(7)};
    for (int power = -1074; power <= 1023; power += power_stride()) {
        const TrianglePoints a = scaled({random.point(), random.point(), random.point()}, power);
        TrianglePoints b = scaled(near_touching(random, scaled(a, -power)), power);
        for (Vec3& v : b) // twice as far as a coordinate may be
            v = v.cwiseMax(-std::numeric_limits<double>::max()).cwiseMin(std::numeric_limits<double>::max());
        const bool expected = exact_intersect(a, b);
        if (wrong_orders(a, b, expected) > 0)
            FAIL("power " << power << ": " << text(a, b));
    }
}

TEST_CASE("what floats decide without doubt is true at every power of two, alike for both triangles or not, on every "
          "target alike")
{
    Random random{std::mt19937_64(8)};
    const auto targets = kernel_targets();
    std::size_t hits = 0, misses = 0;
    constexpr int least = -150, most = 120; // beyond it a leaf is not known
    for (int power = least; power <= most; power += power_stride())
        for (int i = 0; i < 60 * repeats(); ++i) {
            const std::size_t lanes = std::size_t{4} << random.below(3);
            const int other = i % 3 == 0   ? power
                              : i % 3 == 1 ? static_cast<int>(random.below(most - least)) + least
                                           : std::clamp(-power / 2 - 50, least, most);
            std::vector<TrianglePoints> p, q;
            for (std::size_t t = 0; t < std::max<std::size_t>(1, lanes / 3); ++t) {
                p.push_back(scaled(about_zero(random), power));
                q.push_back(scaled(about_zero(random), other));
            }
            if (i % 2)
                p.swap(q);
            const FloatLeaf a(lanes, p), b(lanes, q);
            const auto count = static_cast<std::uint32_t>(p.size());
            const ClusterPair pair{a.slot.data(), b.slot.data(), a.dop, b.dop, count, count};
            const ClusterInput in{lanes, 4, {0, 0, 0, 0}, 0};
            std::vector<TriangleHit> first;
            for (std::size_t n = 0; n < (i < 6 ? targets.size() : 1); ++n) {
                if (i < 6)
                    REQUIRE(force_kernel_target(targets[n]));
                std::vector<TriangleHit> found;
                std::uint64_t tests = 0;
                test_clusters(in, {&pair, 1}, 0, found, tests);
                force_kernel_target("");
                if (n == 0)
                    first = found;
                REQUIRE(std::equal(first.begin(), first.end(), found.begin(), found.end(),
                                   [](const TriangleHit& x, const TriangleHit& y) {
                                       return x.i == y.i && x.j == y.j && x.doubtful == y.doubtful;
                                   }));
            }
            auto next = first.begin();
            for (std::size_t j = 0; j < p.size(); ++j)
                for (std::size_t k = 0; k < q.size(); ++k) {
                    const bool listed = next != first.end() && next->i == j && next->j == k,
                               doubtful = listed && next->doubtful;
                    next += listed;
                    if (doubtful)
                        continue;
                    ++(listed ? hits : misses);
                    if (intersect(a.truth[j], b.truth[k]) != listed)
                        FAIL("powers " << power << " and " << other << ": " << (listed ? "found " : "lost ")
                                       << text(a.truth[j], b.truth[k]));
                }
        }
    CHECK(hits > 100);
    CHECK(misses > 100);
}
