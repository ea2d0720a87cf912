// SPDX-License-Identifier: GPL-3.0-or-later
// The page of stored results: every figure leads to its line, damage is named and left out, nothing that a result holds
// is taken for HTML.
#include <catch2/catch.hpp>

#include <fstream>
#include <regex>
#include <set>

#include "experiments/report/page/page.hpp"
#include "experiments/report/paper_figures.hpp"
#include "experiments/report/record_output.hpp"
#include "experiments/report/results.hpp"
#include "experiments/report/stages.hpp"
#include "experiments/report/table.hpp"
#include "tests/support.hpp"

using namespace cinch;
using Json = nlohmann::ordered_json;

namespace {

std::string read(const std::filesystem::path& file)
{
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

Json scaling_record(const char* method, double ns)
{
    return {{"experiment", "scaling"}, {"method", method},        {"vertices", 30000}, {"n", 509},
            {"ns_per_bound", ns},      {"over_default", ns / 500}};
}
const std::vector<Json> scaling_records{scaling_record("textbook", 20000), scaling_record("best", 500),
                                        scaling_record("optimal", 430000)};

/// As `cinch reproduce` stores it.
std::string whole(const std::string& stage, const std::vector<Json>& records)
{
    const Provenance from = provenance(1, 0);
    std::string text;
    for (const Json& record : records)
        text += json_line(record, from) + "\n";
    return sealed(text, json_line({{"experiment", "reproduce"},
                                   {"stage", stage},
                                   {"lines", records.size()},
                                   {"status", 0},
                                   {"seconds", 1.0},
                                   {"measured_by", "cinch"}},
                                  from));
}

// Where the full update takes 6 ms.
Json collide_record(const char* scene, const char* backend, double evaluate, double update, double query)
{
    return {{"experiment", "collide"},
            {"scene", scene},
            {"backend", backend},
            {"bodies", 6},
            {"vertices", 1000},
            {"n", 115},
            {"frames_done", 2},
            {"frames", 2},
            {"cold", false},
            {"evaluate_ms", evaluate},
            {"update_ms", update},
            {"query_ms", query},
            {"total_ms", evaluate + update + query},
            {"gain", 6 / (evaluate + update + query)},
            {"pairs", 5},
            {"mean_vertices", 1500}};
}

Results results_of(const std::string& text)
{
    const test::TemporaryFolder folder;
    std::vector<Damage> damage;
    Results results;
    for (Record& record : read_results(folder.write("x.jsonl", text), damage))
        results.add(std::move(record));
    REQUIRE(damage.empty());
    return results;
}

/// Every link into the page must have its element; returns how many there are.
std::size_t checked_links(const std::string& page)
{
    std::set<std::string> ids;
    const std::regex id("id=\"([^\"]*)\""), link("href=\"#([^\"]*)\"");
    for (auto at = std::sregex_iterator(page.begin(), page.end(), id); at != std::sregex_iterator(); ++at) {
        INFO("twice: " << at->str(1));
        CHECK(ids.insert(at->str(1)).second);
    }
    std::size_t count = 0;
    for (auto at = std::sregex_iterator(page.begin(), page.end(), link); at != std::sregex_iterator(); ++at, ++count) {
        INFO("leads nowhere: " << at->str(1));
        CHECK(ids.count(at->str(1)) == 1);
    }
    return count;
}

} // namespace

TEST_CASE("a table that is wider than the terminal becomes several, with every cell and the first column in each")
{
    const std::vector<std::string> header{"level", "BVs", "mean ratio", "max", "levels of all kinds"};
    const std::vector<std::vector<std::string>> rows{{"0", "1", "1.148", "2", "a"}, {"10", "1,024", "3", "4", "bc"}};
    const std::string whole_table = "level   BVs mean ratio max levels of all kinds\n"
                                    "    0     1      1.148   2                   a\n"
                                    "   10 1,024          3   4                  bc\n";
    CHECK(table(header, rows, 0) == whole_table);
    CHECK(table(header, rows, 46) == whole_table);
    CHECK(table(header, rows, 45) ==
          "level   BVs mean ratio max\n    0     1      1.148   2\n   10 1,024          3   4\n\n"
          "level levels of all kinds\n    0                   a\n   10                  bc\n");
    CHECK(table(header, rows, 1).size() > whole_table.size()); // a column each, whatever its width
    CHECK(table({"n"}, {{"1"}}, 1) == "n\n1\n");
    CHECK(table({}, {}, 1) == "\n");
}

TEST_CASE("a figure carries every line that it is computed from")
{
    const Results results = results_of(whole("x", scaling_records));
    const Traced a = results.number({{"method", "optimal"}}, "ns_per_bound"),
                 b = results.number({{"method", "textbook"}}, "ns_per_bound");
    const Traced ratio = a / b;
    CHECK(ratio.value == 21.5);
    CHECK(ratio.from == std::vector<Source>{{"x", 3}, {"x", 1}});
    CHECK((ratio + a).from.size() == 2);
    CHECK_FALSE((a / Traced{}).known());
    CHECK(mean({a, Traced{}}).value == a.value);
    CHECK_FALSE(mean({}).known());
    CHECK(least({Traced{}, a, b}).value == b.value);
    CHECK(greatest({Traced{}, a, b}).from == a.from);
}

TEST_CASE("a damaged file gives no record, and says where the damage is")
{
    const std::string good = whole("scaling", scaling_records);
    const auto line = [&](std::size_t n) { // where it begins, from 1
        std::size_t at = 0;
        for (std::size_t i = 1; i < n; ++i)
            at = good.find('\n', at) + 1;
        return at;
    };
    struct Fault {
        const char* what;
        std::string text;
        std::size_t line;
        const char* says;
    };
    const std::string no_seed =
        std::regex_replace(good, std::regex("\"seed\":0"), "\"sead\":0", std::regex_constants::format_first_only);
    for (const Fault& fault :
         {Fault{"empty", "", 0, "truncated"},
          {"cut at a line's end", good.substr(0, line(4)), 3, "truncated"},
          {"cut within a line", good.substr(0, line(3) - 20), 2, "middle"},
          {"a line is missing", good.substr(0, line(2)) + good.substr(line(3)), 3, "missing"},
          {"a byte is wrong", good.substr(0, line(2)) + "}" + good.substr(line(2) + 1), 2, "JSON"},
          {"not an object", "[1]\n" + good, 1, "object"},
          {"without provenance", no_seed, 1, "\"seed\""},
          {"a text for a number",
           std::regex_replace(good, std::regex("\"n\":509"), "\"n\":\"<b>\"", std::regex_constants::format_first_only),
           1, "\"n\""},
          {"something follows", good + good, 5, "follows"},
          {"a line twice", good.substr(0, line(3)) + good.substr(line(2)), 5, "more lines before it"},
          {"a line twice, another gone",
           good.substr(0, line(2)) + good.substr(line(1), line(2) - line(1)) + good.substr(line(3)), 4, "checksum"},
          {"another figure", std::regex_replace(good, std::regex("20000.0"), "20001.0"), 4, "checksum"},
          {"another status", std::regex_replace(good, std::regex("\"status\":0"), "\"status\":1"), 4, "checksum"},
          {"a negative time", std::regex_replace(good, std::regex("20000.0"), "-2000.0"), 1,
           "\"ns_per_bound\" must be a number from 0 on or null, not -2000.0"},
          {"half a count", std::regex_replace(good, std::regex("\"threads\":1,"), "\"threads\":1.5,"), 1,
           "\"threads\" must be a count, not 1.5"},
          {"a negative count", std::regex_replace(good, std::regex("\"vertices\":30000"), "\"vertices\":-3"), 1,
           "\"vertices\" must be a count, not -3"},
          {"NaN", std::regex_replace(good, std::regex("20000.0"), "NaN"), 1, "JSON"},
          {"NaN as text", std::regex_replace(good, std::regex("20000.0"), "\"nan\""), 1, "\"ns_per_bound\""},
          {"beyond a double", std::regex_replace(good, std::regex("20000.0"), "1e999"), 1, "JSON"},
          {"no checksum", std::regex_replace(good, std::regex(",\"checksum\":\"[0-9a-f]*\""), ""), 4, "no checksum"},
          {"zero bytes", std::string(300, '\0'), 1, "middle"}}) {
        INFO(fault.what);
        const test::TemporaryFolder folder;
        std::vector<Damage> damage;
        CHECK(read_results(folder.write("scaling.jsonl", fault.text), damage).empty());
        REQUIRE_FALSE(damage.empty());
        CHECK(damage[0].file == "scaling.jsonl");
        CHECK(damage[0].line == fault.line);
        CHECK(describe(damage[0]).find(fault.says) != std::string::npos);
    }
    const test::TemporaryFolder folder;
    std::vector<Damage> damage;
    CHECK(read_results(folder.write("scaling.jsonl", good), damage).size() == 4);
    CHECK(damage.empty());
}

TEST_CASE("a results file of which any byte is changed, left out or added gives no record")
{
    const std::string good = whole("scaling", {scaling_records[0]});
    const test::TemporaryFolder folder;
    auto records = [&](const std::string& text) {
        std::vector<Damage> damage;
        const std::size_t found = read_results(folder.write("x.jsonl", text), damage).size();
        CHECK((found == 0) == !damage.empty());
        for (const Damage& d : damage)
            CHECK(describe(d).find('\n') == std::string::npos);
        return found;
    };
    REQUIRE(records(good) == 2);
    for (std::size_t i = 0; i < good.size(); ++i) {
        INFO(i << ": " << good.substr(i, 20));
        for (const char flip : {'\1', '\4', ' '})
            REQUIRE(records(good.substr(0, i) + static_cast<char>(good[i] ^ flip) + good.substr(i + 1)) == 0);
        REQUIRE(records(good.substr(0, i)) == 0);
        REQUIRE(records(good.substr(0, i) + good.substr(i + 1)) == 0);
        REQUIRE(records(good.substr(0, i) + " " + good.substr(i)) == 0);
    }
}

TEST_CASE("cinch report names damaged files, leaves them out, and the rest stands")
{
    const test::TemporaryFolder folder;
    const std::string good = whole("scaling", scaling_records),
                      ring = whole("santa-ring-1", {collide_record("santa-ring-1", "refit-1", 2, 3, 1),
                                                    collide_record("santa-ring-1", "eq12-aabb", 0, 1, 0.5)});
    folder.write("scaling.jsonl", good);
    folder.write("santa-ring-1.jsonl", ring.substr(0, ring.size() - 30));
    const std::string where = "'" + folder.path().string() + "'";
    auto run = test::cinch("report " + where);
    CHECK(run.status == 2); // no verdict on any bound
    CHECK(run.err.find("santa-ring-1.jsonl:3: ends in the middle of the line") != std::string::npos);
    std::string page = read(folder.path() / "report.html");
    CHECK(page.find("santa-ring-1.jsonl:3") != std::string::npos);
    CHECK(page.find("id=\"table-1\"") != std::string::npos);
    CHECK(page.find("id=\"table-4\"") == std::string::npos);
    CHECK(page.find("Not run yet:") != std::string::npos);
    folder.write("santa-ring-1.jsonl", ring);
    run = test::cinch("report " + where + " --page '" + (folder.path() / "other.html").string() + "'");
    CHECK(run.status == 0);
    CHECK(run.err.empty());
    page = read(folder.path() / "other.html");
    CHECK(page.find("id=\"table-4\"") != std::string::npos);
    CHECK(checked_links(page) > 40);
    CHECK(page.find("http:") == page.find("http://www.w3.org")); // nothing is fetched
    CHECK(page.find("src=") == std::string::npos);
    CHECK(test::cinch("report '" + (folder.path() / "nosuch").string() + "'").status == 2);
}

TEST_CASE("Table 4 says what a row is made of")
{
    // Full: 2 + 3 + 1 = 6 ms; Eq. 12: 1.5 ms with 1,500 of 6,000 vertices, so 1.5 ms of evaluation avoided of 4.5 ms
    // gained.
    const Results results = results_of(whole("x", {collide_record("santa-ring-1", "refit-1", 2, 3, 1),
                                                   collide_record("santa-ring-1", "eq12-aabb", 0, 1, 0.5),
                                                   collide_record("santa-ring-1", "refit-16", 1, 1, 1),
                                                   collide_record("santa-ring-1", "eq12-obb-14", 0, 2, 1)}));
    std::string page = std::regex_replace(report_page(results, {}), std::regex("<[^>]*>"), "");
    CHECK(page.find("Eq. 12 on demand is 4 times faster than a full update, in the paper 5.2.") != std::string::npos);
    CHECK(page.find("It evaluates 1,500 of 6,000 vertices per frame; the evaluation that it avoids is 25 % of the full "
                    "update and 33 % of the gain.") != std::string::npos);
    CHECK(page.find("A full refit with 16-triangle leaves alone gains 2.") != std::string::npos);
    CHECK(page.find("OBB/14-DOP is slower, 2 times") != std::string::npos);
}

TEST_CASE("what a result holds is text, never markup")
{
    const std::string evil = "<script>alert(1)</script>\"'&";
    std::vector<Json> records = scaling_records;
    records.push_back({{"experiment", "scaling"},
                       {"input", evil},
                       {"method", evil},
                       {"n", 3},
                       {"vertices", 4},
                       {"ns_per_bound", 5.0}});
    records.push_back({{"experiment", "scaling"},
                       {"input", evil},
                       {"method", evil},
                       {"n", 6},
                       {"vertices", 4},
                       {"ns_per_bound", 9.0}});
    records.push_back({{"experiment", "verify"},
                       {"input", evil},
                       {"method", evil},
                       {"update", evil},
                       {"precision", evil},
                       {"bounds", 1},
                       {"proven", 1},
                       {"violated", 0}});
    records.push_back({{"experiment", "corners"},
                       {"file", evil},
                       {"n", 2},
                       {"vertex_count", evil},
                       {"rows", {{{"exact_max", evil}}}}});
    records.push_back({{"experiment", "cost"},
                       {"input", evil},
                       {"method", "eq12"},
                       {"arithmetic", "double"},
                       {"kdop", 6},
                       {"ns_per_bound", 5.0},
                       {"mean_ratio", 1.5},
                       {"guarantee", evil}});
    records.push_back({{"experiment", "collide"},
                       {"scene", evil},
                       {"backend", evil},
                       {"pairs_of_frame", {1, "<b>"}},
                       {"total_ms_of_frame", {1, 2}}});
    records.push_back({{"experiment", "tightness"},
                       {"input", evil},
                       {"method", "eq12"},
                       {"motion", evil},
                       {"n", 5},
                       {"level", 0},
                       {"mean_ratio", 2.0},
                       {"box_loss", evil}});
    Json odd{{"experiment", evil}, {evil, evil}};
    records.push_back(odd);
    const Results results = results_of(whole("x", records));
    for (const std::string& page : {report_page(results, {{{evil, 1, evil}}, {evil}, {}}), command_page(results)}) {
        CHECK(page.find("<script>alert") == std::string::npos);
        CHECK(page.find("<b>") == std::string::npos);
        CHECK(page.find("&lt;script&gt;alert") != std::string::npos);
        checked_links(page);
    }
}

TEST_CASE("every command writes a page of its own")
{
    const test::TemporaryFolder folder;
    const std::string page = (folder.path() / "page.html").string(), option = " --report '" + page + "'";
    for (const char* command :
         {"scaling --seconds 0.01", "verify fish-8000 --nodes 20 --leaf 256 --frames 1",
          "tightness fish-8000 --nodes 20 --sweep 20 --frames 1 --leaf 512 --methods eq12,best",
          "cost fish-8000 --nodes 20 --kdops 6 --seconds 0.01 --leaf 512 --this-input-only", "corners 038_hyper_n5",
          "stability --case subnormals", "fuzz --cases 20 --seed 1", "simulate beam --duration 0.05"}) {
        INFO(command);
        std::filesystem::remove(page);
        const auto run = test::cinch(command + option);
        INFO(run.err);
        CHECK(run.status == 0);
        const std::string text = read(page);
        CHECK(text.find("<h1>cinch ") != std::string::npos);
        CHECK(text.find("id=\"provenance\"") != std::string::npos);
        CHECK(checked_links(text) > 1);
    }
    CHECK(test::cinch("scaling --seconds 0.01 --report /nosuch/page.html").status == 2);
}

TEST_CASE("every stage is a command that parses, and a quick run is a part of the whole")
{
    std::set<std::string> names;
    std::size_t quick = 0;
    double seconds = 0, quick_seconds = 0;
    for (const Stage& stage : stages()) {
        CHECK(names.insert(stage.name).second);
        seconds += stage.seconds;
        quick += !stage.quick.empty();
        quick_seconds += stage.quick.empty() ? 0 : stage.quick_seconds;
        for (const bool is_quick : {false, true}) {
            std::string line;
            for (const std::string& word : arguments_of(stage, is_quick, 7))
                line += word + " ";
            INFO(line);
            const auto run = test::cinch(line + "--report /nosuch/page.html"); // what is refused after the options are
                                                                               // understood, and before anything is run
            INFO(run.err);
            CHECK(run.status == 2);
            CHECK(run.err.find("/nosuch/page.html: cannot be written") != std::string::npos);
            CHECK(line.find("--json") != std::string::npos);
        }
    }
    CHECK(quick >= 8);
    CHECK(names.size() >= 15);
    CHECK(seconds < 45 * 60);
    CHECK(quick_seconds < 3 * 60);
}

TEST_CASE("the paper's figures are consistent with each other")
{
    for (int ring = 1; ring <= 8; ++ring) {
        const std::string row = std::to_string(ring), of_two = std::to_string((ring - 1) / 2 * 2 + 1) + ", " +
                                                               std::to_string((ring - 1) / 2 * 2 + 2);
        for (const std::string& kind : {std::string(), std::string("OBB ")}) {
            const double total = paper_figure("Table 4", row, kind + "total").value;
            CHECK(paper_figure("Table 4", row, kind + "refit").value +
                      paper_figure("Table 4", row, kind + "query").value ==
                  Approx(total).margin(0.06));
            CHECK(paper_figure("Table 3", of_two, "total").value / total ==
                  Approx(paper_figure("Table 4", row, kind + "gain").value).margin(0.1));
        }
    }
    CHECK_THROWS_AS(paper_figure("Table 1", "3.5K", "66"), std::out_of_range);
}
