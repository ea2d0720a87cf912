// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include "cinch/surface.hpp"
#include "toolkit/surface/skin.hpp"

using namespace cinch;

TEST_CASE("weights as text load")
{
    const Influences w = parse_weights_text("2 3\n2 2 0.25 0 0.5\n1 1 1\n", "w", 2);
    CHECK(w.node_count == 3);
    CHECK(w.row == std::vector<std::uint32_t>{0, 2, 3});
    CHECK(w.node == std::vector<std::uint32_t>{0, 2, 1});
    CHECK(w.weight == std::vector<double>{0.5, 0.25, 1});
}

TEST_CASE("clips as text load")
{
    const std::vector<Clip> clips =
        parse_clips_text("1\nwalk 2 1\n0 1 0 0 0 0 1 0 0 0 0 1 0\n0.5 1 0 0 7 0 1 0 0 0 0 1 0\n", "t", 1);
    REQUIRE(clips.size() == 1);
    CHECK(clips[0].name == "walk");
    REQUIRE(clips[0].frame_count() == 2);
    CHECK(clips[0].time_s(0) == 0);
    CHECK(clips[0].time_s(1) == 0.5);
    CHECK(clips[0].frame(1)[0].m[0][3] == 7);
}

TEST_CASE("bad weights and clips are refused with the line")
{
    auto weights = [](const char* text) { parse_weights_text(text, "w.txt", 2); };
    CHECK_THROWS_WITH(weights("3 2\n"), Catch::Contains("w.txt:1: declares 3 vertices, but the mesh has 2"));
    CHECK_THROWS_WITH(weights("2 2\n1 0 1\n1 2 1\n"),
                      Catch::Contains("w.txt:3: node index 2 of vertex 1 is out of range"));
    CHECK_THROWS_WITH(weights("2 2\n1 0 1\n1 1 -1\n"), Catch::Contains("w.txt:3: vertex 1 has a negative weight"));
    CHECK_THROWS_WITH(weights("2 2\n2 1 1 1 1\n1 1 1\n"), Catch::Contains("w.txt:2: vertex 0 names node 1 twice"));
    CHECK_THROWS_WITH(weights("2 2\n1 0 nan\n"), Catch::Contains("w.txt:2: a weight 'nan' is not finite"));
    CHECK_THROWS_WITH(weights("2 2\n1 0 1\n"), Catch::Contains("the file ends"));
    CHECK_THROWS_WITH(weights("2 2\n1 0 1\n1 0 1\n1 0 1\n"), Catch::Contains("w.txt:4: more lines"));
    CHECK_THROWS_WITH(weights("2 2\n0\n1 0 1\n"), Catch::Contains("w.txt:2: the number of influences is 0"));
    auto clips = [](const char* text) { parse_clips_text(text, "t.txt", 1); };
    CHECK_THROWS_WITH(clips("1\nwalk 1 2\n"), Catch::Contains("t.txt:2: declares 2 nodes, but the weights have 1"));
    CHECK_THROWS_WITH(clips("1\nwalk 1 1\n0 1 0 0 0 0 1 0 0 0 0 1\n"), Catch::Contains("the file ends"));
    CHECK_THROWS_WITH(clips("1\nwalk 1 1\n0 1 0 0 0 0 1 0 0 0 0 1 inf\n"),
                      Catch::Contains("t.txt:3: a matrix entry 'inf' is not finite"));
    CHECK_THROWS_WITH(clips("1\nwalk 2000000000 1\n"), Catch::Contains("the file ends"));
}
