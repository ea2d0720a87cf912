// SPDX-License-Identifier: GPL-3.0-or-later
// Lists, shards, and folders of rows: what is whole, what is torn, and what does not belong together.
#include <catch2/catch.hpp>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <unistd.h>

#include "experiments/records/row_folder.hpp"
#include "experiments/study/lists.hpp"
#include "experiments/study/plan.hpp"
#include "experiments/study/summary.hpp"
#include "tests/support.hpp"

using namespace cinch;
using Catch::Contains;
namespace fs = std::filesystem;

namespace {

class Folder {
public:
    Folder() : path_(fs::temp_directory_path() / ("cinch-rows-" + std::to_string(::getpid())))
    {
        fs::remove_all(path_);
    }
    ~Folder() { fs::remove_all(path_); }
    operator const fs::path&() const { return path_; }
    fs::path shard(std::size_t i, std::size_t of) const
    {
        char name[64];
        std::snprintf(name, sizeof name, "shard-%06zu-of-%06zu.jsonl", i, of);
        return path_ / name;
    }

private:
    fs::path path_;
};

Campaign campaign() { return {"study", {{"seeds", {1, 2, 3}}}, 10, "0.1.0", "abc", "g++ 12", "-O3"}; }

Rows rows_of(std::size_t cell) { return {{{"cell", cell}, {"x", 0.1 * static_cast<double>(cell)}}}; }

void compute(const Folder& folder, const Campaign& what, const Shard& shard, std::size_t most = 1000)
{
    ShardFile file(folder, what, shard);
    for (std::size_t cell = 0; cell < what.cells && most > 0; ++cell)
        if (shard.has(cell) && !file.cells().contains(cell)) {
            file.add(cell, rows_of(cell));
            --most;
        }
}

std::string bytes(const fs::path& file)
{
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

void write(const fs::path& file, const std::string& text) { std::ofstream(file, std::ios::binary) << text; }

} // namespace

TEST_CASE("lists of numbers are numbers, ranges and doublings, and nothing else")
{
    using List = std::vector<std::uint64_t>;
    CHECK(parse_list("7", "seeds") == List{7});
    CHECK(parse_list("1-4", "seeds") == List{1, 2, 3, 4});
    CHECK(parse_list("16..512", "seeds") == List{16, 32, 64, 128, 256, 512});
    CHECK(parse_list("16..100", "seeds") == List{16, 32, 64, 100});
    CHECK(parse_list("3,1-2,8..8", "seeds") == List{3, 1, 2, 8});
    CHECK(parse_list("18446744073709551614-18446744073709551615", "seeds").size() == 2);
    CHECK(parse_list("9223372036854775808..18446744073709551615", "seeds").size() == 2);
    for (const char* bad : {"", ",", "1,", "x", "-1", "4-1", "0..8", "1...4", "1-", "..4", "1.5", "1-2-3", " 1", "0x3",
                            "18446744073709551616", "1,1", "1-3,2", "0-100000"}) {
        INFO(bad);
        CHECK_THROWS_AS(parse_list(bad, "seeds"), InputError);
    }
}

TEST_CASE("shards are I of N, or the task of an array job")
{
    CHECK(parse_shard("0/1").count == 1);
    CHECK(parse_shard("6/7").index == 6);
    for (const char* bad : {"", "1", "7/7", "-1/7", "1/0", "0/1000001", "1/", "/7", "a/b", "1/7/7"}) {
        INFO(bad);
        CHECK_THROWS_AS(parse_shard(bad), InputError);
    }
    ::unsetenv("CINCH_SHARDS");
    CHECK_THROWS_WITH(parse_shard("slurm"), Contains("SLURM_ARRAY_TASK_ID"));
    ::setenv("SLURM_ARRAY_TASK_ID", "3", 1);
    CHECK_THROWS_WITH(parse_shard("slurm"), Contains("CINCH_SHARDS"));
    ::setenv("SLURM_ARRAY_TASK_MAX", "9", 1);
    CHECK(parse_shard("slurm").count == 10);
    ::setenv("CINCH_SHARDS", "20", 1);
    CHECK((parse_shard("slurm").index == 3 && parse_shard("slurm").count == 20));
    ::setenv("CINCH_SHARDS", "2", 1);
    CHECK_THROWS_AS(parse_shard("slurm"), InputError);
    for (const char* name : {"SLURM_ARRAY_TASK_ID", "SLURM_ARRAY_TASK_MAX", "CINCH_SHARDS"})
        ::unsetenv(name);
}

TEST_CASE("a folder of rows gives all cells, whatever shards computed them and however often they were stopped")
{
    for (const std::size_t shards : {1u, 3u, 7u, 12u}) {
        Folder folder;
        for (std::size_t i = 0; i < shards; ++i)
            for (int stops = 0; stops < 3; ++stops)
                compute(folder, campaign(), {i, shards}, stops < 2 ? 1 : 1000);
        const Merged all = merge(folder);
        REQUIRE(all.cells.size() == 10);
        CHECK(all.campaign == campaign());
        for (std::size_t cell = 0; cell < 10; ++cell)
            CHECK(all.cells[cell] == rows_of(cell));
    }
}

TEST_CASE("a shard's file that is cut anywhere goes on, and is never taken for the whole")
{
    Folder folder;
    compute(folder, campaign(), {});
    const std::string whole = bytes(folder.shard(0, 1));
    for (std::size_t cut = 0; cut < whole.size(); cut += cut + 40 < whole.size() ? 7 : 1) {
        write(folder.shard(0, 1), whole.substr(0, cut));
        INFO("cut at " << cut << " of " << whole.size());
        REQUIRE_THROWS_AS(merge(folder), InputError);
        compute(folder, campaign(), {});
        REQUIRE(bytes(folder.shard(0, 1)) == whole);
    }
}

TEST_CASE("any other byte of a shard's file is found")
{
    Folder folder;
    compute(folder, campaign(), {});
    const std::string whole = bytes(folder.shard(0, 1));
    for (std::size_t at = 0; at < whole.size(); at += 3) {
        std::string changed = whole;
        changed[at] = changed[at] == '1' ? '2' : '1';
        write(folder.shard(0, 1), changed);
        INFO("byte " << at);
        REQUIRE_THROWS_AS(merge(folder), InputError);
    }
}

TEST_CASE("merge names what is missing, doubled or of something else")
{
    Folder folder;
    CHECK_THROWS_WITH(merge(folder), Contains("is no folder"));
    for (const std::size_t i : {0u, 1u, 4u, 6u})
        compute(folder, campaign(), {i, 7}, i == 1 ? 1 : 1000);
    CHECK_THROWS_WITH(merge(folder), Contains("shard 1 has 1 of 2 cells") && Contains("shard 2 is missing") &&
                                         Contains("--array=1-3,5 ") && Contains("CINCH_SHARDS=7"));
    for (std::size_t i = 0; i < 7; ++i)
        compute(folder, campaign(), {i, 7});
    CHECK(merge(folder).cells.size() == 10);

    SECTION("another number of shards")
    {
        compute(folder, campaign(), {1, 3});
        CHECK_THROWS_WITH(merge(folder), Contains("of 3 shards") || Contains("of 7 shards"));
    }
    SECTION("another commit")
    {
        fs::remove(folder.shard(5, 7));
        Campaign other = campaign();
        other.commit = "abd";
        compute(folder, other, {5, 7});
        CHECK_THROWS_WITH(merge(folder), Contains("000005-of") && Contains("commit 'abd'"));
    }
    SECTION("another plan")
    {
        fs::remove(folder.shard(5, 7));
        Campaign other = campaign();
        other.plan["seeds"] = {1, 2};
        compute(folder, other, {5, 7});
        CHECK_THROWS_WITH(merge(folder), Contains("another plan") && Contains("seeds"));
    }
    SECTION("the same shard under another name")
    {
        fs::copy_file(folder.shard(2, 7), folder.shard(8, 7));
        CHECK_THROWS_WITH(merge(folder), Contains("twice"));
    }
    SECTION("a run with another plan into the same folder")
    {
        Campaign other = campaign();
        other.cells = 11;
        CHECK_THROWS_WITH(compute(folder, other, {2, 7}), Contains("folder of its own"));
    }
}

TEST_CASE("two processes do not compute one shard")
{
    Folder folder;
    const ShardFile file(folder, campaign(), {});
    CHECK_THROWS_WITH(ShardFile(folder, campaign(), {}), Contains("another process"));
}

TEST_CASE("plans say what they do not know")
{
    const Plan plan = parse_plan(R"({"inputs": ["santa", "fish"], "nodes": "16..64", "seeds": "1-5",
                                     "methods": ["eq12", "support+linear"], "kdops": [6, 18], "frames": 2})",
                                 "plan.json");
    CHECK(cell_count(plan) == 30);
    CHECK(cell_of(plan, 0).seed == 1);
    CHECK(cell_of(plan, 4).seed == 5);
    CHECK(cell_of(plan, 5).nodes == 32);
    CHECK(cell_of(plan, 29).input == "fish");
    CHECK(parse_plan(to_json(plan).dump(), "again").methods == plan.methods);
    for (const auto& [text, says] : {std::pair("{", "no JSON"),
                                     {"[]", "JSON object"},
                                     {R"({"input": "santa"})", "known are"},
                                     {R"({"inputs": []})", "is empty"},
                                     {R"({"inputs": [3]})", "expected a name"},
                                     {R"({"inputs": "/nowhere/*.off"})", "no file matches"},
                                     {R"({"seeds": [-1]})", "whole numbers"},
                                     {R"({"seeds": "5-1"})", "5-1"},
                                     {R"({"methods": "eq13"})", "there are convex"},
                                     {R"({"methods": ["best", "best"]})", "twice"},
                                     {R"({"precisions": "half"})", "neither"},
                                     {R"({"kdops": 8})", "no 8-DOP"},
                                     {R"({"frames": 0})", "from 1 on"},
                                     {R"({"detail": "all"})", "run, levels"}}) {
        INFO(text);
        CHECK_THROWS_WITH(parse_plan(text, "plan.json"), Contains("plan.json") && Contains(says));
    }
}

TEST_CASE("means have Student's confidence, and quartiles lie between values")
{
    const Spread s = spread_of({4, 1, 2, 3});
    CHECK(s.mean == 2.5);
    CHECK(s.median == 2.5);
    CHECK(s.lower == 1.75);
    CHECK(s.upper == 3.25);
    CHECK(s.half_width == Approx(3.182446305284263 * std::sqrt(5.0 / 3 / 4)).epsilon(1e-12)); // t of 3, 97.5 %
    CHECK(spread_of({2}).half_width == 0);
    CHECK(spread_of({}).count == 0);
}
