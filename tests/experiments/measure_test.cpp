// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "cinch/refit.hpp"
#include "experiments/baselines/optimal_box.hpp"
#include "experiments/baselines/textbook.hpp"
#include "experiments/measure/race.hpp"
#include "tests/support.hpp"
#include "toolkit/bounds/bound_box.hpp"
#include "toolkit/bounds/weight_space.hpp"
#include "toolkit/deform/kernel/targets.hpp"

using namespace cinch;
using nlohmann::json;

namespace {

std::vector<json> records(const test::Run& run)
{
    std::vector<json> all;
    for (const std::string& line : run.lines())
        all.push_back(json::parse(line));
    return all;
}

std::string slurp(const std::filesystem::path& path)
{
    std::ifstream in(path);
    return {std::istreambuf_iterator<char>(in), {}};
}

} // namespace

TEST_CASE("the baselines compute what they claim to")
{
    const test::Example e = test::example(500, 40);
    const Bvh bvh = build_bvh(e.surface, 100000);
    const auto& maps = e.frames[2];
    double corners[6], axes[6], optimal[6], single[6];
    Textbook textbook(bvh, 0, maps);
    textbook.bound(TransformedBox::corners, corners);
    textbook.bound(TransformedBox::axes, axes);
    OptimalBox<double>(e.surface, maps).bound(optimal);
    OptimalBox<float>(e.surface, maps).bound(single);
    // The textbook's Eq. 12 is D at the second-largest b, without the intersection with the greatest b.
    std::vector<double> truth(6), b(40);
    refit(bvh, e.surface, maps, {Method::vertices, 6, Rounding::plain}, truth);
    const RestBv rest = bvh.rest(0);
    BoundScratch scratch;
    for (std::size_t a = 0; a < 3; ++a) {
        std::vector<double> convex(2);
        bound_box(rest, maps, Method::convex, Rounding::plain, {&axes_of(6)[a], 1}, scratch, convex);
        for (std::size_t side = 0; side < 2; ++side) {
            const auto& x = side == 0 ? scratch.plus : scratch.minus;
            const double eq12 = dual_bound(rest.space, x, second_largest(x), Rounding::plain);
            CHECK(corners[2 * a + side] == Approx(eq12).margin(1e-12));
            CHECK(axes[2 * a + side] == Approx(eq12).margin(1e-12));
            CHECK(optimal[2 * a + side] == Approx(truth[2 * a + side]).margin(1e-13));
            CHECK(single[2 * a + side] == Approx(truth[2 * a + side]).margin(1e-5));
        }
    }
}

TEST_CASE("a race measures each contestant, and slopes are slopes")
{
    int slow = 0, fast = 0;
    auto work = [](int n) {
        volatile double x = 1;
        for (int i = 0; i < n; ++i)
            x = x * 1.0000001;
    };
    const RaceTimes times = race({[&] { ++slow, work(20000); }, [&] { ++fast, work(200); }}, 0.05);
    REQUIRE(times.ns.size() == 2);
    CHECK(times.of(0).value > 5 * times.of(1).value);
    CHECK(times.ratio(0, 1).low > 5);
    CHECK(times.ratio(0, 0).high == 1);
    CHECK(times.cpu_share > 0);
    CHECK(times.cpu_share <= 1);
    CHECK(fast > slow);
    CHECK(slow >= 4);
    CHECK(log_slope({1, 10, 100}, {5, 50, 500}) == Approx(1));
    CHECK(log_slope({1, 10, 100}, {7, 7, 7}) == Approx(0).margin(1e-12));
}

TEST_CASE("a verdict is inconclusive where the limit lies between the quartiles, and only there")
{
    const Range range = range_of({5, 1, 4, 2, 3});
    CHECK(range.low == 2);
    CHECK(range.value == 3);
    CHECK(range.high == 4);
    CHECK(at_most(range, 4) == Verdict::holds);
    CHECK(at_most(range, 3.5) == Verdict::inconclusive);
    CHECK(at_most(range, 2.5) == Verdict::inconclusive);
    CHECK(at_most(range, 1.9) == Verdict::fails);
    CHECK(at_least(range, 2) == Verdict::holds);
    CHECK(at_least(range, 3) == Verdict::inconclusive);
    CHECK(at_least(range, 4.1) == Verdict::fails);
    CHECK(at_least(Range(NAN), 1) == Verdict::unknown);
    CHECK(at_most(Range(1.1), 1.1) == Verdict::holds); // exact
    CHECK(all_of({Verdict::holds, Verdict::unknown}) == Verdict::holds);
    CHECK(all_of({Verdict::holds, Verdict::inconclusive}) == Verdict::inconclusive);
    CHECK(all_of({Verdict::inconclusive, Verdict::fails, Verdict::holds}) == Verdict::fails);
    CHECK(all_of({}) == Verdict::unknown);
    CHECK(!range.is_settled());
    CHECK(Range(10, 9.6, 10.5).is_settled());
    const Range quotient = Range(10, 9, 11) / Range(2, 1, 4);
    CHECK(quotient.low == 2.25);
    CHECK(quotient.high == 11);
}

