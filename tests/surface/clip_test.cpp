// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include "cinch/deform.hpp"

using namespace cinch;

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
