// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "experiments/verify_rows.hpp"
#include "tests/support.hpp"

using namespace cinch;
using nlohmann::json;

namespace {

json summary(const test::Run& run)
{
    json last;
    for (const std::string& line : run.lines()) {
        last = json::parse(line);
        CHECK(last["experiment"] == "verify");
    }
    return last;
}

} // namespace

TEST_CASE("verify proves a shape and says so in JSON Lines")
{
    const test::Run run = test::cinch("verify brain-3500 --frames 2 --kdop 14 --leaf 4 --json");
    CHECK(run.status == 0);
    CHECK(run.err.empty());
    const json s = summary(run);
    CHECK(s["bounds"] == s["proven"]);
    CHECK(s["violated"] == 0);
    CHECK(s["frames"] == 2);
    CHECK(s["frames_done"] == 2);
    CHECK(s["kdop"] == 14);
    CHECK(s["ladder_broken"] == 0);
    CHECK(s["default_compared"] == s["bounds"]);
    CHECK(s["default_clearly_above_eq12"] == 0);
    CHECK(s["complete"] == true);
    CHECK(s["filter_hit_rate"] > 0.95);
    for (const char* field :
         {"input", "method", "seconds", "version", "commit", "compiler", "flags", "cpu", "simd_target", "seed"})
        CHECK(s.contains(field));
    std::size_t bounds = 0;
    for (const std::string& line : run.lines()) {
        const json record = json::parse(line);
        if (!record.contains("level"))
            continue;
        bounds += record["proven"].get<std::size_t>();
        for (const char* field :
             {"bvs", "mean_n", "mean_ratio", "max_ratio", "box_loss", "interval_loss", "corner_loss", "rounding_loss"})
            CHECK(record[field].is_number());
    }
    CHECK(bounds == s["bounds"]);
}

TEST_CASE("oriented boxes with reflected and exchanged axes are proven")
{
    for (const char* name : {"F01_oriented_box_sign.obj", "F01_oriented_box_sign_skinned.gltf"})
        for (const char* k : {"6", "14", "18", "26"}) {
            const test::Run run = test::cinch(std::string("verify " CINCH_REPORTS "/") + name +
                                              " --rest obb --method limited --json --kdop " + k);
            CHECK(run.status == 0);
            CHECK(summary(run)["violated"] == 0);
        }
}

TEST_CASE("where two joints turn against each other, the default is not looser than Eq. 12")
{
    double ratio[2];
    for (int i = 0; i < 2; ++i) {
        const test::Run run =
            test::cinch(std::string("verify " CINCH_REPORTS "/F15_best_looser_than_eq12.gltf --json --method ") +
                        (i ? "eq12" : "best"));
        CHECK(run.status == 0);
        ratio[i] = json::parse(run.lines().front())["mean_ratio"];
        CHECK(summary(run)["default_compared"] == (i ? json(0) : summary(run)["bounds"]));
    }
    CHECK(ratio[0] <= ratio[1] * 1.001);
    CHECK(ratio[1] < 1.001);
    CHECK_THAT(test::cinch("verify " CINCH_REPORTS "/F15_best_looser_than_eq12.gltf").out,
               Catch::Contains("default above eq12 in ") && Catch::Contains(", by over 1 % of its width in none\n"));
}

TEST_CASE("every method is proven on the table too, and verdict and order are stated")
{
    for (const char* method :
         {"convex", "sphere", "corners --leaf 16", "eq12", "limited", "local --passes 3", "support --remember",
          "linear --precision double", "best", "vertices", "support+linear"}) {
        const test::Run run = test::cinch(std::string("verify santa --frames 2 --method ") + method);
        CHECK(run.status == 0);
        CHECK_THAT(run.out, Catch::Contains(" bounds, ") && Catch::Contains(" proven, 0 violated\n") &&
                                Catch::Contains("limited <= eq12 <= convex in all of"));
    }
}

TEST_CASE("the same seed gives the same records, whatever the thread count, and another seed others")
{
    auto records = [](const std::string& options) {
        json all;
        for (const std::string& line :
             test::cinch("verify fish --frames 1 --nodes 40 --leaf 8 --json " + options).lines()) {
            json record = json::parse(line);
            for (const char* field : {"command", "seconds", "threads", "seed"})
                record.erase(field);
            all.push_back(record);
        }
        return all;
    };
    const json one = records("--threads 1");
    CHECK(one == records("--threads 2"));
    CHECK(one != records("--seed 5"));
}

