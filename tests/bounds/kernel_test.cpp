// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include "cinch/bounds.hpp"
#include "tests/support.hpp"
#include "toolkit/bounds/bound_box.hpp"
#include "toolkit/bounds/bound_moments.hpp"
#include "toolkit/bounds/kernel/bound_kernel.hpp"
#include "toolkit/bounds/readable.hpp"
#include "toolkit/deform/kernel/targets.hpp"
#include "toolkit/hierarchy/packed_bvh.hpp"
#include <algorithm>
#include <random>

using namespace cinch;

namespace {

constexpr Methods kinds = kernel_methods;

struct Scene {
    test::Example e =
        test::example(900, 70); // BVs of 5 to 70 simulation nodes, so blocks with and without repeated ones
    Bvh bvh = build_bvh(e.surface, 2);

    template <class T> std::vector<double> bounds(Method kind, int kdop, Rounding rounding, int passes,
                                                  bool remember = false, RestShape shape = RestShape::aabb) const
    {
        const PackedBvh<T> packed = pack<T>(bvh, e.surface, choose_kinds(bvh, e.surface, kind, shape));
        ProjectedMaps<T> maps;
        std::vector<T> remembered(remember ? 2 * packed.bvs.size() * static_cast<std::size_t>(kdop) : 0,
                                  std::numeric_limits<T>::quiet_NaN());
        KernelScratch<T> scratch;
        std::vector<double> all;
        for (const auto& frame : e.frames) {
            project<T>(frame, packed.rest, kdop, rounding, maps);
            std::vector<double> supports(bvh.bvs.size() * static_cast<std::size_t>(kdop));
            bound_packed<T>({packed.bvs, packed.node, packed.value, &maps, rounding, passes, nullptr,
                             remember ? remembered.data() : nullptr},
                            0, bvh.bvs.size(), scratch, supports);
            all.insert(all.end(), supports.begin(), supports.end());
        }
        return all;
    }
};

} // namespace

TEST_CASE("the same bits on every target of this machine")
{
    const Scene scene;
    const auto targets = kernel_targets();
    REQUIRE(targets.size() >= 1);
    CAPTURE(targets);
    struct Case {
        Method kind;
        int kdop;
        Rounding rounding;
        int passes;
    };
    std::vector<Case> cases;
    for (Method kind : kinds)
        for (int kdop : kdops)
            for (Rounding rounding : {Rounding::proven, Rounding::plain})
                for (int passes : {0, 1, 3}) {
                    cases.push_back({kind, kdop, rounding, passes});
                    if (passes == 1 && kind != Method::local && kind != Method::support && kind != Method::best)
                        break; // no passes; two rounds for the two shapes of boxes
                }
    std::ranges::shuffle(cases, std::mt19937(1)); // a share of them has some of everything
    for (const auto& [kind, kdop, rounding, passes] : test::share_of(cases)) {
        std::vector<std::vector<double>> single, twice;
        for (const std::string& target : targets) {
            REQUIRE(force_kernel_target(target));
            REQUIRE(kernel_target() == target);
            single.push_back(scene.bounds<float>(kind, kdop, rounding, passes, passes == 3));
            twice.push_back(scene.bounds<double>(kind, kdop, rounding, passes, passes == 3,
                                                 passes == 1 ? RestShape::obb : RestShape::aabb));
        }
        force_kernel_target("");
        INFO(name_of(kind) << ", k " << kdop << ", passes " << passes);
        for (std::size_t i = 1; i < targets.size(); ++i) {
            CHECK((single[i] == single[0]));
            CHECK((twice[i] == twice[0]));
        }
    }
    CHECK_FALSE(force_kernel_target("none such"));
    CHECK(kernel_target() == targets.front());
}

TEST_CASE("kernels agree with the readable form")
{
    const Scene scene;
    BoundScratch scratch;
    for (Method kind : ladder_methods)
        for (int kdop : {6, 26}) {
            const auto fast = scene.bounds<double>(kind, kdop, Rounding::proven, 1),
                       single = scene.bounds<float>(kind, kdop, Rounding::proven, 1);
            const auto k = static_cast<std::size_t>(kdop);
            std::vector<double> simple(k);
            std::size_t place = 0;
            for (const auto& frame : scene.e.frames)
                for (std::size_t bv = 0; bv < scene.bvh.bvs.size(); ++bv) {
                    bound_box(scene.bvh.rest(bv), frame, kind, Rounding::proven, axes_of(kdop), scratch, simple);
                    for (std::size_t d = 0; d < k; ++d, ++place) {
                        REQUIRE(fast[place] == Approx(simple[d]).margin(1e-13).epsilon(0));
                        REQUIRE(single[place] == Approx(simple[d]).margin(1e-4).epsilon(0));
                        REQUIRE(single[place] >= simple[d] - 1e-13);
                    }
                }
        }
}

