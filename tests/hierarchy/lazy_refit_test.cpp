// SPDX-License-Identifier: GPL-3.0-or-later
// What is current contains what it must, at the moment when a query reads it: in exact integers.
#include <catch2/catch.hpp>

#include "cinch/bounds.hpp"
#include "cinch/deform.hpp"
#include "tests/collide/clipper.hpp"
#include "tests/collide/random_bodies.hpp"
#include "tests/support.hpp"
#include "toolkit/hierarchy/lazy_refit.hpp"

using namespace cinch;
using namespace cinch::test;

namespace {

constexpr int unit = -1074; // every finite double is a multiple of 2 to the power of this

// x·2^(3·1074), as the product of three doubles each counted in units.
BigInt thrice(double x) { return scaled_integer(x, unit) << (-2 * unit); }

using Point = std::array<BigInt, 3>; // coordinates in units of 2^(3·unit)

Point exact_vertex(const DeformableSurface& surface, std::uint32_t k, const Maps& maps)
{
    const Weights::Row row = surface.weights.of(k);
    const BigInt one = scaled_integer(1, unit);
    Point out{0, 0, 0};
    for (std::size_t i = 0; i < row.node.size(); ++i)
        for (std::size_t r = 0; r < 3; ++r) {
            const auto& m = maps[row.node[i]].m[r];
            BigInt image = scaled_integer(m[3], unit) * one;
            for (int s = 0; s < 3; ++s)
                image += scaled_integer(m[s], unit) * scaled_integer(surface.mesh.vertices[k][s], unit);
            out[r] += scaled_integer(row.weight[i], unit) * image;
        }
    return out;
}

Point exactly(const Vec3& x) { return {thrice(x[0]), thrice(x[1]), thrice(x[2])}; }

BigInt along(const Axis& axis, const Point& p)
{
    BigInt sum = 0;
    for (std::size_t r = 0; r < 3; ++r)
        sum += axis[r] * p[r];
    return sum;
}

// The body in its frame: the exact vertices and the computed ones.
struct Truth {
    std::vector<Point> vertex[2];