TEST_CASE("the BVs that stand after a collision query are proven, merged ones included, in float and in double")
{
    for (const char* options : {"santa-ring-1 --frames 12", "santa-ring-1 --frames 12 --precision double",
                                "santa-ring-6 --frames 4 --kdop 18 --method eq12 --leaf 1",
                                "santa-ring-5 --frames 4 --kdop 14 --rest obb --method limited --leaf 8"}) {
        INFO(options);
        const test::Run run = test::cinch(std::string("verify --update lazy --json ") + options);
        CHECK(run.status == 0);
        const json s = summary(run);
        CHECK(s["bounds"] == s["proven"]);
        CHECK(s["violated"] == 0);
        CHECK(s["infinite"] == 0);
        for (const char* kind : {"by_methods", "merged", "from_vertices", "left", "pairs"})
            CHECK(s[kind] > 0);
        CHECK(s["bounds"] ==
              s["kdop"].get<std::size_t>() * (s["by_methods"].get<std::size_t>() + s["merged"].get<std::size_t>() +
                                              s["from_vertices"].get<std::size_t>()));
    }
    const json full = summary(test::cinch("verify fishes --update full --frames 2 --json"));
    CHECK(full["bounds"] == full["proven"]);
    CHECK(full["by_methods"] == 0);
    CHECK(full["left"] == 0);
    const json front = summary(test::cinch("verify santa-ring-5 --update front --frames 3 --json"));
    CHECK(front["bounds"] == front["proven"]);
    CHECK(front["merged"] == 0);
}

TEST_CASE("mutation: bounds of the frame before, and damaged rest data, are found after a collision query too")
{
    for (const char* kind : {"stale", "lower-h", "swap-interval"}) {
        INFO(kind);
        const test::Run run =
            test::cinch(std::string("verify santa-ring-1 --update lazy --frames 3 --json --sabotage ") + kind);
        CHECK(run.status == 1);
        CHECK(summary(run)["violated"] > 0);
    }
}

TEST_CASE("what does not go with a collision query is refused")
{
    for (const char* options :
         {"brain --update lazy", "santa-ring-1 --body santa-1 --update lazy", "santa-ring-1 --update lazy --leaf 17",
          "santa-ring-1 --update full --volume", "santa-ring-1 --update lazy --sabotage no-rounding",
          "santa-ring-1 --sabotage stale", "santa-ring-1 --update eager"}) {
        INFO(options);
        const test::Run run = test::cinch(std::string("verify --frames 2 ") + options);
        CHECK(run.status == 2);
        CHECK(run.out.empty());
        CHECK(run.err.starts_with("cinch: "));
    }
}

TEST_CASE("mutation: sabotaged bounds are reported and exit 1")
{
    for (const char* kind : {"no-rounding", "swap-interval", "lower-h"}) {
        INFO(kind);
        const test::Run run =
            test::cinch(std::string("verify brain-3500 --nodes 60 --frames 2 --json --sabotage ") + kind);
        CHECK(run.status == 1);
        const json s = summary(run);
        CHECK(s["violated"] > 0);
        const test::Run table = test::cinch(std::string("verify brain-3500 --nodes 60 --frames 2 --sabotage ") + kind);
        CHECK(table.status == 1);
        CHECK_THAT(table.out,
                   Catch::Contains("violated: frame 0, level 0, BV 0") || Catch::Contains("violated: frame"));
    }
}

