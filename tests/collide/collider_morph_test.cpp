// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies with morph targets: their pairs are those of the displaced vertices.
#include <catch2/catch.hpp>

#include "tests/collide/random_bodies.hpp"
#include "tests/support.hpp"

using namespace cinch;

namespace {

std::vector<MorphTarget> targets_of(test::Dice& dice, const DeformableSurface& surface, std::size_t count)
{
    std::vector<MorphTarget> targets(count);
    for (MorphTarget& target : targets)
        for (std::uint32_t v = 0; v < surface.mesh.vertices.size(); ++v)
            if (dice.below(3) == 0) {
                target.vertex.push_back(v);
                target.displacement.push_back(0.4 * dice.point());
            }
    return targets;
}

// By evaluate_vertex, of rest vertices displaced here, target after target.
test::Positions placed(const DeformableSurface& surface, const std::vector<MorphTarget>& targets,
                       const std::vector<double>& weights, const std::vector<AffineMap>& maps)
{
    std::vector<Vec3> rest = surface.mesh.vertices;
    for (std::size_t i = 0; i < targets.size(); ++i)
        for (std::size_t n = 0; n < targets[i].vertex.size(); ++n)
            rest[targets[i].vertex[n]] += weights[i] * targets[i].displacement[n];
    test::Positions out;
    for (std::size_t v = 0; v < rest.size(); ++v)
        out.push_back(evaluate_vertex(rest[v], surface.weights.of(v), maps));
    return out;
}

} // namespace

TEST_CASE("the pairs of bodies with morph targets are those of their displaced vertices")
{
    test::Dice dice(11);
    std::size_t found = 0, other = 0;
    for (int round = 0; round < 4; ++round) {
        const DeformableSurface face = test::patchy(dice, ring_sphere(400), 5, 3),
                                plain = test::patchy(dice, ring_sphere(150), 3, 2);
        const std::vector<MorphTarget> targets = targets_of(dice, face, 6);
        LazyOptions options;
        options.methods = round % 2 ? Methods(Method::eq12) : Methods(Method::best);
        options.kdop = round < 2 ? 6 : 26;
        Collider collider(options);
        collider.add(face, targets);
        collider.add(plain);
        for (int frame = 0; frame < 6; ++frame) {
            const auto maps = test::around(dice, 5, dice.rotation(), 0.1 * dice.point(), 0.05);
            const auto others = test::around(dice, 3, dice.rotation(), Vec3(1.5, 0, 0), 0.05);
            std::vector<double> weights(targets.size(), 0.0);
            if (frame % 3) // where all are 0 the tree is brought up to date as without any
                for (double& w : weights)
                    w = 1.5 * dice.symmetric();
            collider.update(std::vector<BodyFrame>{{maps, {}, weights}, {others}});
            const auto truth = test::brute_force(
                {&face, &plain}, {placed(face, targets, weights, maps), test::positions_of(plain, {others})});
            const auto pairs = test::sorted(collider.pairs());
            INFO("round " << round << ", frame " << frame << ": " << test::difference(truth, pairs));
            REQUIRE(pairs == truth);
            found += truth.size();
            std::vector<double> none(targets.size(), 0.0);
            collider.update(std::vector<BodyFrame>{{maps, {}, none}, {others}});
            other += test::sorted(collider.pairs()) != truth;
        }
    }
    CHECK(found > 100);
    CHECK(other > 8); // the weights count
}

TEST_CASE("weights that do not fit, and displacements that are no numbers")
{
    test::Dice dice(5);
    const DeformableSurface face = test::patchy(dice, ring_sphere(150), 3, 2);
    const std::vector<MorphTarget> targets = targets_of(dice, face, 2);
    Collider collider;
    collider.add(face, targets);
    const auto maps = test::around(dice, 3, Eigen::Matrix3d::Identity(), Vec3::Zero(), 0);
    const std::vector<double> two{0.5, 0.5}, one{0.5}, huge{1e308, 1e308};
    CHECK_THROWS_AS(collider.update(std::vector<BodyFrame>{{maps}}), std::invalid_argument);
    CHECK_THROWS_AS(collider.update(std::vector<BodyFrame>{{maps, {}, one}}), std::invalid_argument);
    CHECK_THROWS_AS(collider.update(std::vector<BodyFrame>{{std::span(maps).first(2), {}, two}}),
                    std::invalid_argument);
    CHECK_NOTHROW(collider.update(std::vector<BodyFrame>{{maps, {}, two}}));
    CHECK(collider.unknown().empty());
    auto broken = maps;
    broken[0].m[0][0] = 1e308;
    collider.update(std::vector<BodyFrame>{{broken, {}, huge}});
    CHECK(collider.unknown() == std::vector<BodyId>{0});
    collider.update(std::vector<BodyFrame>{{maps, face.mesh.vertices}}); // positions are all there is to know
    CHECK(collider.unknown().empty());
    Collider without;
    without.add(face);
    CHECK_THROWS_AS(without.update(std::vector<BodyFrame>{{maps, {}, two}}), std::invalid_argument);
}
