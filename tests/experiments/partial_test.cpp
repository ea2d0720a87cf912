// SPDX-License-Identifier: GPL-3.0-or-later
// What a result that is not of the whole surface says of itself; what weights were changed; and what a long clip takes.
#include <fstream>
#include <sstream>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/support.hpp"

using namespace cinch;
using nlohmann::json;

namespace {

std::string report(const std::string& name) { return std::string(CINCH_REPORTS) + "/" + name; }

const std::string morph = "morph targets with weights that are not 0 (nodes[0])";

// Runs the program and returns its peak memory in kB, or -1 where it fails.
long peak_kb(const std::vector<std::string>& arguments)
{
    const pid_t child = fork();
    if (child == 0) {
        std::vector<char*> argv{const_cast<char*>(CINCH_PROGRAM)};
        for (const std::string& a : arguments)
            argv.push_back(const_cast<char*>(a.c_str()));
        argv.push_back(nullptr);
        const int nowhere = open("/dev/null", O_WRONLY);
        dup2(nowhere, 1);
        dup2(nowhere, 2);
        execv(CINCH_PROGRAM, argv.data());
        _exit(127);
    }
    int status = 0;
    rusage usage{};
    return wait4(child, &status, 0, &usage) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0 ? usage.ru_maxrss
                                                                                                      : -1;
}

} // namespace

TEST_CASE("what is not modelled is refused by every command, and what is bounded of it says so everywhere")
{
    const std::string file = report("F03_morph_animated_noted.gltf");
    for (const std::string& command : {"verify " + file + " --frames 2 --volume", "tightness " + file + " --frames 2",
                                       "cost " + file + " --frames 2 --this-input-only --kdops 6 --seconds 0.01",
                                       "scaling " + file + " --seconds 0.001"}) {
        INFO(command);
        const test::Run refused = test::cinch(command);
        CHECK(refused.status == 2);
        CHECK(refused.out.empty());
        CHECK(refused.err == "cinch: " + file + ": has what is not modelled: " + morph +
                                 "; 'cinch bake', 'verify' and 'view' have them; --partial bounds the rest, and every "
                                 "result says so\n");

        const test::Run records = test::cinch(command + " --partial --json");
        CHECK(records.status == 0);
        CHECK_FALSE(records.lines().empty());
        for (const std::string& line : records.lines()) {
            const json record = json::parse(line);
            CHECK(record["partial"] == true);
            CHECK(record["missing"] == json{morph});
        }
        const test::TemporaryFolder folder;
        const std::string page = (folder.path() / "page.html").string();
        const test::Run table = test::cinch(command + " --partial --report " + page);
        CHECK(table.status == 0);
        CHECK_THAT(table.out, Catch::Contains("(partial, without " + morph + ")"));
        std::stringstream text;
        text << std::ifstream(page).rdbuf();
        CHECK_THAT(text.str(), Catch::Contains("<strong>Partial</strong>, without " + morph));
    }
    CHECK_THAT(test::cinch("verify " + file + " --partial --volume").out,
               Catch::Contains(" 0 violated (partial, without " + morph + ")\n"));
    const test::Run whole = test::cinch("verify " + report("F02_animation_pointer.gltf") + " --partial --json");
    for (const std::string& line : whole.lines()) { // nothing is missing
        CHECK(json::parse(line)["partial"] == false);
        CHECK(json::parse(line)["missing"] == json::array());
    }
    CHECK_THAT(test::cinch("verify fish --partial").err, Catch::Contains("--partial needs a skinned character"));
    for (const char* command : {"verify", "tightness", "cost", "scaling", "view"})
        CHECK_THAT(test::cinch(std::string(command) + " --help").out, Catch::Contains("--partial"));
}