// The kernels round what they read outward, and add their errors: never below the formula by more than its own
// rounding, and above it by some units of the last place of a vertex's distance. One that gave away 1 % of the width
// would be far off.
TEST_CASE("kernels agree with the formulas of the kinds beyond the ladder, and best is the least of its own")
{
    const Scene scene;
    const std::vector<Vec3>& x = scene.e.surface.mesh.vertices;
    const MomentData moments = rest_moments(scene.bvh, scene.e.surface);
    BoundScratch scratch;
    for (const int kdop : {6, 26}) {
        const auto k = static_cast<std::size_t>(kdop);
        std::vector<double> simple(k), also(k);
        const auto formula = [&](Method kind, std::size_t bv, const std::vector<AffineMap>& frame, double start,
                                 std::vector<double>& out) {
            if (kind == Method::moments)
                bound_moments(scene.bvh.rest(bv), moments.of(scene.bvh.bvs[bv], bv), frame, Rounding::plain,
                              axes_of(kdop), scratch, out, start);
            else
                readable_bound(kind, scene.bvh.rest(bv), x, frame, start, axes_of(kdop), out);
        };
        for (const Method method : kernel_methods.without(ladder_methods)) {
            const auto kinds_of = choose_kinds(scene.bvh, scene.e.surface, method);
            const auto fast = scene.bounds<double>(method, kdop, Rounding::proven, 1),
                       single = scene.bounds<float>(method, kdop, Rounding::proven, 1);
            std::size_t place = 0, equal = 0;
            for (const auto& frame : test::share_of(scene.e.frames))
                for (std::size_t bv = 0; bv < scene.bvh.bvs.size(); ++bv) {
                    const ChosenKind& kind = kinds_of.of[bv];
                    formula(kind.kind, bv, frame, kind.start, simple);
                    if (kind.also) {
                        formula(*kind.also, bv, frame, kind.also_start, also);
                        for (std::size_t d = 0; d < k; ++d)
                            simple[d] = std::min(simple[d], also[d]);
                    }
                    for (std::size_t d = 0; d < k; ++d, ++place) {
                        INFO(name_of(method) << ", BV " << bv << ", direction " << d << " of " << k);
                        REQUIRE(fast[place] <= simple[d] + 1e-10);
                        REQUIRE(single[place] <=
                                simple[d] + 2e-2 * (1 + std::abs(simple[d]))); // errors of up to 1e-3 of N_j
                        // A guard may bring best further down.
                        REQUIRE((kind.guarded || fast[place] >= simple[d] - 1e-13));
                        REQUIRE((kind.guarded || single[place] >= simple[d] - 1e-4)); // λ in float is another one
                        equal += fast[place] >= simple[d] - 1e-13;
                    }
                }
            CHECK(equal > place * 9 / 10);
        }
    }
}

TEST_CASE("the linear kind reproduces an affine motion of weights that are affine, up to the points' slack")
{
    // Two nodes whose weights go linearly from 0 to 1 along x: the field is quadratic only where the maps differ by a
    // rotation.
    DeformableSurface surface;
    for (std::uint32_t i = 0; i <= 8; ++i) {
        surface.mesh.vertices.emplace_back(i / 8.0, 0.25 * (i % 2), 0);
        surface.weights.node.insert(surface.weights.node.end(), {0, 1});
        surface.weights.weight.insert(surface.weights.weight.end(), {1 - i / 8.0, i / 8.0});
        surface.weights.row.push_back(2 * i + 2);
        if (i >= 2)
            surface.mesh.triangles.push_back({i - 2, i - 1, i});
    }
    surface.weights = to_dyadic({2, surface.weights.row, surface.weights.node, surface.weights.weight});
    const Bvh bvh = build_bvh(surface, 100);
    std::vector<AffineMap> maps{identity_map, identity_map};
    maps[1].m[0][3] = 2; // node 1 moves by 2 along x: vertex i to 3i/8
    const PackedBvh<double> packed = pack<double>(bvh, surface, choose_kinds(bvh, surface, Method::linear));
    ProjectedMaps<double> projected;
    project<double>(maps, packed.rest, 6, Rounding::proven, projected);
    KernelScratch<double> scratch;
    double supports[6];
    bound_packed<double>({packed.bvs, packed.node, packed.value, &projected}, 0, 1, scratch, supports);
    const double truth[6] = {3, 0, 0.25, 0, 0, 0};
    for (int d = 0; d < 6; ++d) {
        CHECK(supports[d] >= truth[d]);
        CHECK(supports[d] == Approx(truth[d]).margin(1e-12));
    }
}
