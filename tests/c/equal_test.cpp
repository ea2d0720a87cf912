// SPDX-License-Identifier: GPL-3.0-or-later
// What the library for C gives is what the C++ library gives, bit for bit.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cstring>
#include <random>

#include "cinch/collider.hpp"
#include "cinch/refit.hpp"
#include "tests/c/c_surface.hpp"

using namespace cinch;
using namespace cinch::test;

namespace {

template <class T> std::vector<double> numbers(const std::vector<T>& rows)
{
    std::vector<double> out(rows.size() * sizeof(T) / sizeof(double));
    if (!out.empty())
        std::memcpy(out.data(), rows.data(), out.size() * sizeof(double));
    return out;
}

bool same(const void* a, const void* b, std::size_t bytes) { return bytes == 0 || std::memcmp(a, b, bytes) == 0; }
bool same(const std::vector<double>& a, const std::vector<double>& b)
{
    return a.size() == b.size() && same(a.data(), b.data(), a.size() * sizeof(double));
}

// Of an example and of the same through C.
struct Both {
    DeformableSurface surface;
    std::vector<std::vector<AffineMap>> frames;
    std::vector<MorphTarget> targets;
    Handle<cinch_surface> handle;

    Both(std::size_t vertices, std::size_t nodes, bool displaced = false)
    {
        Example e = example(vertices, nodes);
        surface = std::move(e.surface);
        frames = std::move(e.frames);
        std::mt19937 random(7);
        for (std::size_t t = 0; displaced && t < 3; ++t) {
            MorphTarget target;
            for (std::uint32_t v = 0; v < surface.mesh.vertices.size(); v += 1 + random() % 5) {
                target.vertex.push_back(v);
                target.displacement.push_back(Vec3::Constant(static_cast<double>(random() % 100) / 1000));
            }
            targets.push_back(std::move(target));
        }
        handle = c_surface(surface, targets);
    }
    std::vector<double> maps() const
    {
        std::vector<double> all;
        for (const auto& frame : frames) {
            const std::vector<double> one = numbers(frame);
            all.insert(all.end(), one.begin(), one.end());
        }
        return all;
    }
};

Handle<cinch_bvh> c_bvh(const Both& both, std::size_t triangles, std::size_t vertices = 0,
                        std::int32_t detail = CINCH_DETAIL_ALL)
{
    Handle<cinch_bvh> bvh;
    REQUIRE(cinch_bvh_build(both.handle.get(), triangles, vertices, detail, bvh.out()) == CINCH_OK);
    return bvh;
}

} // namespace

TEST_CASE("a surface that went through C is the same one, and so are its vertices")
{
    const Both both(700, 40, true);
    cinch_surface_sizes sizes;
    REQUIRE(cinch_surface_get_sizes(both.handle.get(), &sizes) == CINCH_OK);
    const TriangleMesh& mesh = both.surface.mesh;
    CHECK(sizes.vertices == mesh.vertices.size());
    CHECK(sizes.nodes == 40);
    CHECK(sizes.targets == 3);
    CHECK(sizes.normalised == 0);

    std::vector<double> positions(3 * sizes.vertices), weight(sizes.weights);
    std::vector<std::uint32_t> triangles(3 * sizes.triangles), row(sizes.vertices + 1), node(sizes.weights);
    REQUIRE(cinch_surface_get_mesh(both.handle.get(), positions.data(), sizes.vertices, triangles.data(),
                                   sizes.triangles) == CINCH_OK);
    REQUIRE(cinch_surface_get_weights(both.handle.get(), row.data(), row.size(), node.data(), weight.data(),
                                      weight.size()) == CINCH_OK);
    CHECK(same(positions, numbers(mesh.vertices)));
    CHECK(same(triangles.data(), mesh.triangles.data(), 4 * triangles.size()));
    CHECK(row == both.surface.weights.row);
    CHECK(node == both.surface.weights.node);
    CHECK(same(weight, both.surface.weights.weight));

    const std::vector<double> by = {0.5, -1, 2};
    for (const bool displaced : {false, true}) {
        std::vector<Vec3> rest = mesh.vertices, truth(rest.size());
        if (displaced)
            displace(both.targets, by, rest);
        evaluate(rest, both.surface.weights, both.frames[1], truth);
        REQUIRE(cinch_surface_evaluate(both.handle.get(), both.frames[1][0].m[0], sizes.nodes, by.data(),
                                       displaced ? 3 : 0, positions.data(), sizes.vertices) == CINCH_OK);
        CHECK(same(positions, numbers(truth)));
    }
}