TEST_CASE("frames with morph targets are proven and drawn with them, and a proof of less is refused")
{
    const std::string file = report("F03_morph_animated_noted.gltf");
    const test::Run proven = test::cinch("verify " + file);
    CHECK(proven.status == 0);
    CHECK_THAT(proven.out, Catch::Contains("1 morph target\n") && Catch::Contains(" 0 violated\n"));
    for (const std::string& line : test::cinch("verify " + file + " --json").lines()) {
        CHECK(json::parse(line)["partial"] == false);
        CHECK(json::parse(line)["missing"] == json::array());
    }
    const test::Run damaged = test::cinch("verify " + file + " --sabotage no-rounding --method vertices");
    CHECK((damaged.status == 0 || damaged.status == 1)); // the file's numbers are round
    const test::TemporaryFolder folder;
    const std::string at = folder.path().string();
    const auto certified = test::cinch("verify " + file + " --method limited --certificate " + at + "/c.jsonl");
    CHECK(certified.status == 0);
    CHECK_THAT(certified.out, Catch::Contains(" 0 violated\n"));
    for (const std::string& option : {"--vipr " + at + "/v", std::string("--volume")})
        CHECK(test::cinch("verify " + file + " --method limited " + option).status == 2);
    const json view = json::parse(test::cinch("view " + file + " --frames 2 --methods best,eq12 --json").lines().at(0));
    CHECK(view["partial"] == false);
    CHECK(view["view"]["bounds"].size() == 2);
    const test::Run whole = test::cinch("verify " + file + " --out " + at + "/rows");
    CHECK(whole.status == 0);
    CHECK_THAT(whole.out, Catch::Contains(" 0 violated\n"));
}

TEST_CASE("a scene with a character that is not modelled as a whole is refused")
{
    const test::TemporaryFolder folder;
    const auto scene =
        folder.write("s.json", R"({"name": "s", "duration": 0.1, "bodies": [{"name": "b", "surface": ")" +
                                   report("F03_morph_animated_noted.gltf") +
                                   R"(", "nodes": 4, "density": 1000}], "effects": [{"effect": "gravity"}]})");
    const test::Run run = test::cinch("simulate " + scene.string());
    CHECK(run.status == 2);
    CHECK_THAT(run.err, Catch::Contains("clip 'anim0' has what is not modelled: " + morph));
    CHECK(run.out.empty());
}

TEST_CASE("changes of weights are reported from rounding on, with the largest one")
{
    const test::TemporaryFolder folder;
    const std::string at = folder.path().string() + "/";
    folder.write("m.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    folder.write("t.txt", "1\na 1 2\n0 1 0 0 0 0 1 0 0 0 0 1 0 1 0 0 1 0 1 0 0 0 0 1 0\n");
    auto run = [&](const char* weights) {
        folder.write("w.txt", weights);
        return std::pair(
            test::cinch("verify " + at + "m.off --weights " + at + "w.txt --transforms " + at + "t.txt"),
            test::cinch("verify " + at + "m.off --weights " + at + "w.txt --transforms " + at + "t.txt --json"));
    };
    const auto [table, records] = run("3 2\n2 0 0.5 1 0.4999\n1 0 1\n2 0 0.5 1 0.49999\n");
    CHECK_THAT(table.out, Catch::Contains("2 of 3 vertices had weights that do not sum to 1 (sums 0.9999 to 1); "
                                          "normalised, which changed weights by up to 0.01 %"));
    for (const std::string& line : records.lines()) {
        CHECK(json::parse(line)["weights_normalised"] == 2);
        CHECK(json::parse(line)["largest_weight_change"].get<double>() == Approx(1e-4).epsilon(1e-3));
    }
    const auto [sound, none] = run("3 2\n2 0 0.333333333 1 0.666666667\n1 0 1\n2 0 0.1 1 0.9\n");
    CHECK_THAT(sound.out, !Catch::Contains("normalised"));
    CHECK(json::parse(none.lines().back())["weights_normalised"] == 0);
}

TEST_CASE("three frames of a long clip take what three frames take")
{
    const std::string file = report("F07_long_clip_memory.gltf");
    const long kb = peak_kb({"verify", file, "--frames", "3", "--threads", "2"});
    CAPTURE(kb);
    CHECK(kb > 0);
    if (test::test_share() >= 1) // sanitizers take more
        CHECK(kb < 60000);
    CHECK(peak_kb({"verify", file, "--frames", "3", "--fps", "1000000", "--threads", "2"}) > 0);
    const test::Run all = test::cinch("verify " + file + " --fps 1000");
    CHECK(all.status == 2);
    CHECK_THAT(
        all.err,
        Catch::Contains("clip 'anim0' has 30,000,001 frames at this rate; --frames chooses some, --fps takes fewer"));
}