TEST_CASE("a race leaves out rounds that were sat out, and knows less where others had the core")
{
    RaceTimes times;
    times.ns = {{4, NAN, NAN, 4.1, 4}, {2, 2, 2, 2, 2}};
    CHECK(times.of(0).value == 4);
    CHECK(times.ratio(0, 1).value == 2);
    CHECK(times.ratio(0, 1).is_settled());
    CHECK(at_least(times.ratio(0, 1), 1.95) == Verdict::holds);
    times.cpu_share = 0.6;
    CHECK(times.ratio(0, 1).value == 2);
    CHECK(!times.ratio(0, 1).is_settled());
    CHECK(at_least(times.ratio(0, 1), 1.95) == Verdict::inconclusive);
}

TEST_CASE("cinch scaling: every method at every size, figures with their targets")
{
    const test::Run run = test::cinch("scaling --json --seconds 0.01");
    REQUIRE(run.status == 0);
    std::map<std::string, int> sizes;
    int figures = 0;
    for (const json& r : records(run)) {
        CHECK(r["experiment"] == "scaling");
        CHECK(r["cpu"].is_string());
        if (r.contains("figure")) {
            CHECK((r["reached"].is_boolean() || r["verdict"] == "inconclusive"));
            ++figures;
            continue;
        }
        CHECK(r["ns_per_bound"] > 0);
        CHECK(r["paper_us"] > 0);
        if (r["method"] == "best")
            CHECK(r["over_default"] == 1);
        if (r["method"] == "optimal" || r["method"] == "textbook")
            CHECK(r["over_default"] > 2);
        ++sizes[r["method"]];
    }
    CHECK(figures >= 8);
    for (const char* method : {"textbook", "optimal", "convex", "sphere", "corners", "eq12", "limited", "local",
                               "support", "linear", "best"})
        CHECK(sizes[method] == 9);
}

TEST_CASE("cinch tightness: ratios, attribution that adds up, CSV and charts")
{
    const test::TemporaryFolder folder;
    const std::string chart = (folder.path() / "t.svg").string();
    const test::Run run = test::cinch("tightness santa --nodes 60 --frames 2 --leaf 32 --sweep 8,40 --methods "
                                      "eq12,limited,support+linear,best --json --plot " +
                                      chart);
    REQUIRE(run.status == 0);
    std::set<std::string> motions, methods;
    std::set<int> swept;
    for (const json& r : records(run)) {
        if (r.contains("figure"))
            continue;
        motions.insert(r["motion"]);
        methods.insert(r["method"]);
        CHECK(r["mean_ratio"] >= 1 - 1e-12);
        CHECK(r["max_ratio"] >= r["mean_ratio"]);
        if (r.contains("box_loss"))
            CHECK(r["box_loss"] >= -1e-12);
        else
            swept.insert(r["n"].get<int>());
    }
    CHECK(motions == std::set<std::string>{"strong", "mild"});
    CHECK(methods == std::set<std::string>{"eq12", "limited", "support+linear", "best"});
    CHECK(swept == std::set<int>{8, 40});
    const std::string svg = slurp(chart);
    CHECK_THAT(svg, Catch::Contains("<svg") && Catch::Contains("BVH level") && Catch::Contains("true radius") &&
                        Catch::Contains("support+linear"));

    const test::Run csv =
        test::cinch("tightness fish --nodes 20 --frames 1 --leaf 500 --motion mild --sweep 8 --methods best --csv");
    REQUIRE(csv.status == 0);
    REQUIRE(csv.lines().size() > 2);
    CHECK_THAT(csv.lines()[0], Catch::StartsWith("experiment,input,motion,method,n,level,bvs,mean_ratio,max_ratio"));
    const auto shared = test::shared("meshes/skin/CesiumMan.glb");
    if (!shared)
        return;
    CHECK(test::cinch("tightness '" + shared->string() + "' --frames 2 --leaf 64").status == 0);
    CHECK(test::cinch("tightness '" + shared->string() + "' --sweep 8").status == 2);
}

