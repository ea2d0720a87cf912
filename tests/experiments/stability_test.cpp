// SPDX-License-Identifier: GPL-3.0-or-later
// Every hard case passes, with the bounds of the states that it leads to; and the safeguards are needed.
#include <catch2/catch.hpp>

#include <set>

#include <nlohmann/json.hpp>

#include "experiments/stability/stability.hpp"
#include "tests/support.hpp"

using namespace cinch;

TEST_CASE("hard cases")
{
    const auto cases = stability_cases();
    std::set<std::string> numbers;
    for (const StabilityCase& c : cases) {
        numbers.insert(c.name.substr(0, 2));
        SECTION(c.name)
        {
            const StabilityOutcome outcome = c.run(Missing::nothing);
            INFO(c.expected << "; observed: " << outcome.observed);
            CHECK(outcome.pass);
            const StabilityProof proof = prove(outcome.states);
            CHECK(proof.proven == proof.bounds);
            CHECK((proof.bounds > 0) == !outcome.states.empty());
        }
    }
    CHECK(numbers.size() >= 35);
}

TEST_CASE("cases that need a safeguard fail without it")
{
    struct Need {
        Missing missing;
        std::vector<std::string> cases;
    };
    for (const Need& need :
         {Need{Missing::hourglass, {"36 alternating motion", "20 collapsed start"}},
          Need{Missing::completion, {"01 coplanar nodes", "01 collinear nodes"}},
          Need{Missing::projection, {"14 reflected start", "20 inverted start", "20 collapsed start"}}})
        for (const StabilityCase& c : stability_cases())
            if (std::find(need.cases.begin(), need.cases.end(), c.name) != need.cases.end()) {
                INFO(c.name);
                CHECK_FALSE(c.run(need.missing).pass);
            }
}

TEST_CASE("the command stability")
{
    const auto run = test::cinch("stability --case 26,subnormals --json");
    CHECK(run.status == 0);
    REQUIRE(run.lines().size() == 2);
    const auto record = nlohmann::json::parse(run.lines()[0]);
    for (const char* field : {"case", "expected", "observed", "pass"})
        CHECK(record.contains(field));
    CHECK(test::cinch("stability --case coplanar --without completion").status == 1);
    CHECK(test::cinch("stability --case nosuchcase").status == 2);
    CHECK(test::cinch("stability --without seatbelt").status == 2);
    CHECK(test::cinch("stability --list").lines().size() >= 38);
}
