// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include <catch2/catch.hpp>

#include "tests/support.hpp"
#include "toolkit/surface/read_mesh.hpp"

using namespace cinch;

namespace {

void check_refused(const std::string& arguments, const std::string& reason)
{
    INFO(arguments);
    const test::Run run = test::cinch(arguments);
    CHECK(run.status == 2);
    CHECK(run.out.empty());
    CHECK_THAT(run.err, Catch::StartsWith("cinch: ") && Catch::Contains(reason));
    CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
}

} // namespace

TEST_CASE("help and version")
{
    const test::Run help = test::cinch("verify --help");
    CHECK(help.status == 0);
    CHECK_THAT(help.out, Catch::Contains("Examples:") && Catch::Contains("--weights") && Catch::Contains("'V J'"));
    CHECK(test::cinch("--help").status == 0);
    const test::Run version = test::cinch("--version");
    CHECK(version.status == 0);
    CHECK_THAT(version.out, Catch::StartsWith("cinch "));
}

TEST_CASE("help of a command by either way, and what a typo may have meant")
{
    CHECK(test::cinch("help verify").out == test::cinch("verify --help").out);
    CHECK(test::cinch("help").out == test::cinch("--help").out);
    check_refused("help verfy", "unknown command 'verfy'; did you mean 'verify'?");
    check_refused("help verify fuzz", "takes one command");
    check_refused("colide", "did you mean 'collide'? (see 'cinch --help')");
    check_refused("verify --framse 3", "did you mean '--frames'? (see 'cinch verify --help')");
    CHECK(test::cinch("qwertyuiop").err.find("did you mean") == std::string::npos);
    CHECK(test::cinch("verify --qwertyuiop").err.find("did you mean") == std::string::npos);
}

TEST_CASE("pictures are of three kinds, and several inputs, nodes or seeds are a study")
{
    const test::TemporaryFolder folder;
    const std::string base = (folder.path() / "chart").string();
    check_refused("tightness fish --plot " + base + ".gif", ".svg, .pdf or .png");
    const std::string lists =
        "tightness fish-8000 santa --nodes 8,12 --seed 1-2 --frames 1 --leaf 512 --methods eq12 --motion mild";
    const test::Run run = test::cinch(lists + " --json --plot " + base + ".pdf --plot-data " + base + ".csv");
    REQUIRE(run.status == 0);
    CHECK(read_bytes(base + ".pdf").starts_with("%PDF-"));
    const std::string data = read_bytes(base + ".csv");
    CHECK(data.starts_with("chart,series,x,y,low,high\n"));
    CHECK(std::count(data.begin(), data.end(), '\n') == 1 + 2 * 2);
    for (const char* other : {"--sweep 8", "--weights w.txt", "--body b"})
        check_refused(lists + " " + other, "goes with one INPUT, one number of --nodes and one --seed");
    check_refused("tightness fish --nodes 0", "--nodes");
    check_refused("tightness fish --seed 5-1", "--seed: expected whole numbers as 7, 1-20 or 16..512");
}

TEST_CASE("numbers that are none, or out of range, are refused")
{
    for (const std::string option : {"verify --support", "scaling --seconds", "simulate pile --step",
                                     "simulate pile --duration", "cost --seconds", "cost --duration", "fuzz --seconds"})
        for (const char* value : {"nan", "inf", "-1", "1e400", "two"})
            check_refused(option + " " + value, option.substr(option.find("--")));
}

TEST_CASE("bad usage exits 2 with one line")
{
    check_refused("", "no command given");
    check_refused("verfiy", "verfiy");
    check_refused("verify --kdop 8", "--kdop");
    check_refused("verify --method quick", "--method: expected one or more, joined by '+', of convex, sphere, ");
    check_refused("verify --frames 0", "--frames");
    check_refused("verify --leaf none", "--leaf");
    check_refused("verify --unknown", "--unknown");
    check_refused("verify brains", "no such file, and no shape");
    check_refused("verify brain --motion wiggle", "known are strong, mild");
    check_refused("verify brain --clip Walk", "--clip needs");
    check_refused("verify brain --fps 30", "--fps needs");
    check_refused("verify brain --weights w.txt", "--weights and --transforms need a mesh file");
}

TEST_CASE("bad input exits 2 with one line: file, place, reason")
{
    const test::TemporaryFolder folder;
    const std::string at = folder.path().string() + "/";
    folder.write("bad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 nan\nf 1 2 3\n");
    check_refused("verify " + at + "bad.obj", at + "bad.obj:3: a coordinate 'nan' is not finite");
    folder.write("empty.ply", "");
    check_refused("verify " + at + "empty.ply", "the file is empty");
    folder.write("points.off", "OFF\n1 0 0\n0 0 0\n");
    check_refused("verify " + at + "points.off", "no triangles");
    check_refused("verify " + at, "unknown format");
    folder.write("a.glb", "glTF");
    check_refused("verify " + at + "a.glb", "ends within its header");
    folder.write("ok.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    folder.write("w.txt", "4 1\n1 0 1\n");
    check_refused("verify " + at + "ok.off --weights " + at + "w.txt", "go together");
    check_refused("verify " + at + "ok.off --weights " + at + "w.txt --transforms " + at + "t.txt",
                  "declares 4 vertices, but the mesh has 3");
    check_refused("verify " + at + "ok.off --nodes 5 --weights " + at + "w.txt --transforms " + at + "t.txt",
                  "--nodes needs");
}
