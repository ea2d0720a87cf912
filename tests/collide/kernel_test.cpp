// SPDX-License-Identifier: GPL-3.0-or-later
// The float kernels on input made to be as hard as their stated errors allow.
#include <cstring>

#include <catch2/catch.hpp>

#include "cinch/bounds.hpp"
#include "tests/collide/random_bodies.hpp"
#include "tests/support.hpp"
#include "toolkit/bounds/rounding.hpp"
#include "toolkit/collide/kernel/box_kernel.hpp"
#include "toolkit/collide/kernel/cluster_kernel.hpp"
#include "toolkit/deform/aligned.hpp"
#include "toolkit/deform/kernel/targets.hpp"
#include "toolkit/hierarchy/dop.hpp"
#include "toolkit/hierarchy/kernel/leaf_kernel.hpp"

using namespace cinch;
using namespace cinch::test;

namespace {

double on(double x, double grid) { return std::round(x / grid) * grid; }
Vec3 on(Vec3 x, double grid)
{
    for (double& c : x)
        c = on(c, grid);
    return x;
}

// A leaf whose true vertices are off from the stored ones by as much as it says, all sums exact in double: stored ones
// are multiples of 2^-28 below 4, errors of 2^-48, references of 2^-4 below 32.
struct Leaf {
    std::size_t lanes;
    std::vector<TrianglePoints> truth; // relative to the world
    AlignedVector<float> slot;
    float dop[8] = {};