TEST_CASE("a mesh with weights and transforms of one's own")
{
    const test::TemporaryFolder folder;
    const std::string at = folder.path().string() + "/";
    folder.write("m.off", "OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n3 0 1 2\n3 1 3 2\n");
    folder.write("w.txt", "4 2\n1 0 1\n2 0 0.25 1 0.25\n2 1 1 0 3\n1 1 0\n");
    folder.write("t.txt", "2\nstill 1 2\n0 1 0 0 0 0 1 0 0 0 0 1 0 1 0 0 0 0 1 0 0 0 0 1 0\n"
                          "move 2 2\n0 1 0 0 0 0 1 0 0 0 0 1 0 1 0 0 0 0 1 0 0 0 0 1 0\n0.5 0 -1 0 0 1 0 0 0 0 0 1 0 1 "
                          "0 0 5 0 1 0 0 0 0 1 0\n");
    const test::Run run = test::cinch("verify " + at + "m.off --weights " + at + "w.txt --transforms " + at +
                                      "t.txt --clip move --kdop 26");
    CHECK(run.status == 0);
    CHECK_THAT(run.out, Catch::Contains("2 simulation nodes") && Catch::Contains("motion 'move', 2 frames") &&
                            Catch::Contains("sums 0.5 to 4") &&
                            Catch::Contains("which changed weights by up to 100 %") &&
                            Catch::Contains("1 vertex has no weight at all") &&
                            Catch::Contains("156 bounds, 156 proven, 0 violated"));
    CHECK_THAT(
        test::cinch("verify " + at + "m.off --weights " + at + "w.txt --transforms " + at + "t.txt --clip run").err,
        Catch::Contains("has no clip 'run'; it has still, move"));
}

TEST_CASE("reference meshes and characters are proven")
{
    const auto folder = test::shared("meshes");
    if (!folder)
        return;
    for (const char* kdop : {" --kdop 6", " --kdop 14"})
        for (const char* input :
             {"brain_conte69_lh_30000.ply --nodes 509", "fish_blub_7106.obj", "skin/CesiumMan.glb",
              "skin/RiggedFigure.glb", "skin/robot.glb --clip Robot_Dance", "nasty_spider.obj", "nasty_wuson.off"}) {
            INFO(input << kdop);
            const test::Run run = test::cinch("verify " + folder->string() + "/" + input + kdop);
            CHECK(run.status == 0);
            CHECK_THAT(run.out, Catch::Contains(" proven, 0 violated\n"));
            if (std::string(input) == "skin/RiggedFigure.glb")
                CHECK_THAT(run.out,
                           Catch::Contains("13 of 130 vertices had weights that do not sum to 1 (sums 0.20009"));
        }
}

TEST_CASE("overflow and points: infinite bounds are counted, ratios that do not exist are not made up")
{
    const test::TemporaryFolder folder;
    const std::string at = folder.path().string() + "/";
    const std::string maximum = "1.7976931348623157e308";
    folder.write("max.off", "OFF\n3 1 0\n" + maximum + " 0 0\n-" + maximum + " 0 0\n0 1 0\n3 0 1 2\n");
    folder.write("big.off", "OFF\n3 1 0\n1e200 0 0\n-1e200 1e200 0\n0 1 0\n3 0 1 2\n");
    folder.write("point.off", "OFF\n1 1 0\n1 2 3\n3 0 0 0\n");
    folder.write("w3.txt", "3 1\n1 0 1\n1 0 1\n1 0 1\n");
    folder.write("w1.txt", "1 1\n1 0 1\n");
    folder.write("identity.txt", "1\na 1 1\n0 1 0 0 0 0 1 0 0 0 0 1 0\n");
    folder.write("grow.txt", "1\na 1 1\n0 1e200 0 0 0 0 -1e200 0 0 0 0 1 0\n");
    auto check = [&](const std::string& mesh, const std::string& weights, const std::string& transforms,
                     bool overflows) {
        for (const char* options : {"", " --kdop 14", " --method vertices", " --method eq12 --kdop 26"}) {
            INFO(mesh << options);
            const std::string run =
                "verify " + at + mesh + " --weights " + at + weights + " --transforms " + at + transforms + options;
            const test::Run table = test::cinch(run);
            CHECK(table.status == 0);
            CHECK_THAT(table.out, !Catch::Contains("nan"));
            CHECK((table.out.find("something overflows the arithmetic") != std::string::npos) == overflows);
            CHECK((summary(test::cinch(run + " --json"))["infinite"] > 0) == overflows);
        }
    };
    check("max.off", "w3.txt", "identity.txt", true);
    check("big.off", "w3.txt", "grow.txt", true);
    check("point.off", "w1.txt", "identity.txt", false);
}

