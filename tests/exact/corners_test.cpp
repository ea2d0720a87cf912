// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <fstream>
#include <random>
#include <set>
#include <sstream>

#include <catch2/catch.hpp>

#include "exact/corners.hpp"
#include "exact/number.hpp"
#include "tests/support.hpp"

using namespace cinch;
using namespace cinch::exact;

namespace {

using Corners = std::set<std::vector<std::string>>;

struct Space {
    std::vector<double> l, h;
    WeightSpace view() const { return {l, h}; }
};

enum Family { generic, coarse, fixed, narrow, tiny, far_apart, family_count };

Space draw(int family, std::size_t n, std::mt19937_64& random)
{
    auto uniform = [&] { return std::uniform_real_distribution<double>(0, 1)(random); };
    Space s;
    for (std::size_t j = 0; j < n; ++j) {
        double a = uniform(), b = uniform();
        const double mean = 1 / static_cast<double>(n);
        switch (family) {
        case generic:
            a *= mean;
            break;
        case coarse:
            a = static_cast<double>(random() % 3) / 16, b = static_cast<double>(random() % 9) / 8;
            break;
        case fixed:
            a = random() % 2 ? b = 0.125 : 0;
            break;
        case narrow:
            a = mean * (0.9 + 0.1 * a), b = mean * (1 + 0.1 * b);
            break;
        case tiny:
            a = std::ldexp(a, -1070), b = random() % 2 ? 1 : std::ldexp(b, -1060);
            break;
        case far_apart:
            a = std::ldexp(a, -80), b = std::ldexp(b, -static_cast<int>(random() % 3));
            break;
        }
        s.l.push_back(std::min({a, b, 1.0}));
        s.h.push_back(std::min(1.0, std::max(a, b)));
    }
    return s;
}

Corners visited(const Space& s)
{
    Corners all;
    const std::uint64_t count = visit_corners(s.view(), [&](const CornerRun& run, const Corner& corner) {
        REQUIRE(all.insert(weights_of(s.view(), run, corner)).second); // each once
        return true;
    });
    REQUIRE(count == all.size());
    return all;
}

// One free coordinate, the others at l or h, whatever lands in range.
Corners brute_force(const Space& s)
{
    Corners all;
    const std::size_t n = s.l.size();
    for (std::size_t free = 0; free < n; ++free)
        for (std::size_t choice = 0; choice < (std::size_t{1} << n); ++choice) {
            std::vector<Exact> w(n);
            Exact rest(1);
            for (std::size_t j = 0; j < n; ++j)
                if (j != free)
                    rest = rest - (w[j] = Exact(choice >> j & 1 ? s.h[j] : s.l[j]));
            w[free] = rest;
            if (rest < Exact(s.l[free]) || rest > Exact(s.h[free]))
                continue;
            std::vector<std::string> text;
            for (const Exact& x : w)
                text.push_back(as_fraction(x));
            all.insert(text);
        }
    return all;
}

} // namespace

TEST_CASE("the corners are those that brute force finds, each once, and are counted right")
{
    std::mt19937_64 random(17);
    std::size_t most = 0;
    for (int family = 0; family < family_count; ++family)
        for (int trial = 0; trial < 150; ++trial) {
            const Space s = draw(family, 1 + random() % 7, random);
            const Corners all = visited(s);
            REQUIRE(all == brute_force(s));
            REQUIRE(count_corners(s.view()).count == std::to_string(all.size()));
            REQUIRE(is_feasible(s.view()) == !all.empty());
            most = std::max(most, all.size());
        }
    CHECK(most > 50);
}

TEST_CASE("counts equal the listing for n up to 18")
{
    std::mt19937_64 random(19);
    for (int family = 0; family < family_count; ++family)
        for (std::size_t n : {10u, 14u, 18u}) {
            const Space s = draw(family, n, random);
            CHECK(count_corners(s.view()).count ==
                  std::to_string(visit_corners(s.view(), [](const auto&, const auto&) { return true; })));
        }
}

TEST_CASE("hypersimplices have binomially many corners, and large ones are counted on their grid")
{
    auto hypersimplex = [](std::size_t n, double h) {
        return Space{std::vector<double>(n, 0), std::vector<double>(n, h)};
    };
    CHECK(count_corners(hypersimplex(8, 0.25).view()).count == "70");
    CHECK(visit_corners(hypersimplex(16, 0.125).view(), [](const auto&, const auto&) { return true; }) == 12870);
    CHECK(count_corners(hypersimplex(64, 0.5).view()).count == "2016");
    CHECK(count_corners(hypersimplex(64, 0x1p-5).view()).count == "1832624140942590534"); // 64 choose 32
    CHECK(count_corners(hypersimplex(44, 1).view()).count == "44");
    // h a little above ½: one weight at h, another takes the rest
    CHECK(count_corners(hypersimplex(5, 0.75).view()).count == "20");
}

TEST_CASE("what cannot be counted says so at once, and listing it can be stopped")
{
    std::mt19937_64 random(23);
    const Space s = draw(generic, 200, random);
    const CornerCount count = count_corners(s.view());
    CHECK_FALSE(count.count);
    CHECK_THAT(count.reason, Catch::StartsWith("not counted: 200 weights are free"));
    int listed = 0;
    CHECK(visit_corners(s.view(), [&](const auto&, const auto&) { return ++listed < 1000; }) == 1000);
}

TEST_CASE("corner sets equal those of lrs on 200 random cases")
{
    if (std::system("command -v lrs >/dev/null") != 0) {
        WARN("lrs is not installed; package lrslib");
        FAIL();
    }
    std::mt19937_64 random(29);
    const test::TemporaryFolder folder;
    int compared = 0;
    for (int trial = 0; compared < 200; ++trial) {
        const std::size_t n = 2 + random() % 7;
        const Space s = draw(trial % 4, n, random);
        if (!is_feasible(s.view()))
            continue; // lrs prints no vertices then, as do we
        std::string input = "case\nH-representation\nlinearity 1 " + std::to_string(2 * n + 1) + "\nbegin\n" +
                            std::to_string(2 * n + 1) + " " + std::to_string(n + 1) + " rational\n";
        auto row = [&](const std::string& constant, std::size_t j, const char* sign) {
            input += constant;
            for (std::size_t i = 0; i < n; ++i)
                input += i == j ? std::string(" ") + sign : " 0";
            input += "\n";
        };
        for (std::size_t j = 0; j < n; ++j) {
            row(as_fraction(-Exact(s.l[j])), j, "1");
            row(as_fraction(Exact(s.h[j])), j, "-1");
        }
        input += "-1";
        for (std::size_t j = 0; j < n; ++j)
            input += " 1";
        const auto path = folder.write("case.ine", input + "\nend\n");
        const auto out = folder.path() / "case.ext";
        REQUIRE(std::system(("lrs '" + path.string() + "' > '" + out.string() + "' 2>/dev/null").c_str()) == 0);

        Corners found; // after the last "begin": lrs starts anew in wider arithmetic
        std::ifstream in(out);
        for (std::string line; std::getline(in, line);) {
            if (line.starts_with("begin"))
                found.clear();
            std::istringstream words(line);
            std::vector<std::string> corner;
            std::string word;
            if (!(words >> word) || word != "1")
                continue;
            while (words >> word)
                corner.push_back(word.find('/') == std::string::npos ? word + "/1" : word);
            if (corner.size() == n)
                found.insert(corner);
        }
        REQUIRE(found == visited(s));
        ++compared;
    }
}