    // `wanted`: triangles near the world's origin.
    Leaf(Dice& dice, std::size_t l, const std::vector<TrianglePoints>& wanted, double error, double difference,
         const Vec3& reference, const Vec3& origin)
        : lanes(l), truth(wanted.size()), slot((leaf_slot_floats(l) + 15) / 16 * 16, 0.0f)
    {
        auto* const corner = reinterpret_cast<std::uint8_t*>(slot.data() + 3 * lanes);
        std::vector<std::size_t> places(lanes); // triangles share no vertices here, but wrap around where lanes are few
        const double own = std::min(error, difference / 2);
        Vec3 common;
        for (double& x : common)
            x = on((dice.below(2) ? 1 : -1) * (error - own) * 0.999, 0x1p-48);
        Vec3 most = Vec3::Constant(-1e30), least = -most;
        std::size_t place = 0;
        for (std::size_t t = 0; t < wanted.size(); ++t)
            for (std::size_t c = 0; c < 3; ++c, ++place) {
                const Vec3 p = on(wanted[t][c] - reference - origin, 0x1p-22);
                corner[c * lanes + t] = static_cast<std::uint8_t>(place);
                for (int r = 0; r < 3; ++r) {
                    slot[static_cast<std::size_t>(r) * lanes + place] = static_cast<float>(p[r]);
                    const double off = common[r] + on((dice.below(2) ? 1 : -1) * own * 0.999, 0x1p-48);
                    truth[t][c][r] = origin[r] + reference[r] +
                                     static_cast<double>(slot[static_cast<std::size_t>(r) * lanes + place]) + off;
                    most[r] = std::max(most[r], truth[t][c][r] - origin[r]);
                    least[r] = std::min(least[r], truth[t][c][r] - origin[r]);
                }
            }
        for (std::size_t r = 0; r < 3; ++r) {
            for (std::size_t v = place; v < lanes; ++v)
                slot[r * lanes + v] = slot[r * lanes];
            for (std::size_t t = wanted.size(); t < lanes; ++t)
                corner[r * lanes + t] = corner[r * lanes];
            dop[r] = succ(static_cast<float>(most[static_cast<int>(r)]));
            dop[4 + r] = succ(static_cast<float>(-least[static_cast<int>(r)]));
        }
        LeafPlace& at = place_of(slot.data(), lanes);
        for (std::size_t r = 0; r < 3; ++r)
            at.reference[r] = static_cast<float>(reference[static_cast<int>(r)]);
        at.error = static_cast<float>(error);
        at.difference = static_cast<float>(difference);
    }
};

// Touches t but for about `gap`: a corner, an edge or a face near its corner, edge or face, or an edge along an edge.
TrianglePoints almost_touching(Dice& dice, const TrianglePoints& t, double gap)
{
    const std::size_t i = dice.below(3);
    const Vec3 e = t[1] - t[0], f = t[2] - t[0], n = e.cross(f).normalized(),
               off = gap * dice.symmetric() * (dice.below(2) ? n : dice.point());
    const double s = dice.unit(), along = dice.unit();
    const Vec3 inside = t[0] + s * e + (1 - s) * along * f, edge = t[i] + s * (t[(i + 1) % 3] - t[i]);
    const Vec3 d = dice.point(), g = dice.point();
    switch (dice.below(7)) {
    case 0:
        return {inside + off, inside + off + n + 0.7 * d, inside + off + n + 0.7 * g};
    case 1:
        return {edge + off, edge + off + d, edge + off + g};
    case 2:
        return {edge + off + d, edge + off - d, edge + off + g};
    case 3:
        return {t[i] + off, t[i] + off + d, t[i] + off + g};
    case 4:
        return {t[i] + off, t[(i + 1) % 3] + off, g}; // edge along edge
    case 5:
        return {t[0] + off + 0.3 * e, t[1] + off - 0.2 * f, t[2] + gap * d}; // about coplanar
    default:
        return {inside + off, inside + off + 1e-3 * d, inside + off + g}; // a sliver
    }
}

// The same beyond the corner that is the furthest of all along some axis, so that it is the leaves' boxes that almost
// touch.
TrianglePoints almost_touching_outside(Dice& dice, const std::vector<TrianglePoints>& all, double gap)
{
    const auto r = static_cast<Eigen::Index>(dice.below(3));
    const double side = dice.below(2) ? 1 : -1;
    Vec3 furthest = all[0][0];
    for (const TrianglePoints& t : all)
        for (const Vec3& x : t)
            if (side * x[r] > side * furthest[r])
                furthest = x;
    const Vec3 corner = furthest + gap * dice.point();
    TrianglePoints out{corner, corner + dice.point(), corner + dice.point()};
    for (const std::size_t c : {1u, 2u})
        out[c][r] = corner[r] + side * dice.unit();
    return out;
}

struct Outcome {
    std::size_t hits = 0, doubtful = 0, misses = 0;
};

bool same(const std::vector<TriangleHit>& a, const std::vector<TriangleHit>& b)
{
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const TriangleHit& x, const TriangleHit& y) {
        return x.pair == y.pair && x.i == y.i && x.j == y.j && x.doubtful == y.doubtful;
    });
}

} // namespace