TEST_CASE("cinch cost: every arithmetic with its guarantee, exact where it says so, and the gap by passes")
{
    const test::Run run =
        test::cinch("cost santa --nodes 30 --frames 2 --leaf 200 --kdops 6,26 --seconds 0.01 --this-input-only --json");
    REQUIRE(run.status == 0);
    std::map<std::string, std::set<std::string>> arithmetics; // by method
    std::map<int, int> passes;
    bool any_pareto = false, plain_falls_below = false;
    for (const json& r : records(run)) {
        if (r.contains("passes")) {
            CHECK(r["gap_percent"] >= -1e-9);
            ++passes[r["passes"].get<int>()];
        }
        if (!r.contains("arithmetic"))
            continue;
        arithmetics[r["method"]].insert(r["arithmetic"]);
        CHECK(r["ns_per_bound"] > 0);
        any_pareto |= r["pareto"].get<bool>();
        if (r["guarantee"] == "proven" || r["guarantee"] == "exact")
            CHECK(r["below_exact"] == 0);
        else
            plain_falls_below |= r["below_exact"] > 0;
    }
    CHECK(any_pareto);
    CHECK(plain_falls_below); // or the proof would be for nothing
    for (const char* method : {"convex", "eq12", "limited"})
        for (const char* arithmetic :
             {"float", "double", "double, proven", "interval", "double-double", "MPFR 128", "int128 grid", "rational",
              "lazy exact", "float kernel", "float kernel, proven", "double kernel", "double kernel, proven"})
            CHECK(arithmetics[method].count(arithmetic) == 1);
    for (const char* method : {"local", "support", "linear", "best"})
        CHECK(arithmetics[method].count("float kernel, proven") == 1);
    for (int p = 0; p < 5; ++p)
        CHECK(passes[p] > 0);
}

TEST_CASE("cinch cost: a bound of the root that tightens, from one bound to the true box")
{
    const test::Run run = test::cinch("cost santa --nodes 30 --frames 2 --leaf 20 --kdops 6,14 --seconds 0.01 "
                                      "--budget 1,2e5 --tolerance 0.1,0 --this-input-only --json");
    REQUIRE(run.status == 0);
    std::map<std::pair<int, std::string>, double> ratio; // by k, and where it stops
    bool any_pareto = false;
    for (const json& r : records(run)) {
        if (!r.contains("level"))
            continue;
        CHECK(r["level"] == 0);
        CHECK(r["mean_ratio"] >= 1 - 1e-12);
        if (r["method"] != "anytime")
            continue;
        CHECK(r["guarantee"] == "proven");
        CHECK(r["below_exact"] == 0);
        ratio[{r["kdop"], r["arithmetic"]}] = r["mean_ratio"];
        any_pareto |= r["pareto"].get<bool>();
    }
    CHECK(any_pareto);
    for (const int k : {6, 14}) {
        CHECK(ratio[{k, "one bound"}] > 1.01);
        CHECK(ratio[{k, "1 ns"}] <= ratio[{k, "one bound"}]);
        CHECK(ratio[{k, "200,000 ns"}] < ratio[{k, "one bound"}]);
        CHECK(ratio[{k, "within 10 %"}] < 1.1);
        CHECK(ratio[{k, "true box"}] == Approx(1).epsilon(1e-9));
    }
    CHECK(ratio.size() == 10);
    CHECK(test::cinch("cost santa --budget -5").status == 2);
    CHECK(test::cinch("cost santa --tolerance x").status == 2);
}

TEST_CASE("the instruction set can be forced, and changes no bound")
{
    std::set<std::string> outputs;
    for (const std::string& target : kernel_targets()) {
        const test::Run run =
            test::cinch_with("CINCH_TARGET=" + target, "verify santa --nodes 30 --frames 2 --leaf 50 --json");
        REQUIRE(run.status == 0);
        std::string all;
        for (json r : records(run)) {
            if (r.contains("simd_target"))
                CHECK(r["simd_target"] == target);
            r.erase("simd_target");
            r.erase("seconds");
            all += r.dump() + "\n";
        }
        outputs.insert(all);
    }
    CHECK(outputs.size() == 1);
    const test::Run none = test::cinch_with("CINCH_TARGET=none", "verify santa");
    CHECK(none.status == 2);
    CHECK_THAT(none.err, Catch::StartsWith("cinch: CINCH_TARGET=none: this machine has "));
}
