// SPDX-License-Identifier: GPL-3.0-or-later
// Leaves that meet during a step: against all pairs of leaves, and against triangles at sampled times of it.
#include <algorithm>
#include <array>
#include <limits>
#include <random>

#include <catch2/catch.hpp>

#include "cinch/collider.hpp"
#include "cinch/deform.hpp"
#include "cinch/refit.hpp"
#include "tests/support.hpp"

using namespace cinch;

namespace {

struct Body {
    test::Example example;
    Bvh bvh;
    std::array<std::vector<AffineMap>, 2> maps; // at both ends
    std::array<std::vector<Vec3>, 2> place;
    std::vector<double> supports;

    Body(std::size_t triangles, std::uint32_t nodes, const Vec3& from, const Vec3& to, int kdop, Precision precision)
        : example(test::example(triangles, nodes)), bvh(build_bvh(example.surface, 3))
    {
        std::array<std::vector<double>, 2> ends;
        for (std::size_t end = 0; end < 2; ++end) {
            maps[end] = example.frames[end + 1];
            for (AffineMap& map : maps[end])
                for (int r = 0; r < 3; ++r)
                    map.m[r][3] += (end ? to : from)[r];
            ends[end].resize(bvh.bvs.size() * static_cast<std::size_t>(kdop));
            refit(bvh, example.surface, maps[end], {Method::best, kdop, Rounding::proven, precision}, ends[end]);
            place[end].resize(example.surface.mesh.vertices.size());
            evaluate(example.surface.mesh.vertices, example.surface.weights, maps[end], place[end]);
        }
        supports.resize(ends[0].size());
        swept(ends[0], ends[1], supports);
    }
};

// Of every triangle at a part of the step, k supports each.
std::vector<double> dops_at(const Body& body, double tau, int kdop)
{
    std::vector<double> out;
    for (const Triangle& t : body.example.surface.mesh.triangles)
        for (const Axis& axis : axes_of(kdop)) {
            double most = -1e300, least = 1e300;
            for (const std::uint32_t v : t) {
                const Vec3 x = (1 - tau) * body.place[0][v] + tau * body.place[1][v];
                const double along = axis[0] * x[0] + axis[1] * x[1] + axis[2] * x[2];
                most = std::max(most, along);
                least = std::min(least, along);
            }
            out.insert(out.end(), {most, -least});
        }
    return out;
}

bool meet(std::span<const double> s, std::span<const double> t, double room)
{
    for (std::size_t d = 0; d < s.size(); ++d)
        if (s[d] < room - t[d ^ 1])
            return false;
    return true;
}

// Each BV's bound, and those of all BVs above it, which may be tighter.
std::vector<double> within_those_above(const Body& body, std::size_t k)
{
    std::vector<double> out(body.supports.begin(), body.supports.end());
    for (std::size_t i = 0; i < body.bvh.bvs.size(); ++i)
        if (!body.bvh.bvs[i].is_leaf())
            for (std::size_t d = 0; d < 2 * k; ++d) {
                double& child = out[body.bvh.bvs[i].first_child * k + d];
                child = std::min(child, out[i * k + d % k]);
            }
    return out;
}

std::vector<std::uint32_t> leaf_of_triangles(const Bvh& bvh)
{
    std::vector<std::uint32_t> out(bvh.triangle.size());
    for (std::uint32_t i = 0; i < bvh.bvs.size(); ++i)
        if (bvh.bvs[i].is_leaf())
            for (std::uint32_t t = 0; t < bvh.bvs[i].triangle_count; ++t)
                out[bvh.triangle[bvh.bvs[i].first_triangle + t]] = i;
    return out;
}

} // namespace