    Truth(const DeformableSurface& surface, const BodyFrame& frame)
    {
        const Positions computed = positions_of(surface, frame);
        const Maps maps(frame.maps.begin(), frame.maps.end());
        for (std::uint32_t k = 0; k < computed.size(); ++k) {
            vertex[0].push_back(exactly(computed[k]));
            vertex[1].push_back(frame.positions.empty() ? exact_vertex(surface, k, maps) : vertex[0].back());
        }
    }
};

struct Seen {
    std::size_t inner = 0, leaves = 0, slots = 0;
};

void check_dops(const DeformableSurface& surface, const Bvh& bvh, const LazyRefit& tree, int kdop, const Truth& truth,
                Seen& seen)
{
    const auto axes = axes_of(kdop);
    const Point origin = exactly(tree.origin());
    std::size_t outside = 0;
    for (std::uint32_t bv = 0; bv < bvh.bvs.size(); ++bv) {
        if (!tree.current(bv))
            continue;
        ++(bvh.bvs[bv].is_leaf() ? seen.leaves : seen.inner);
        const auto vertices = vertices_of(surface, bvh, bvh.bvs[bv]);
        for (std::size_t a = 0; a < axes.size(); ++a) {
            const float up = tree.dop(bv)[a], down = tree.dop(bv)[dop_side(kdop) + a];
            REQUIRE((up == up && down == down));
            const bool open_up = up == std::numeric_limits<float>::infinity(),
                       open_down = down == std::numeric_limits<float>::infinity();
            const BigInt middle = along(axes[a], origin),
                         most = open_up ? BigInt(0) : BigInt(thrice(static_cast<double>(up)) + middle),
                         least = open_down ? BigInt(0) : BigInt(middle - thrice(static_cast<double>(down)));
            for (const std::uint32_t k : vertices)
                for (const auto& all : truth.vertex) {
                    const BigInt x = along(axes[a], all[k]);
                    outside += (!open_up && x > most) || (!open_down && x < least);
                }
        }
    }
    REQUIRE(outside == 0);
}

void check_slots(const DeformableSurface& surface, const LazyRefit& tree, std::size_t bvs, const Truth& truth,
                 Seen& seen)
{
    const Point origin = exactly(tree.origin());
    const std::size_t lanes = tree.lanes();
    std::size_t off = 0, bent = 0;
    for (std::uint32_t bv = 0; bv < bvs; ++bv) {
        if (!tree.current(bv) || !tree.link(bv).is_leaf())
            continue;
        const float* const slot = tree.slot(bv);
        const LeafPlace& place = place_of(slot, lanes);
        if (!(place.error < std::numeric_limits<float>::infinity()))
            continue;
        ++seen.slots;
        const BigInt error = thrice(static_cast<double>(place.error)),
                     difference = thrice(static_cast<double>(place.difference));
        std::vector<std::array<Point, 2>> wrong; // by how much each corner is off, from either truth
        for (std::uint32_t t = 0; t < tree.leaf(bv).triangles; ++t)
            for (std::size_t c = 0; c < 3; ++c) {
                const std::uint32_t k = surface.mesh.triangles[tree.triangle(tree.leaf(bv).first_triangle + t)][c];
                const std::size_t lane = cinch::corners_of(slot, lanes)[c * lanes + t];
                REQUIRE(lane < tree.leaf(bv).vertices);
                wrong.emplace_back();
                for (std::size_t which = 0; which < 2; ++which)
                    for (std::size_t r = 0; r < 3; ++r) {
                        BigInt& d = wrong.back()[which][r];
                        d = truth.vertex[which][k][r] - origin[r] - thrice(static_cast<double>(place.reference[r])) -
                            thrice(static_cast<double>(slot[r * lanes + lane]));
                        off += abs(d) > error;
                    }
            }
        for (std::size_t which = 0; which < 2; ++which)
            for (std::size_t r = 0; r < 3; ++r) {
                const auto [least, most] =
                    std::minmax_element(wrong.begin(), wrong.end(),
                                        [&](const auto& x, const auto& y) { return x[which][r] < y[which][r]; });
                bent += (*most)[which][r] - (*least)[which][r] > difference;
            }
    }
    REQUIRE(off == 0);
    REQUIRE(bent == 0);
}

// Frames that a query goes through by halves: each goes down a random way from what is current, with slots for all
// leaves that are.
Seen go_through(Dice& dice, const DeformableSurface& surface, const std::vector<BodyFrame>& frames,
                const LazyOptions& options, ClusterSize size, std::size_t* merged = nullptr)
{
    const Bvh bvh = build_bvh(surface, size, RestDetail::inner);
    LazyRefit tree(bvh, surface, options);
    Seen seen;
    for (const BodyFrame& frame : frames) {
        tree.begin(frame);
        const Truth truth(surface, frame);
        REQUIRE(tree.known());
        REQUIRE(tree.current(0));
        check_dops(surface, bvh, tree, options.kdop, truth, seen); // merged ones too
        if (merged)
            *merged += tree.counts().merged;
        std::vector<std::uint32_t> reached{0};
        for (int round = 0; round < 10; ++round) {
            for (std::size_t i = reached.size();
                 i-- > 0;) { // what a query may look at: children only of what it looked at
                const std::uint32_t bv = reached[i], child = tree.link(bv).child;
                if (tree.link(bv).is_leaf() || dice.below(3) == 0)
                    continue;
                reached.erase(reached.begin() + static_cast<std::ptrdiff_t>(i));
                options.keep_cut ? tree.expand(bv) : (tree.want(child), tree.want(child + 1));
                reached.insert(reached.end(), {child, child + 1});
            }
            tree.supply();
            for (std::uint32_t bv = 0; bv < bvh.bvs.size(); ++bv)
                if (tree.current(bv) && tree.link(bv).is_leaf())
                    tree.want_slot(bv);
            tree.supply();
        }
        check_dops(surface, bvh, tree, options.kdop, truth, seen);
        check_slots(surface, tree, bvh.bvs.size(), truth, seen);
    }
    return seen;
}

std::vector<LazyOptions> some_options()
{
    std::vector<LazyOptions> all(7);
    for (LazyOptions& options : all)
        options.update = Update::lazy;
    all[1].kdop = 26;
    all[1].methods = Method::linear;
    all[2].precision = Precision::float64;
    all[2].kdop = 14;
    all[3].keep_cut = false;
    all[3].kdop = 18;
    all[4].methods = Method::eq12;
    all[4].rest_shape = RestShape::obb;
    all[4].lanes = 8;
    all[5].update = Update::full;
    all[5].kdop = 26;
    all[5].lanes = 4;
    all[6].methods = Method::local | Method::support;
    all[6].kdop = 14;
    return all;
}
ClusterSize size_of(const LazyOptions& options)
{
    return options.lanes == 4 ? ClusterSize{1, 3} : ClusterSize{options.lanes, options.lanes};
}

} // namespace

TEST_CASE("all that is current contains the exact and the computed vertices, merged or not, and slots are as near to "
          "them as they say")
{
    Dice dice(51);
    const DeformableSurface smooth = soft(brain(110), 12), rough = patchy(dice, ring_sphere(90), 16, 6);
    for (const DeformableSurface* surface : {&smooth, &rough})
        for (const LazyOptions& options : some_options()) {
            std::vector<Maps> maps;
            for (const double strength : {0.0, 0.05, 0.05, 0.8})
                maps.push_back(around(dice, surface->weights.node_count, dice.rotation(), dice.point(), strength));
            std::vector<BodyFrame> frames;
            for (const Maps& m : maps)
                frames.push_back({m});
            std::size_t merged = 0;
            const Seen seen = go_through(dice, *surface, frames, options, size_of(options), &merged);
            CHECK(seen.inner > 20);
            CHECK(seen.slots > 20);
            CHECK((merged > 10 || !options.keep_cut));
        }
}