TEST_CASE("the arrays of both builders' trees are those of C++")
{
    const Both both(600, 30);
    for (const std::int32_t detail : {CINCH_DETAIL_ALL, CINCH_DETAIL_BOXES, CINCH_DETAIL_INNER})
        for (const std::size_t vertices : {0, 9}) {
            constexpr RestDetail details[] = {RestDetail::all, RestDetail::boxes, RestDetail::inner};
            const Bvh truth = vertices ? build_bvh(both.surface, ClusterSize{6, vertices}, details[detail])
                                       : build_bvh(both.surface, 6, details[detail]);
            const Handle<cinch_bvh> bvh = c_bvh(both, 6, vertices, detail);
            cinch_bvh_sizes sizes;
            REQUIRE(cinch_bvh_get_sizes(bvh.get(), &sizes) == CINCH_OK);
            CHECK(sizes.bytes == truth.bytes());
            std::vector<cinch_bv> bvs(sizes.bvs);
            std::vector<cinch_influence> influences(sizes.influences);
            REQUIRE(cinch_bvh_get_bvs(bvh.get(), bvs.data(), bvs.size()) == CINCH_OK);
            REQUIRE(cinch_bvh_get_influences(bvh.get(), influences.data(), influences.size()) == CINCH_OK);
            REQUIRE(bvs.size() == truth.bvs.size());
            REQUIRE(influences.size() == truth.node.size());
            for (std::size_t i = 0; i < bvs.size(); ++i) {
                const Bv& t = truth.bvs[i];
                REQUIRE(same(bvs[i].centre, &t.box, 48));
                REQUIRE(same(bvs[i].oriented_centre, &t.oriented, 96));
                REQUIRE(same(bvs[i].pivot, &t.pivot, 32));
                REQUIRE(same(&bvs[i].first_triangle, &t.first_triangle, 32));
            }
            for (std::size_t i = 0; i < influences.size(); ++i) {
                const cinch_influence& in = influences[i];
                REQUIRE((in.node == truth.node[i] && in.l == truth.l[i] && in.h == truth.h[i]));
                if (sizes.has_models) {
                    REQUIRE(same(in.centre, &truth.local[i], 48));
                    REQUIRE(in.radius == truth.radius[i]);
                    REQUIRE(same(&in.mean, &truth.model[i], 64));
                }
            }
            const std::vector<std::uint32_t>* const lists[] = {&truth.level, &truth.triangle, &truth.point};
            for (std::int32_t which = 0; which < 3; ++which) {
                std::vector<std::uint32_t> indices(lists[which]->size());
                REQUIRE(cinch_bvh_get_indices(bvh.get(), which, indices.data(), indices.size()) == CINCH_OK);
                CHECK(indices == *lists[which]);
            }
        }
}

TEST_CASE("refits by every method, k-DOP and arithmetic have the bits of C++, many frames in one call")
{
    const Both both(500, 25, true);
    const Bvh truth_bvh = build_bvh(both.surface, 5);
    const Handle<cinch_bvh> bvh = c_bvh(both, 5);
    std::vector<double> maps = both.maps();
    maps[both.frames.size() / 2 * 25 * 12 + 40] = NAN; // infinite supports as well
    std::vector<double> weights;
    for (std::size_t i = 0; i < 3 * both.frames.size(); ++i)
        weights.push_back(0.25 * static_cast<double>(i));
    for (const Method method : all_methods)
        for (const int k : kdops)
            for (const int choice : {0, 1, 2, 3}) {
                cinch_refit_options options{};
                options.methods = 1u << static_cast<unsigned>(method) | (choice == 3 ? CINCH_METHOD_EQ12 : 0u);
                options.kdop = k;
                options.float64 = choice & 1;
                options.oriented = choice >> 1;
                options.passes = choice;
                options.remember = choice == 2;
                options.plain = choice == 1;
                RefitOptions same_options;
                same_options.methods = choice == 3 ? method | Method::eq12 : Methods(method);
                same_options.kdop = k;
                same_options.precision = choice & 1 ? Precision::float64 : Precision::float32;
                same_options.rest_shape = choice >> 1 ? RestShape::obb : RestShape::aabb;
                same_options.passes = choice ? choice : 1;
                same_options.remember = choice == 2;
                same_options.rounding = choice == 1 ? Rounding::plain : Rounding::proven;
                Refitter refit(truth_bvh, both.surface, same_options, both.targets);
                Handle<cinch_refitter> refitter;
                REQUIRE(cinch_refitter_new(bvh.get(), &options, refitter.out()) == CINCH_OK);
                const std::size_t frames = both.frames.size(), bvs = truth_bvh.bvs.size(),
                                  size = bvs * static_cast<std::size_t>(k);
                std::vector<double> out(frames * size), truth(size);
                std::vector<cinch_refit_report> reports(frames);
                REQUIRE(cinch_refitter_refit(refitter.get(), frames, maps.data(), frames * 25, weights.data(),
                                             choice ? weights.size() : 0, out.data(), frames * bvs,
                                             reports.data()) == CINCH_OK);
                for (std::size_t f = 0; f < frames; ++f) {
                    std::vector<AffineMap> moved(25);
                    std::memcpy(moved.data(), &maps[f * 25 * 12], 25 * sizeof(AffineMap));
                    const RefitReport report =
                        refit(moved, std::span(weights).subspan(choice ? 3 * f : 0, choice ? 3 : 0), truth);
                    REQUIRE(same(truth.data(), &out[f * size], 8 * size));
                    REQUIRE(reports[f].unbounded_nodes == report.unbounded_nodes);
                    REQUIRE(reports[f].infinite == report.infinite);
                    std::vector<double> boxes(6 * bvs);
                    REQUIRE(cinch_boxes_of(truth.data(), k, boxes.data(), bvs) == CINCH_OK);
                    const Aabb root = Dop(std::span(truth).first(static_cast<std::size_t>(k))).aabb();
                    REQUIRE(same(boxes.data(), &root, sizeof root));
                }
            }
}