TEST_CASE("leaves that meet during a step are those of all pairs, and hold whatever touches at any time of it")
{
    for (const int kdop : {6, 18})
        for (const Precision precision : {Precision::float32, Precision::float64}) {
            // They pass each other: at both ends they are apart.
            const Body a(300, 12, Vec3(-4, 0, 0), Vec3(4, 0.3, 0), kdop, precision),
                b(200, 8, Vec3(4, 0.2, 0.1), Vec3(-4, 0, 0.2), kdop, precision),
                c(100, 5, Vec3(0, 40, 0), Vec3(0, 41, 0), kdop, precision);
            const SweptBody bodies[] = {{&a.bvh, a.supports}, {&b.bvh, b.supports}, {&c.bvh, c.supports}};
            const std::vector<LeafPair> found = swept_leaf_pairs(bodies, kdop);
            const auto k = static_cast<std::size_t>(kdop);
            const std::vector<double> inside[] = {within_those_above(a, k), within_those_above(b, k),
                                                  within_those_above(c, k)};
            std::vector<LeafPair> all, least;
            for (std::uint32_t p = 0; p < 3; ++p)
                for (std::uint32_t q = p + 1; q < 3; ++q)
                    for (std::uint32_t i = 0; i < bodies[p].bvh->bvs.size(); ++i)
                        for (std::uint32_t j = 0; j < bodies[q].bvh->bvs.size(); ++j) {
                            if (!bodies[p].bvh->bvs[i].is_leaf() || !bodies[q].bvh->bvs[j].is_leaf())
                                continue;
                            if (meet(std::span(bodies[p].supports).subspan(i * k, k),
                                     std::span(bodies[q].supports).subspan(j * k, k), 0))
                                all.push_back({p, i, q, j});
                            if (meet(std::span(inside[p]).subspan(i * k, k), std::span(inside[q]).subspan(j * k, k), 0))
                                least.push_back({p, i, q, j});
                        }
            CHECK(std::includes(all.begin(), all.end(), found.begin(), found.end()));
            CHECK(std::includes(found.begin(), found.end(), least.begin(), least.end()));
            CHECK(least.size() > 0.9 * static_cast<double>(all.size())); // so that neither says little
            CHECK(found.size() > 10);
            CHECK(std::none_of(found.begin(), found.end(), [](const LeafPair& x) { return x.body_b == 2; }));
            const auto leaf_a = leaf_of_triangles(a.bvh), leaf_b = leaf_of_triangles(b.bvh);
            std::size_t touching = 0;
            for (int step = 0; step <= 16; ++step) {
                const auto at_a = dops_at(a, step / 16.0, kdop), at_b = dops_at(b, step / 16.0, kdop);
                for (std::size_t s = 0; s < leaf_a.size(); ++s)
                    for (std::size_t t = 0; t < leaf_b.size(); ++t)
                        if (meet(std::span(at_a).subspan(s * k, k), std::span(at_b).subspan(t * k, k), 1e-9)) {
                            ++touching;
                            const LeafPair pair{0, leaf_a[s], 1, leaf_b[t]};
                            REQUIRE(std::binary_search(found.begin(), found.end(), pair));
                        }
            }
            CHECK(touching > 10);
        }
}

TEST_CASE("bounds over a step that do not fit are refused")
{
    const Body a(50, 4, Vec3(0, 0, 0), Vec3(1, 0, 0), 6, Precision::float32);
    const SweptBody good{&a.bvh, a.supports}, bad{&a.bvh, std::span(a.supports).first(6)};
    CHECK_THROWS_AS(swept_leaf_pairs(std::array{good, bad}), std::invalid_argument);
    CHECK_THROWS_AS(swept_leaf_pairs(std::array{good, good}, 18), std::invalid_argument);
    CHECK_THROWS_AS(swept_leaf_pairs(std::array{good, good}, 7), std::invalid_argument);
    CHECK(swept_leaf_pairs({}).empty());
    CHECK(swept_leaf_pairs(std::array{good}).empty());
    std::vector<double> out(6);
    CHECK_THROWS_AS(swept(a.supports, a.supports, out), std::invalid_argument);
}

TEST_CASE("a mesh without triangles meets nothing in a step")
{
    const test::Example e = test::example(100, 5);
    const Bvh bvh = build_bvh(e.surface, 4), none;
    const std::vector<double> anywhere(bvh.bvs.size() * 6, std::numeric_limits<double>::infinity());
    const SweptBody bodies[] = {{&none, {}}, {&bvh, anywhere}, {&none, {}}, {&bvh, anywhere}};
    for (const LeafPair& pair : swept_leaf_pairs(bodies))
        REQUIRE((pair.body_a == 1 && pair.body_b == 3));
}