TEST_CASE("volumes, exact attribution and VIPR files come on request")
{
    const test::TemporaryFolder folder;
    const test::Run run =
        test::cinch("verify santa --method limited --frames 2 --leaf 64 --kdop 14 --volume --json --vipr " +
                    (folder.path() / "v").string());
    CHECK(run.status == 0);
    std::size_t levels = 0, attributed = 0;
    for (const std::string& line : run.lines()) {
        const json record = json::parse(line);
        if (record.contains("attribution")) {
            ++attributed;
            CHECK_THAT(record["box_loss"].get<std::string>(), Catch::Contains("/"));
        } else if (record.contains("level")) {
            ++levels;
            CHECK(record["mean_volume_ratio"] >= 1);
            CHECK(record["max_volume_ratio"] >= record["mean_volume_ratio"]);
            CHECK(record["volume_measured"] > 0);
        }
    }
    CHECK(attributed == 14);
    CHECK(levels == 8);
    std::size_t files = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder.path() / "v"))
        ++files;
    CHECK(files == 8 * 14);
    CHECK_THAT(test::cinch("verify santa --frames 1 --leaf 64 --volume").out, Catch::Contains("volume ratio"));
    CHECK(test::cinch("verify santa --method vertices --vipr x").status == 2);
}

TEST_CASE("results that cannot be written are no success")
{
    if (!std::filesystem::exists("/dev/full"))
        return;
    const test::Run run = test::cinch("verify santa --frames 1 --json >/dev/full #");
    CHECK(run.status == 2);
}

TEST_CASE("an interrupt keeps what is done, says so, and exits 130")
{
    // Interrupts until the process has installed its handler and verified at least one frame.
    for (int seconds : {3, 10, 30}) {
        const test::Run run = test::cinch_interrupted("verify brain-3500 --nodes 60 --frames 20000", seconds);
        REQUIRE(run.status == 130);
        REQUIRE_THAT(run.err, Catch::StartsWith("cinch: stopping …\n"));
        if (run.out.empty())
            continue; // interrupted before there was anything to keep
        CHECK_THAT(run.err, Catch::Contains("\ncinch: interrupted after ") && Catch::EndsWith(" of 20000 frames\n"));
        CHECK_THAT(run.out, Catch::StartsWith("interrupted after ") && Catch::Contains(" proven, 0 violated\n"));
        return;
    }
    FAIL("never got to a first frame");
}

TEST_CASE("rows of verify add up to what they were made of")
{
    VerifyTotals frame;
    frame.levels.resize(2);
    double next = 1;
    for (LevelTotals& l : frame.levels) {
        l = {7, next, 3, 4, 5, next + 1, next + 2, {next + 3, next + 4, next + 5, next + 6}};
        next += 10;
    }
    frame.ladder = {11, 12, 13, 14, 15};
    frame.infinite = 16;
    frame.unbounded_nodes = 17;
    frame.decided_by_filter = 18;
    VerifyTotals sum;
    for (const std::size_t f : {0, 1})
        add_row(frame_row(0, f, frame), sum);
    REQUIRE(sum.levels.size() == 2);
    for (std::size_t l = 0; l < 2; ++l) {
        const LevelTotals &one = frame.levels[l], &both = sum.levels[l];
        CHECK(both.bvs == one.bvs);
        CHECK(both.proven == 6);
        CHECK(both.violated == 8);
        CHECK(both.measured == 10);
        CHECK(both.ratio_sum == 2 * one.ratio_sum);
        CHECK(both.ratio_max == one.ratio_max);
        CHECK(both.loss.box == 2 * one.loss.box);
        CHECK(both.loss.interval == 2 * one.loss.interval);
        CHECK(both.loss.corner == 2 * one.loss.corner);
        CHECK(both.loss.rounding == 2 * one.loss.rounding);
    }
    CHECK(sum.ladder.compared == 22);
    CHECK(sum.ladder.broken == 24);
    CHECK(sum.ladder.defaults == 26);
    CHECK(sum.ladder.above == 28);
    CHECK(sum.ladder.clearly == 30);
    CHECK(sum.infinite == 32);
    CHECK(sum.unbounded_nodes == 34);
    CHECK(sum.decided_by_filter == 36);
    CHECK(sum.frames == 2);
}