TEST_CASE("boxes of a crowd have the bits of C++")
{
    const Both both(500, 25);
    const Bvh bvh = build_bvh(both.surface, 5);
    for (const int level : {0, 3}) {
        const cinch_crowd_options options{level, level == 3};
        const CrowdRefitter crowd(bvh, both.surface, {level, level == 3 ? Rounding::plain : Rounding::proven});
        Handle<cinch_crowd> c_crowd;
        REQUIRE(cinch_crowd_new(c_bvh(both, 5).get(), &options, c_crowd.out()) == CINCH_OK); // the tree is freed then
        std::vector<std::uint32_t> bvs(100);
        std::size_t count = 0;
        REQUIRE(cinch_crowd_get_bvs(c_crowd.get(), bvs.data(), bvs.size(), &count) == CINCH_OK);
        bvs.resize(count);
        CHECK(bvs == crowd.bvs());
        const std::vector<double> maps = both.maps();
        std::vector<Aabb> truth(both.frames.size() * count);
        std::vector<double> boxes(6 * truth.size());
        std::vector<AffineMap> all(maps.size() / 12);
        std::memcpy(all.data(), maps.data(), 8 * maps.size());
        crowd(all, truth);
        REQUIRE(cinch_crowd_refit(c_crowd.get(), maps.data(), all.size(), boxes.data(), truth.size()) == CINCH_OK);
        CHECK(same(boxes, numbers(truth)));
    }
}

TEST_CASE("bounds over a step and the pairs of leaves that may touch in it are those of C++")
{
    const Both both(500, 25);
    const Bvh bvh = build_bvh(both.surface, 5);
    const Handle<cinch_bvh> c_tree = c_bvh(both, 5);
    std::vector<double> first(6 * bvh.bvs.size()), last = first, over = first, c_over = first;
    refit(bvh, both.surface, both.frames[0], {}, first);
    refit(bvh, both.surface, both.frames[1], {}, last);
    swept(first, last, over);
    REQUIRE(cinch_swept(first.data(), last.data(), c_over.data(), first.size()) == CINCH_OK);
    CHECK(same(over, c_over));
    const SweptBody bodies[] = {{&bvh, over}, {&bvh, last}};
    const cinch_swept_body c_bodies[] = {{c_tree.get(), over.data(), bvh.bvs.size()},
                                         {c_tree.get(), last.data(), bvh.bvs.size()}};
    const std::vector<LeafPair> truth = swept_leaf_pairs(bodies);
    REQUIRE(truth.size() > 100);
    std::size_t count = 0;
    REQUIRE(cinch_swept_leaf_pairs(c_bodies, 2, 6, nullptr, 0, &count) == CINCH_OK);
    REQUIRE(count == truth.size());
    std::vector<std::uint32_t> pairs(4 * count, 77);
    REQUIRE(cinch_swept_leaf_pairs(c_bodies, 2, 6, pairs.data(), count - 1, &count) == CINCH_OK);
    CHECK(pairs.back() == 77);
    CHECK(same(pairs.data(), truth.data(), 16 * (count - 1)));
}
