// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <random>
#include <regex>
#include <thread>

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

TEST_CASE("a case whose file was changed is refused by the name of the field")
{
    const std::string good = to_json(draw_case(9, 3, "surface"), "");
    REQUIRE(to_json(fuzz_case_from_json(good, "a"), "") == good);
    auto refused = [&](const char* field, const std::string& value) {
        json changed = json::parse(good);
        changed[field] = json::parse(value);
        CHECK_THROWS_WITH(fuzz_case_from_json(changed.dump(), "a"),
                          Catch::StartsWith("a: field " + std::string(field)));
    };
    for (const char* field : {"n", "kdop", "trial", "passes"})
        for (const char* odd : {"-1", "1e30", "6.5", "null", "\"6\"", "18446744073709551615"})
            refused(field, odd);
    refused("kdop", "7");
    refused("passes", "0");
    for (const char* odd : {"nan", "inf", "", "1x", "1e999"}) {
        refused("rest", "[[\"" + std::string(odd) + "\",\"0\",\"0\"]]");
        refused("maps", "[[\"" + std::string(odd) + "\"]]");
    }
    refused("rest", "[[\"0\",\"0\"]]");
    refused("weights", "[[\"1\"]" + std::string(",[]]"));
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
    auto violations = [&](const std::string& options) {
        return summary(test::cinch("fuzz --json --sabotage no-rounding " + options))["violations"].get<int>();
    };
    CHECK(violations("--cases 2100") == violations("--cases 700 --shard 0/3") + violations("--cases 700 --shard 1/3") +
                                            violations("--cases 700 --shard 2/3"));
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
}

TEST_CASE("a fuzz run killed within its first second keeps what it did, whenever that is")
{
    const test::TemporaryFolder folder;
    const std::string state = (folder.path() / "state.json").string();
    const std::string run =
        "fuzz --cases 1000000 --json --sabotage no-rounding --family generic --threads 1 --resume " + state;
    std::mt19937_64 draw(11);
    std::uint64_t last = 0;
    int seen = 0, progress = 0;
    for (std::size_t i = 0; i < test::share_of(30); ++i) {
        test::cinch_killed(run, std::uniform_real_distribution<double>(0.01, 1)(draw));
        if (!std::filesystem::exists(state))
            continue; // before it could begin
        ++seen;
        const json kept = json::parse(read_bytes(state));
        const std::uint64_t next = kept["next"];
        CHECK(next >= last);
        progress += next > last;
        last = next;
        // Exactly those cases that are done, counted by a run that was not killed.
        if (i % 10 == 9) {
            const json whole = summary(
                test::cinch("fuzz --json --sabotage no-rounding --family generic --cases " + std::to_string(next)));
            CHECK(whole["violations"] == kept["violations"]);
        }
        const test::Run checked =
            test::cinch("fuzz --seconds 0 --json --sabotage no-rounding --family generic --resume " + state);
        CHECK(checked.status == (kept["violations"] == 0 ? 0 : 1));
        CHECK(summary(checked)["cases"] == next);
    }
    CHECK(2 * seen > static_cast<int>(test::share_of(30)));
    CHECK(2 * progress > seen);
}

