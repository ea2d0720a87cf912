// SPDX-License-Identifier: GPL-3.0-or-later
// Views: what is drawn is a bound of what is drawn, on the grid, in integers; pages are whole, safe and small.
#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include "experiments/report/view.hpp"
#include "experiments/report/view/grid.hpp"
#include "experiments/report/view/pack.hpp"

#include "tests/support.hpp"

using namespace cinch;
using Json = nlohmann::ordered_json;

namespace {

Vec3 random_point(std::mt19937_64& random, double size)
{
    std::uniform_real_distribution<double> uniform(-size, size);
    return {uniform(random), uniform(random), uniform(random)};
}

std::string read(const std::filesystem::path& path)
{
    std::ifstream in(path, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    return std::move(text).str();
}

} // namespace

TEST_CASE("a support rounded to the grid of a view bounds every point on it that the support bounds")
{
    std::mt19937_64 random(3);
    std::size_t touched = 0;
    for (const double size : {1e-3, 1.0, 777.0})
        for (const double far : {0.0, 1e6})
            for (const int bits : {8, 14, 16}) {
                const Vec3 about(far, -far, far / 3);
                const Grid grid = Grid::make(about - Vec3::Constant(size), about + Vec3::Constant(size), bits);
                for (int i = 0; i < 2000; ++i) {
                    const Vec3 v = about + random_point(random, size);
                    const auto g = grid.point(v);
                    for (const std::int32_t x : g)
                        REQUIRE((x >= 0 && x < 1 << bits));
                    for (const Axis& axis : axes_of(26))
                        for (const bool against : {false, true}) {
                            const int sign = against ? -1 : 1;
                            // the support of the point itself: a double at least the exact one
                            const long double exact = sign * (axis[0] * static_cast<long double>(v[0]) + axis[1] * static_cast<long double>(v[1]) + axis[2] * static_cast<long double>(v[2]));
                            const double support = std::nextafter(static_cast<double>(exact), 1e300);
                            const std::int32_t bound = grid.support(axis, against, support);
                            const std::int32_t along = sign * (axis[0] * g[0] + axis[1] * g[1] + axis[2] * g[2]);
                            REQUIRE(along <= bound);
                            touched += along == bound;
                        }
                }
                CHECK(grid.support(axes_of(6)[0], false, std::numeric_limits<double>::infinity()) == Grid::unbounded);
            }
    CHECK(touched > 1000); // no more room than needed
}

TEST_CASE("a view has every frame, level and method asked for, and its bounds change with the method")
{
    ViewRequest request;
    request.scene = "santa-ring-1";
    request.frames = 5;
    request.levels = 4;
    request.kdop = 14;
    request.methods = {Method::best, Method::eq12};
    const Json view = make_view(request);
    CHECK(view["time_s"].size() == 5);
    CHECK(view["bvs"]["level"].size() == 5);
    CHECK(view["bvs"]["level"][1] == 6);
    CHECK(view["bodies"].size() == 6);
    CHECK(view["bounds"].size() == 2);
    CHECK(view["bounds"]["best"]["shape"] == Json({5, view["bvs"]["first"].size(), 14}));
    CHECK(view["bounds"]["best"]["data"] != view["bounds"]["eq12"]["data"]);
    CHECK(view["positions"]["shape"][0] == 5);
    CHECK(view["contacts"]["pairs"].size() == 5);
    CHECK(make_view(request) == view);
}

TEST_CASE("a page of a view is one file that asks for nothing, and hostile titles stay text")
{
    test::TemporaryFolder folder;
    const std::filesystem::path page = folder.path() / "v.html";
    const test::Run run = test::cinch("view brain-3500 --frames 3 --report " + page.string());
    CHECK(run.status == 0);
    const std::string text = read(page);
    CHECK(text.size() < 3'000'000);
    CHECK(text.find("content=\"default-src 'none'; script-src 'unsafe-inline'") != std::string::npos);
    for (const char* address : {"src=\"http", "href=\"http"})
        CHECK(text.find(address) == std::string::npos);
    ViewRequest request;
    request.scene = "brain-3500";
    request.frames = 2;
    request.levels = 2;
    request.methods = {Method::best};
    request.title = "</script><img src=x onerror=alert(1)>";
    request.text = "<b>&\"";
    const std::vector<Json> views{make_view(request)};
    const std::string hostile = view_page(views);
    CHECK(hostile.find("<img src=x") == std::string::npos);
    CHECK(hostile.find("&lt;/script&gt;&lt;img") != std::string::npos);
}

TEST_CASE("a view of what is not there, or a file that cannot be written, is an error with a remedy")
{
    test::TemporaryFolder folder;
    const test::Run missing = test::cinch("view no-such-thing --report " + (folder.path() / "v.html").string());
    CHECK(missing.status == 2);
    CHECK(missing.err.starts_with("cinch: "));
    const test::Run unwritable = test::cinch("view brain-3500 --report /no/such/folder/v.html");
    CHECK(unwritable.status == 2);
    CHECK_THAT(unwritable.err, Catch::Contains("/no/such/folder/v.html"));
}
