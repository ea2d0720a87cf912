// SPDX-License-Identifier: GPL-3.0-or-later
#include <fstream>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "experiments/fuzz/fuzz_case.hpp"
#include "tests/support.hpp"
#include "toolkit/surface/read_mesh.hpp"

using namespace cinch;
using nlohmann::json;

namespace {

json summary(const test::Run& run)
{
    REQUIRE_FALSE(run.lines().empty());
    return json::parse(run.lines().back());
}

} // namespace

TEST_CASE("every hard case of the corpus holds, and survives a round trip through its file")
{
    int replayed = 0;
    for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(CINCH_DATA) / "hard")) {
        if (entry.path().extension() != ".json")
            continue;
        INFO(entry.path());
        const FuzzCase problem = fuzz_case_from_json(read_bytes(entry.path()), entry.path().string());
        CHECK(find_fault(problem, Defect::none).empty());
        CHECK_FALSE(find_fault(problem, Defect::no_rounding).empty()); // what makes it hard
        CHECK(to_json(fuzz_case_from_json(to_json(problem, ""), "copy"), "") == to_json(problem, ""));
        ++replayed;
    }
    CHECK(replayed >= 10);
}

TEST_CASE("every family draws, repeatably, and holds")
{
    for (const std::string_view family : fuzz_families())
        for (std::uint64_t i = 0; i < 200; ++i) {
            const FuzzCase problem = draw_case(9, i, family);
            INFO(to_json(problem, ""));
            REQUIRE(problem.family == family);
            REQUIRE(to_json(problem, "") == to_json(draw_case(9, i, family), ""));
            REQUIRE(find_fault(problem, Defect::none).empty());
        }
}

TEST_CASE("planted defects are found and shrunk to n <= 4, or prove harmless")
{
    for (const char* kind : {"no-rounding", "lower-h", "small-box"}) {
        INFO(kind);
        const test::Run run = test::cinch(std::string("fuzz --cases 4200 --json --sabotage ") + kind);
        CHECK(run.status == 1);
        CHECK(summary(run)["violations"] > 0);
        REQUIRE(run.lines().size() > 1);
        for (const std::string& line : run.lines()) {
            const json record = json::parse(line);
            if (record.contains("n"))
                CHECK(record["n"] <= 4);
        }
    }
    for (const char* kind : {"wrong-lambda", "sum-order"}) {
        INFO(kind);
        const test::Run run = test::cinch(std::string("fuzz --cases 21000 --json --sabotage ") + kind);
        CHECK(run.status == 0);
        CHECK(summary(run)["violations"] == 0);
    }
}

TEST_CASE("shards partition the cases, and threads change nothing")
{
    auto failures = [](const std::string& options) {
        std::vector<std::string> all;
        for (const std::string& line : test::cinch("fuzz --json --sabotage no-rounding " + options).lines()) {
            json record = json::parse(line);
            for (const char* field : {"command", "threads"}) // of the provenance, these alone differ
                record.erase(field);
            if (record.contains("cases"))
                all.push_back("total " + record["violations"].dump());
            else
                all.push_back(record.dump());
        }
        return all;
    };
    CHECK(failures("--cases 2100 --threads 1") == failures("--cases 2100 --threads 2"));
    auto violations = [&](const std::string& options) { return summary(test::cinch("fuzz --json --sabotage no-rounding " + options))["violations"].get<int>(); };
    CHECK(violations("--cases 2100") == violations("--cases 700 --shard 0/3") + violations("--cases 700 --shard 1/3") + violations("--cases 700 --shard 2/3"));
}

TEST_CASE("a fuzz run killed at any moment continues without repeating or losing cases")
{
    const test::TemporaryFolder folder;
    const std::string state = (folder.path() / "state.json").string();
    const std::string run = "fuzz --cases 300000 --json --sabotage no-rounding --family generic ";
    const int wanted = summary(test::cinch(run))["violations"];
    int kills = 0;
    for (; kills < 50; ++kills) {
        const test::Run killed = test::cinch_killed(run + "--resume " + state, 1.2);
        if (killed.status == 1 || killed.status == 0)
            break;
    }
    CHECK(kills > 0);
    const json end = summary(test::cinch(run + "--resume " + state));
    CHECK(end["cases"] == 300000);
    CHECK(end["violations"] == wanted);
    const test::Run other = test::cinch("fuzz --cases 10 --seed 3 --resume " + state);
    CHECK(other.status == 2);
    CHECK_THAT(other.err, Catch::Contains("was written with another --seed"));
}

TEST_CASE("fuzz usage errors")
{
    CHECK(test::cinch("fuzz --shard 3/3").status == 2);
    CHECK(test::cinch("fuzz --shard x").status == 2);
    CHECK(test::cinch("fuzz --family none").status == 2);
    const test::TemporaryFolder folder;
    CHECK(test::cinch("fuzz --cases 1 --resume " + folder.write("s", "{").string()).status == 2);
}