TEST_CASE("a fuzz state continues only what it is of, and every field is checked")
{
    const test::TemporaryFolder folder;
    const std::string state = (folder.path() / "s").string();
    const std::string options = "--cases 6000 --seed 3 --shard 1/2 ";
    REQUIRE(test::cinch("fuzz --cases 5000 --seed 3 --shard 1/2 --resume " + state).status == 0);
    const std::string good = read_bytes(state);
    REQUIRE(json::parse(good)["next"] == 5000);
    auto refused = [&](const std::string& text, const std::string& with, const std::string& why) {
        folder.write("s", text);
        const test::Run run = test::cinch("fuzz " + with + "--resume " + state);
        INFO(with << text << run.err);
        CHECK(run.status == 2);
        CHECK(run.out.empty());
        CHECK_THAT(run.err, Catch::Contains(why));
        CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
        CHECK(read_bytes(state) == text); // and left alone
    };
    refused(good, "--cases 6000 --seed 4 --shard 1/2 ", "field \"seed\": 3 there, 4 in this run");
    refused(good, "--cases 6000 --seed 3 --shard 0/2 ", "field \"shard\": 1 there, 0 in this run");
    refused(good, "--cases 6000 --seed 3 --shard 1/3 ", "field \"shards\": 2 there, 3 in this run");
    refused(good, options + "--family generic ", "field \"family\": \"\" there, \"generic\" in this run");
    refused(good, options + "--sabotage lower-h ", "field \"sabotage\": \"\" there, \"lower-h\" in this run");
    refused(good, "--cases 4999 --seed 3 --shard 1/2 ", "field \"next\": 5000 cases are done, more than --cases 4999");
    auto with = [&](const char* field, const std::string& value) {
        return std::regex_replace(good, std::regex("\"" + std::string(field) + "\":(\\[\\]|[^,}]*)"),
                                  "\"" + std::string(field) + "\":" + value);
    };
    for (const char* field : {"version", "commit", "seed", "family", "shard", "shards", "sabotage", "next",
                              "violations", "seconds", "shrunk"}) {
        const std::string quoted = "field \"" + std::string(field) + "\": ";
        for (const char* odd : {"-5", "1e30", "4096.7", "null", "\"x\"", "[1]", "{}", "true", "99999999999999999999",
                                "18446744073709551615"})
            if (field != std::string("seconds") || odd[0] < '0' || odd[0] > '9')
                refused(with(field, odd), options, quoted);
        refused(std::regex_replace(good, std::regex("\"" + std::string(field) + "\""), "\"x\""), options,
                quoted + "is missing");
    }
    refused(with("violations", "5001"), options, "field \"violations\": 5001 is more than 5000");
    refused(with("violations", "1"), options, "was changed");
    refused(with("next", "5001"), options, "was changed");
    refused(with("seconds", "0"), options, "was changed");
    refused(good.substr(0, good.size() - 2) + ",\"next\":5000}\n", options, "was changed");
    refused(" " + good, options, "was changed");
    refused("[]\n", options, "is no state file");
    for (std::size_t i = 1; i < good.size(); i += 7) {
        refused(good.substr(0, i), options, state + ": ");
        refused(good.substr(0, i) + static_cast<char>(good[i] ^ 1) + good.substr(i + 1), options, state + ": ");
    }
    folder.write("s", "");
    CHECK(test::cinch("fuzz " + options + "--resume " + state).status == 2);
    folder.write("s", good);
    const test::Run run = test::cinch("fuzz " + options + "--json --resume " + state);
    CHECK(run.status == 0);
    CHECK(summary(run)["cases"] == 6000);
    std::filesystem::create_directory(folder.path() / "folder");
    CHECK(test::cinch("fuzz --cases 1 --resume " + (folder.path() / "folder").string()).status == 2);
    CHECK(test::cinch("fuzz --cases 1 --resume /nonexistent/s").status == 2);
}

TEST_CASE("one fuzz run at a time has a state file")
{
    const test::TemporaryFolder folder;
    const std::string state = (folder.path() / "s").string();
    std::vector<test::Run> runs(4);
    std::vector<std::thread> threads;
    for (test::Run& run : runs)
        threads.emplace_back([&] { run = test::cinch("fuzz --seconds 2 --json --threads 1 --resume " + state); });
    for (std::thread& thread : threads)
        thread.join();
    std::uint64_t cases = 0;
    int refused = 0;
    for (const test::Run& run : runs) {
        if (run.status == 0) {
            cases = std::max(cases, summary(run)["cases"].get<std::uint64_t>()); // those that come later continue
            continue;
        }
        CHECK(run.status == 2);
        CHECK_THAT(run.err, Catch::Contains("another 'cinch fuzz' is using it"));
        ++refused;
    }
    CHECK(refused >= 1);
    CHECK(refused <= 3);
    CHECK(json::parse(read_bytes(state))["next"] == cases);
}

TEST_CASE("a limit of 0 runs nothing")
{
    for (const char* limit : {"--seconds 0", "--cases 0", "--seconds 0 --cases 5", "--seconds 5 --cases 0"}) {
        const test::Run run = test::cinch(std::string("fuzz --json ") + limit);
        CHECK(run.status == 0);
        CHECK(summary(run)["cases"] == 0);
    }
}

TEST_CASE("fuzz usage errors")
{
    CHECK(test::cinch("fuzz --shard 3/3").status == 2);
    CHECK(test::cinch("fuzz --shard x").status == 2);
    CHECK(test::cinch("fuzz --family none").status == 2);
    CHECK(test::cinch("fuzz --cases -5").status == 2);
    CHECK(test::cinch("fuzz --seconds nan").status == 2);
    const test::TemporaryFolder folder;
    CHECK(test::cinch("fuzz --cases 1 --resume " + folder.write("s", "{").string()).status == 2);
    CHECK(test::cinch("fuzz --cases 1 --sabotage no-rounding --family generic --corpus " +
                      folder.write("file", "x").string())
              .status == 2);
}
