// SPDX-License-Identifier: GPL-3.0-or-later
#include <random>

#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include "cinch/deform.hpp"
#include "tests/surface/gltf_example.hpp"

using namespace cinch;
using namespace cinch::test;

TEST_CASE("a clip makes the frames that are asked for, and no others")
{
    std::vector<std::size_t> made;
    const Clip clip(
        "long", 1'000'000'000'000, [](std::size_t i) { return 0.5 * static_cast<double>(i); },
        [&](std::size_t i) {
            made.push_back(i);
            Clip::Frame maps(1, identity_map);
            maps[0].m[0][3] = static_cast<double>(i);
            return maps;
        });
    const Clip three = evenly_spread(clip, 3);
    CHECK(made.empty());
    REQUIRE(three.frame_count() == 3);
    CHECK(three.time_s(2) == 0.5 * 999'999'999'999.0);
    CHECK(three.frame(1)[0].m[0][3] == 499'999'999'999.0 + 1); // the nearest to the middle, upwards
    CHECK(three.frame(0)[0].m[0][3] == 0);
    CHECK(made == std::vector<std::size_t>{500'000'000'000, 0});
    CHECK(three.name == "long");
    CHECK_THROWS_AS(three.frame(3), std::out_of_range);
    CHECK_THROWS_AS(three.time_s(3), std::out_of_range);
    CHECK(evenly_spread(clip, 100000).time_s(99999) == 0.5 * 999'999'999'999.0);
}

TEST_CASE("frames of a clip are chosen evenly, the last one included")
{
    auto frames = [](std::size_t all) {
        std::vector<double> times;
        for (std::size_t i = 0; i < all; ++i)
            times.push_back(static_cast<double>(i));
        return Clip("c", times, std::vector<Clip::Frame>(all, Clip::Frame(1, identity_map)));
    };
    for (std::size_t all = 1; all < 20; ++all)
        for (std::size_t wanted = 0; wanted < 25; ++wanted) {
            const Clip chosen = evenly_spread(frames(all), wanted);
            REQUIRE(chosen.frame_count() == (wanted == 0 ? all : std::min(all, wanted)));
            CHECK(chosen.time_s(chosen.frame_count() - 1) == static_cast<double>(all - 1));
            if (chosen.frame_count() > 1)
                CHECK(chosen.time_s(0) == 0);
            for (std::size_t i = 1; i < chosen.frame_count(); ++i)
                CHECK(chosen.time_s(i) > chosen.time_s(i - 1));
        }
    CHECK_THROWS_AS(Clip("c", {0, 1}, {Clip::Frame(1, identity_map)}), std::invalid_argument);
    CHECK(Clip().frame_count() == 0);
}

TEST_CASE("a node with a matrix that is animated moves as its translation, rotation and scale do")
{
    std::mt19937 random(2);
    auto uniform = [&](double low, double high) { return std::uniform_real_distribution<>(low, high)(random); };
    for (std::size_t i = 0; i < share_of(300); ++i) {
        Eigen::Quaterniond q(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
        q.normalize();
        const Vec3 t(uniform(-5, 5), uniform(-5, 5), uniform(-5, 5)),
            s(uniform(0.1, 10), uniform(0.1, 10), uniform(0.1, 10));
        Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
        m.topLeftCorner<3, 3>() = q.toRotationMatrix() * s.asDiagonal();
        m.topRightCorner<3, 1>() = t;
        const char* path = i % 3 == 0 ? "translation" : i % 3 == 1 ? "rotation" : "scale";
        Document apart = triangle(), matrix = triangle();
        apart.root["nodes"][1] = {{"translation", {t[0], t[1], t[2]}},
                                  {"rotation", {q.x(), q.y(), q.z(), q.w()}},
                                  {"scale", {s[0], s[1], s[2]}}};
        std::vector<float> columns;
        for (int k = 0; k < 16; ++k)
            columns.push_back(static_cast<float>(m.data()[k]));
        matrix.root["nodes"][1] = {{"matrix", columns}};
        for (Document* d : {&apart, &matrix})
            d->animate("a", path, "LINEAR", {0, 1},
                       i % 3 == 1 ? std::vector<float>{0, 0, 0, 1, 0.6f, 0, 0, 0.8f}
                                  : std::vector<float>{1, 2, 3, 3, 2, 2},
                       i % 3 == 1 ? 4 : 3);
        const Character a = apart.parse(), b = matrix.parse();
        for (const double time : {0.0, 0.5, 1.0})
            for (int axis = 0; axis < 3; ++axis) {
                CHECK(box_at(a, a.animations[0], time).low[axis] ==
                      Approx(box_at(b, b.animations[0], time).low[axis]).margin(1e-4));
                CHECK(box_at(a, a.animations[0], time).high[axis] ==
                      Approx(box_at(b, b.animations[0], time).high[axis]).margin(1e-4));
            }
    }
    for (const auto& [entry, value] : {std::pair(4, 0.5), {0, -1.0}, {10, 0.0}}) { // a shear, a mirror, a scale of 0
        Document d = triangle();
        std::vector<double> m{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 1, 0, 1};
        m[static_cast<std::size_t>(entry)] = value;
        d.root["nodes"][1] = {{"matrix", m}};
        CHECK(refusal(d.text()) == ""); // at rest it is a matrix like any other
        d.animate("a", "scale", "LINEAR", {0, 1}, {1, 1, 1, 2, 2, 2}, 3);
        CHECK_THAT(
            refusal(d.text()),
            Catch::Contains("the animation of a node whose matrix is no translation, rotation and scale (nodes[1])"));
    }
    Document d = triangle();
    d.root["nodes"][1] = {{"matrix", {1, 0, 0, 0.1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 1, 0, 1}}};
    CHECK_THAT(refusal(d.text()), Catch::Contains("last row is not (0, 0, 0, 1)"));
}