TEST_CASE("what floats decide is true of every surface within their errors, on every target alike")
{
    Dice dice(71);
    const auto targets = kernel_targets();
    Outcome sum;
    const auto rounds = static_cast<int>(share_of(60000));
    for (int round = 0; round < rounds; ++round) {
        const std::size_t lanes = std::size_t{4} << dice.below(3), triangles = std::max<std::size_t>(1, lanes / 3);
        const double error_a = on(std::exp2(-18 - 26 * dice.unit()), 0x1p-48),
                     error_b = on(std::exp2(-18 - 26 * dice.unit()), 0x1p-48);
        const double bend_a = on(2 * error_a * (dice.below(2) ? 1 : dice.unit()), 0x1p-46),
                     bend_b = on(2 * error_b * (dice.below(2) ? 1 : dice.unit()), 0x1p-46);
        const double shift_error = dice.below(2) ? on(std::exp2(-12 - 28 * dice.unit()), 0x1p-48) : 0;
        const double gap = (error_a + error_b + shift_error + 0x1p-24) * std::exp2(8 * dice.symmetric());
        const double size = std::exp2(-4 * dice.unit());
        std::vector<TrianglePoints> of_a, of_b;
        for (std::size_t t = 0; t < triangles; ++t) {
            of_a.push_back({size * dice.point(), size * dice.point(), size * dice.point()});
            if (dice.below(8) == 0)
                of_a.back()[2] = of_a.back()[0] + dice.unit() * (of_a.back()[1] - of_a.back()[0]);
        }
        const bool outside = dice.below(4) == 0;
        for (std::size_t t = 0; t < triangles; ++t) {
            of_b.push_back(!outside ? almost_touching(dice, of_a[dice.below(triangles)], gap)
                                    : almost_touching_outside(dice, of_a, gap));
            for (Vec3& x : of_b.back())
                x = x.cwiseMax(-3).cwiseMin(3);
        }
        // The bodies' origins: the same, or `between` apart, known up to an error.
        ClusterInput in{lanes, 4, {0, 0, 0}, 0};
        Vec3 between = Vec3::Zero();
        if (shift_error > 0) {
            in.shift_error = succ(static_cast<float>(shift_error));
            for (std::size_t r = 0; r < 3; ++r) {
                in.shift[r] = static_cast<float>(on(8 * dice.symmetric(), 0x1p-20));
                between[static_cast<int>(r)] =
                    static_cast<double>(in.shift[r]) + (dice.below(2) ? 1 : -1) * on(shift_error, 0x1p-48);
            }
        }
        const Vec3 reference_a = on(8 * dice.point(), 0x1p-4),
                   reference_b = on(Vec3(-between + 2 * dice.point()), 0x1p-4);
        // Leaf a stands about the world's origin: its body's origin is at −reference.
        const Leaf a(dice, lanes, of_a, error_a, bend_a, reference_a, -reference_a),
            b(dice, lanes, of_b, error_b, bend_b, reference_b, between - reference_a);
        const auto count = static_cast<std::uint32_t>(triangles);
        const ClusterPair pair{a.slot.data(), b.slot.data(), a.dop, b.dop, count, count};
        std::vector<TriangleHit> found;
        std::uint64_t tests = 0;
        for (std::size_t i = 0; i < (round < 3000 ? targets.size() : 1); ++i) {
            if (round < 3000)
                force_kernel_target(targets[i]);
            std::vector<TriangleHit> own;
            std::uint64_t own_tests = 0;
            test_clusters(in, {&pair, 1}, 0, own, own_tests);
            if (i == 0) {
                found = own;
                tests = own_tests;
            }
            REQUIRE(same(own, found));
            REQUIRE(own_tests == tests);
        }
        force_kernel_target("");
        REQUIRE(std::is_sorted(found.begin(), found.end(), [](const TriangleHit& x, const TriangleHit& y) {
            return std::pair(x.i, x.j) < std::pair(y.i, y.j);
        }));
        auto next = found.begin();
        for (std::size_t i = 0; i < triangles; ++i)
            for (std::size_t j = 0; j < triangles; ++j) {
                const bool listed = next != found.end() && next->i == i && next->j == j,
                           doubtful = listed && next->doubtful;
                next += listed;
                ++(doubtful ? sum.doubtful : listed ? sum.hits : sum.misses);
                if (!doubtful && intersect(a.truth[i], b.truth[j]) != listed)
                    FAIL("round " << round << ", " << lanes << " lanes, errors " << error_a << " " << error_b << ": "
                                  << (listed ? "found" : "lost"));
            }
        REQUIRE(next == found.end());
    }
    CAPTURE(sum.hits, sum.doubtful, sum.misses);
    CHECK(sum.hits > share_of(30000));
    CHECK(sum.misses > share_of(30000));
    CHECK(sum.doubtful > share_of(1000));
}

