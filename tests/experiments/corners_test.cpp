// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <fstream>
#include <iostream>
#include <sstream>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "experiments/case_file.hpp"
#include "tests/support.hpp"

using namespace cinch;
using nlohmann::json;

namespace {

json parsed(const std::filesystem::path& path)
{
    std::ifstream in(path);
    return json::parse(in, nullptr, false);
}

} // namespace

TEST_CASE("every reference case is answered as its file says")
{
    const std::filesystem::path folder = std::filesystem::path(CINCH_DATA) / "cases";
    const test::Run run = test::cinch("corners " + folder.string() + "/*.json --json");
    CHECK(run.status == 0);
    CHECK(run.err.empty());
    REQUIRE(run.lines().size() >= 19);
    for (const std::string& line : run.lines()) {
        const json answer = json::parse(line);
        const json wanted = parsed(answer["file"].get<std::string>());
        INFO(answer["file"]);
        CHECK(answer["feasible"] == wanted["feasible"]);
        if (!wanted["vertex_count"].is_null())
            CHECK(answer["vertex_count"] == std::to_string(wanted["vertex_count"].get<std::uint64_t>()));
        for (std::size_t i = 0; i < wanted["b"].size(); ++i) {
            const json& row = answer["rows"][i];
            CHECK(row["exact_max"] == wanted["exact_max"][i]);
            if (wanted["feasible"]) {
                CHECK(row["eq12"] == wanted["eq12"][i]);
                CHECK(row["bound_holds"] == true);
            } else {
                CHECK(row["bound"].is_null());
            }
        }
    }
}

TEST_CASE("every hostile case has one of its expected outcomes, within a second or so")
{
    int cases = 0;
    for (const auto& entry :
         std::filesystem::directory_iterator(std::filesystem::path(CINCH_DATA) / "cases" / "hostile")) {
        const json wanted = parsed(entry.path())["expected"];
        const test::Run run = test::cinch("corners '" + entry.path().string() + "' --json");
        std::vector<std::string> outcomes;
        if (run.status == 2) {
            outcomes = {"error"};
            CHECK_THAT(run.err, Catch::StartsWith("cinch: " + entry.path().string() + ": field "));
        } else {
            REQUIRE(run.status == 0);
            const json answer = json::parse(run.out);
            outcomes = {!answer["feasible"].get<bool>() ? "infeasible" : "ok"};
            for (const json& row : answer["rows"])
                if (row["bound"] == "inf")
                    outcomes = {"ok_inf"};
        }
        INFO(entry.path() << " gave " << outcomes[0]);
        CHECK(std::find(wanted.begin(), wanted.end(), outcomes[0]) != wanted.end());
        ++cases;
    }
    CHECK(cases >= 9);
}

TEST_CASE("a case is read from standard input")
{
    std::istringstream text(R"({"n":2,"l":[0.25,0],"h":[0.5,1],"b":[[1,2]]})"), none;
    std::streambuf* const before = std::cin.rdbuf(text.rdbuf());
    const Case read = read_case("-");
    std::cin.rdbuf(none.rdbuf());
    CHECK_THROWS_WITH(read_case("-"), Catch::Contains("standard input"));
    std::cin.rdbuf(before);
    CHECK(read.l == std::vector<double>{0.25, 0});
    CHECK(read.b == std::vector<std::vector<double>>{{1, 2}});
}

TEST_CASE("corners are listed as fractions, up to a limit")
{
    const test::TemporaryFolder folder;
    const std::string file = folder.write("a.json", R"({"n":3,"l":[0,0,0],"h":["0x1p-1",0.5,0.75],"b":[]})").string();
    const test::Run run = test::cinch("corners " + file + " --list");
    CHECK(run.status == 0);
    CHECK_THAT(run.out, Catch::Contains("feasible, 5 corners\n") && Catch::Contains("0/1 1/4 3/4\n") &&
                            Catch::Contains("1/2 1/2 0/1\n"));
    CHECK(run.lines().size() == 6);
    CHECK(test::cinch("corners " + file + " --list --limit 2").lines().size() == 3);
    for (const std::string& line : test::cinch("corners " + file + " --list --json").lines())
        CHECK(json::parse(line)["file"] == file);
}

TEST_CASE("bad case files are refused with field and index, the others answered")
{
    const test::TemporaryFolder folder;
    auto refused = [&](const std::string& text, const std::string& reason) {
        const std::string file = folder.write("bad.json", text).string();
        const test::Run run = test::cinch("corners " + file);
        CHECK(run.status == 2);
        CHECK_THAT(run.err, Catch::StartsWith("cinch: " + file + ": ") && Catch::Contains(reason));
    };
    refused("{", "parse error");
    refused("[]", "not a JSON object");
    refused(R"({"n":1,"l":[0]})", "field h is missing");
    refused(R"({"n":2,"l":[0],"h":[1]})", "field l: 1 numbers, but n is 2");
    refused(R"({"n":1.5,"l":[0],"h":[1]})", "field n: expected a whole number");
    refused(R"({"n":0,"l":[],"h":[]})", "field n: expected a whole number");
    refused(R"({"n":1,"l":[0.5],"h":[0.25]})", "field h[0]: 0.25 lies outside l to 1");
    refused(R"({"n":1,"l":[0],"h":["1.5"]})", "field h[0]: 1.5 lies outside");
    refused(R"({"n":1,"l":[0],"h":[1],"b":[[1],["inf"]]})", "field b[1][0]: \"inf\" is not finite");
    refused(R"({"n":1,"l":[0],"h":[1],"b":[[1e999]]})", "");
    refused(R"({"n":1,"l":["0x"],"h":[1]})", "field l[0]: \"0x\" is not a number");
    refused(R"({"n":1,"l":[null],"h":[1]})", "field l[0]: null is not a number");
    refused(R"({"n":1,"l":[0],"h":[1],"b":[[1,2]]})", "field b[0]: 2 numbers, but n is 1");
    refused(R"({"n":1,"l":[0],"h":[1],"b":7})", "field b: expected an array");
    const std::string good = folder.write("good.json", R"({"n":1,"l":[0],"h":[1],"b":[[3]]})").string();
    const test::Run both = test::cinch("corners " + (folder.path() / "missing.json").string() + " " + good + " --json");
    CHECK(both.status == 2);
    CHECK(json::parse(both.out)["rows"][0]["exact_max"] == "3/1");
}