TEST_CASE(
    "the same far from the origin, at rest or by transforms that cancel, and for scales up to where nothing is known")
{
    Dice dice(52);
    const auto options_of_all = some_options();
    for (const double far : {1e3, 1e6, 1e12})
        for (const double scale : {1.0, 1e-7, 1e9}) {
            TriangleMesh mesh = brain(60);
            const Vec3 away = far * dice.point();
            for (Vec3& v : mesh.vertices)
                v = scale * v + away;
            const DeformableSurface surface = patchy(dice, mesh, 8, 4);
            const Eigen::Matrix3d r = dice.rotation();
            const Maps here = around(dice, 8, r, -r * away, scale > 1e-3 ? 1e-13 : 0),
                       there = around(dice, 8, r, far * dice.point(), 1e-3), still(8, identity_map);
            Maps apart = there; // the nodes' images far from each other
            for (AffineMap& map : apart)
                map.m[dice.below(3)][3] += 1e5 * far * dice.symmetric();
            for (const LazyOptions& options : test::share_of(options_of_all))
                CHECK(go_through(dice, surface, {{here}, {there}, {still}, {apart}, {here}}, options, size_of(options))
                          .inner > 20);
        }
    for (const double scale : {1e-42, 1e-30, 1e-12, 1e12, 1e28, 1e34}) {
        TriangleMesh mesh = brain(50);
        const DeformableSurface by_motion = patchy(dice, mesh, 8, 4);
        for (Vec3& v : mesh.vertices)
            v *= scale;
        const DeformableSurface at_rest = patchy(dice, mesh, 8, 4);
        const Maps turned = around(dice, 8, dice.rotation(), scale * dice.point(), 0.1),
                   scaled = around(dice, 8, scale * dice.rotation(), scale * dice.point(), 0);
        for (const LazyOptions& options : test::share_of(options_of_all)) {
            go_through(dice, at_rest, {{turned}, {turned}}, options, size_of(options));
            go_through(dice, by_motion, {{scaled}, {scaled}}, options, size_of(options));
        }
    }
}

TEST_CASE("the same for given vertices, wherever they are")
{
    Dice dice(53);
    const auto options_of_all = some_options();
    const DeformableSurface surface = soft(brain(80), 10);
    for (const double scale : {1e-45, 1e-38, 1e-10, 1.0, 1e10, 1e36, 1e39})
        for (const double far : {0.0, 1e3, 1e12}) {
            std::vector<Positions> given(3);
            for (Positions& places : given)
                for (const Vec3& x : surface.mesh.vertices)
                    places.push_back(scale * (x + far * Vec3(1, -0.7, 0.3) + 0.1 * dice.point()));
            for (const LazyOptions& options : test::share_of(options_of_all))
                go_through(dice, surface, {{{}, given[0]}, {{}, given[1]}, {{}, given[2]}}, options, size_of(options));
        }
}

TEST_CASE("what was current before more than 2^24 frames is not taken for current")
{
    // Frames of which nothing is known cost next to nothing.
    const DeformableSurface surface = rigid(box({1, 1, 1}, {3, 3, 3}));
    const Bvh bvh = build_bvh(surface, ClusterSize{4, 6}, RestDetail::inner);
    LazyOptions options;
    options.update = Update::lazy;
    options.lanes = 8;
    LazyRefit tree(bvh, surface, options);
    Positions lost(surface.mesh.vertices.size(), Vec3::Zero());
    lost[0][0] = std::numeric_limits<double>::quiet_NaN();
    const BodyFrame unknown{{}, lost};
    std::size_t merged = 0; // all inner BVs but one and what is below it
    std::vector<std::uint32_t> inner{0};
    for (; merged < inner.size(); ++merged)
        for (const std::uint32_t c : {bvh.bvs[inner[merged]].first_child, bvh.bvs[inner[merged]].first_child + 1})
            if (!bvh.bvs[c].is_leaf() && c != 2)
                inner.push_back(c);
    REQUIRE(merged > 5);
    Dice dice(54);
    std::uint64_t frame = 0;
    Maps maps;
    auto check = [&](bool has_cut) {
        maps = Maps(1, moved_by(1e3 * dice.point())); // far from where it was: what is stale is wrong
        const BodyFrame known{maps};
        tree.begin(known);
        ++frame;
        const Truth truth(surface, known);
        Seen seen;
        check_dops(surface, bvh, tree, 6, truth, seen);
        REQUIRE(tree.counts().merged == (has_cut ? merged : 0)); // the cut outlives the wrap
        for (int level = 0; level < 8; ++level) {
            for (std::uint32_t bv = 0; bv < bvh.bvs.size(); ++bv)
                if (tree.current(bv) && !tree.link(bv).is_leaf() && bv != 2) // never below this one
                    tree.expand(bv);
            tree.supply();
        }
        check_dops(surface, bvh, tree, 6, truth, seen);
        REQUIRE(seen.leaves > 4);
    };
    auto skip_to = [&](std::uint64_t to) {
        for (; frame < to; ++frame)
            tree.begin(unknown);
    };
    for (int i = 0; i < 3; ++i)
        check(i > 0);
    for (const std::uint64_t wrap : {std::uint64_t{1} << 24, std::uint64_t{2} << 24}) {
        skip_to(wrap - 6);
        for (int i = 0; i < 15; ++i) // across the wrap, and to the counts of the first frames
            check(i > 0);
    }
}