TEST_CASE("k-DOPs are apart if and only if their supports say so, on every target, in order")
{
    Dice dice(72);
    const auto targets = kernel_targets();
    for (const int kdop : kdops) {
        const std::size_t side = dop_side(kdop), floats = dop_floats(kdop), half = static_cast<std::size_t>(kdop) / 2;
        constexpr std::size_t bvs = 64;
        AlignedVector<float> a(bvs * floats, 0.0f), b(a), shift(floats, 0.0f);
        for (AlignedVector<float>* all : {&a, &b})
            for (std::size_t i = 0; i < bvs; ++i) {
                for (std::size_t d = 0; d < half; ++d) {
                    const double middle = std::round(4 * dice.symmetric()),
                                 width = std::round(8 * dice.unit()); // many touch exactly
                    (*all)[i * floats + d] = static_cast<float>(middle + width + (dice.below(4) ? 0 : 1e-7));
                    (*all)[i * floats + side + d] = static_cast<float>(width - middle);
                    if (dice.below(100) == 0)
                        (*all)[i * floats + d] = dice.below(2) ? std::numeric_limits<float>::infinity()
                                                               : std::numeric_limits<float>::quiet_NaN();
                }
                (*all)[i * floats + side - 1] = 16777215; // a stamp
            }
        std::vector<BoxTest> tests;
        for (std::size_t n = 0; n < 4000; ++n) {
            auto one = [&] {
                const auto i = static_cast<std::uint32_t>(dice.below(bvs - 1));
                return dice.below(2) ? i | BoxTest::both : i;
            };
            tests.push_back({one(), one()});
        }
        std::vector<BvPair> expected;
        for (const BoxTest& t : tests)
            for (std::uint32_t i = t.a & ~BoxTest::both; i <= (t.a & ~BoxTest::both) + (t.a >> 31); ++i)
                for (std::uint32_t j = t.b & ~BoxTest::both; j <= (t.b & ~BoxTest::both) + (t.b >> 31); ++j) {
                    bool apart = false;
                    for (std::size_t d = 0; d < half; ++d)
                        apart =
                            apart ||
                            static_cast<double>(a[i * floats + d]) + static_cast<double>(b[j * floats + side + d]) <
                                0 ||
                            static_cast<double>(a[i * floats + side + d]) + static_cast<double>(b[j * floats + d]) < 0;
                    if (!apart)
                        expected.push_back({i, j});
                }
        REQUIRE(expected.size() > 200);
        for (const std::string& target : targets) {
            INFO(target << ", k " << kdop);
            REQUIRE(force_kernel_target(target));
            std::vector<BvPair> out(4 * tests.size());
            out.resize(static_cast<std::size_t>(
                test_boxes({side, a.data(), b.data(), shift.data()}, tests, out.data()) - out.data()));
            force_kernel_target("");
            REQUIRE(std::equal(out.begin(), out.end(), expected.begin(), expected.end(),
                               [](const BvPair& x, const BvPair& y) { return x.a == y.a && x.b == y.b; }));
        }
    }
}

TEST_CASE("whole queries: the same list on every target")
{
    Dice dice(73);
    Bodies bodies;
    bodies.surface.push_back(soft(brain(300), 20));
    bodies.surface.push_back(patchy(dice, fish(300), 12, 4));
    for (int f = 0; f < 4; ++f)
        bodies.add_frame({around(dice, 20, dice.rotation(), 0.3 * dice.point(), 0.1),
                          around(dice, 12, dice.rotation(), f * 100 * dice.point(), 0.02)});
    const std::vector<Bvh> trees = bodies.trees({16, 16});
    std::vector<std::vector<Pairs>> lists;
    std::vector<std::uint64_t> counts;
    for (const std::string& target : kernel_targets()) {
        REQUIRE(force_kernel_target(target));
        Collider collider{LazyOptions{}};
        for (std::size_t b = 0; b < 2; ++b)
            collider.add(trees[b], bodies.surface[b]);
        lists.emplace_back();
        counts.push_back(0);
        for (const auto& frame : bodies.frame) {
            collider.update(frame);
            lists.back().push_back(collider.pairs());
            counts.back() = counts.back() * 31 + collider.counts().box_tests + 7 * collider.counts().triangle_tests +
                            11 * collider.counts().in_exact;
        }
        force_kernel_target("");
        CHECK((lists.back() == lists[0]));
        CHECK(counts.back() == counts[0]);
    }
    CHECK((sorted(lists[0][0]) == bodies.truth()[0]));
}
