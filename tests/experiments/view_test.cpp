// SPDX-License-Identifier: GPL-3.0-or-later
// The data of 3-D views, unpacked again here as view.js does, and compared as integers.
#include <catch2/catch.hpp>

#include <array>
#include <filesystem>
#include <fstream>

#include <zlib.h>

#include "cinch/surface.hpp"
#include "experiments/report/view.hpp"
#include "experiments/report/view/grid.hpp"
#include "experiments/report/view/pack.hpp"
#include "tests/support.hpp"

using namespace cinch;
using Json = nlohmann::ordered_json;

namespace {

std::vector<std::uint8_t> bytes_of(const std::string& base64)
{
    std::vector<std::uint8_t> out;
    std::uint32_t bits = 0;
    int count = 0;
    for (const char c : base64) {
        if (c == '=')
            break;
        bits = bits << 6 | static_cast<std::uint32_t>(c == '+'   ? 62
                                                      : c == '/' ? 63
                                                      : c >= 'a' ? c - 'a' + 26
                                                      : c >= 'A' ? c - 'A'
                                                                 : c - '0' + 52);
        if ((count += 6) >= 8)
            out.push_back(static_cast<std::uint8_t>(bits >> (count -= 8)));
    }
    return out;
}

struct Unpacked {
    std::size_t frames, items, components;
    std::vector<std::int32_t> value;
    std::int32_t at(std::size_t f, std::size_t i, std::size_t c) const
    {
        return value[(f * items + i) * components + c];
    }
};

Unpacked unpack(const Json& packed, std::span<const References> references = {})
{
    Unpacked out{packed["shape"][0], packed["shape"][1], packed["shape"][2], {}};
    const std::size_t frame = out.items * out.components, count = out.frames * frame, planes = packed["planes"];
    const std::vector<std::uint8_t> small = bytes_of(packed["data"]);
    std::vector<std::uint8_t> bytes(planes * count + 1);
    uLongf size = bytes.size();
    REQUIRE(uncompress(bytes.data(), &size, small.data(), small.size()) == Z_OK);
    REQUIRE(size == planes * count);
    std::vector<std::uint32_t> x(count);
    for (std::size_t i = 0; i < count; ++i) {
        std::uint32_t z = 0;
        for (std::size_t p = planes; p-- > 0;)
            z = z << 8 | bytes[p * count + i];
        x[i] = z >> 1 ^ (z & 1 ? ~0u : 0u);
    }
    for (std::size_t f = 0; f < out.frames; ++f)
        for (std::size_t i = 1; i < out.items; ++i)
            for (std::size_t c = 0; c < out.components; ++c) {
                auto change = [&](std::size_t item) { return x[f * frame + item * out.components + c]; };
                x[f * frame + i * out.components + c] +=
                    references.empty() ? change(i - 1)
                                       : change(references[i].a) + change(references[i].b) - change(references[i].c);
            }
    for (std::size_t i = frame; i < count; ++i)
        x[i] += x[i - frame];
    out.value.assign(x.begin(), x.end());
    return out;
}

std::vector<std::uint32_t> corners_of(const Json& view)
{
    std::vector<std::uint32_t> out;
    std::uint32_t next = 0;
    for (const std::int32_t below : unpack(view["corners"]).value) {
        out.push_back(next - static_cast<std::uint32_t>(below));
        next = std::max(next, out.back() + 1);
    }
    return out;
}

ViewRequest request(const std::string& scene, std::size_t frames)
{
    ViewRequest out;
    out.scene = scene;
    out.frames = frames;
    return out;
}

} // namespace

TEST_CASE("what is packed comes back, the greatest and the least integers too")
{
    const std::vector<std::int32_t> values{0, -1, 1 << 30, -(1 << 30), INT32_MAX, INT32_MIN, 7, 7, 7, -300, 65535, 2};
    for (const auto& [f, i, c] : {std::array<std::size_t, 3>{1, 12, 1}, {12, 1, 1}, {2, 2, 3}, {3, 4, 1}}) {
        CAPTURE(f, i, c);
        CHECK(unpack(pack(values, f, i, c)).value == values);
    }
    const std::vector<std::uint32_t> corners{0, 1, 2, 2, 1, 3};
    const auto references = parallelograms(corners, 4);
    CHECK((references[3].a == 2 && references[3].b == 1 && references[3].c == 0));
    CHECK(unpack(pack(values, 3, 4, 1, references), references).value == values);
    CHECK(unpack(pack({}, 5, 0, 3)).value.empty());
    CHECK_THROWS_AS(pack(values, 1, 1, 1), std::invalid_argument);
}

TEST_CASE("the grid rounds supports so far outward that they hold for rounded points")
{
    for (const double far : {0.0, 1e8})
        for (const double size : {1.0, 1e-3, 3e5}) {
            const Vec3 low(far - size, far, far), high(far + size, far + 0.3 * size, far + size);
            const Grid grid = Grid::make(low, high, 12);
            std::uint32_t state = 1;
            std::size_t tight = 0;
            for (int i = 0; i < 2000; ++i) {
                Vec3 v;
                for (int r = 0; r < 3; ++r)
                    v[r] =
                        low[r] + (high[r] - low[r]) * ((state = state * 1664525u + 1013904223u) >> 8) / double(1 << 24);
                const auto g = grid.point(v);
                for (int r = 0; r < 3; ++r) {
                    REQUIRE(g[static_cast<std::size_t>(r)] >= 0);
                    REQUIRE(g[static_cast<std::size_t>(r)] < 1 << 12);
                }
                for (const Axis& a : all_axes)
                    for (const bool against : {false, true}) {
                        const int sign = against ? -1 : 1;
                        const double along = sign * (a[0] * v[0] + a[1] * v[1] + a[2] * v[2]);
                        const std::int32_t bound =
                            grid.support(a, against, std::nextafter(std::nextafter(along, HUGE_VAL), HUGE_VAL));
                        const std::int32_t drawn = sign * (a[0] * g[0] + a[1] * g[1] + a[2] * g[2]);
                        REQUIRE(drawn <= bound);
                        REQUIRE(bound <= drawn + 4);
                        tight += drawn == bound;
                    }
            }
            CHECK(tight > 0); // so less would be too little
            CHECK(grid.support({1, 0, 0}, false, HUGE_VAL) == Grid::unbounded);
            CHECK(grid.support({1, 0, 0}, true, 1e300) == Grid::unbounded);
        }
}

TEST_CASE(
    "what is drawn of every bound contains what is drawn of the surface, by every method, frame, level and direction")
{
    ViewRequest santas = request("santa-ring-1", 8), brain = request("brain-3500", 6), sheet = request("sheet", 5);
    santas.levels = 5;
    santas.kdop = 18;
    santas.bits = 9; // coarse: here rounding is much of a bound
    brain.kdop = 26;
    brain.nodes = 65;
    sheet.kdop = 14;
    sheet.swept = santas.swept = true;
    for (const ViewRequest& r : {santas, brain, sheet}) {
        CAPTURE(r.scene);
        const Json view = make_view(r);
        const std::vector<std::uint32_t> corners = corners_of(view);
        const std::size_t vertices = view["positions"]["shape"][1], frames = view["time_s"].size(),
                          bvs = view["bvs"]["first"].size();
        REQUIRE(frames == r.frames);
        const Unpacked positions = unpack(view["positions"], parallelograms(corners, vertices));
        const auto axes = axes_of(r.kdop);
        const auto k = static_cast<std::size_t>(r.kdop);
        std::vector<std::int32_t> truth(frames * bvs * k, INT32_MIN);
        for (std::size_t f = 0; f < frames; ++f)
            for (std::size_t b = 0; b < bvs; ++b) {
                const std::size_t first = view["bvs"]["first"][b], count = view["bvs"]["count"][b];
                for (std::size_t i = 3 * first; i < 3 * (first + count); ++i)
                    for (std::size_t d = 0; d < k; ++d) {
                        std::int32_t along = 0;
                        for (std::size_t c = 0; c < 3; ++c)
                            along += axes[d / 2][c] * positions.at(f, corners[i], c);
                        std::int32_t& most = truth[(f * bvs + b) * k + d];
                        most = std::max(most, d % 2 ? -along : along);
                    }
            }
        REQUIRE(view["bounds"].size() == r.methods.size() + (r.swept ? 1 : 0));
        CHECK(view["bounds"].contains("all times") == r.swept);
        for (const auto& [method, packed] : view["bounds"].items()) {
            CAPTURE(method);
            const Unpacked bounds = unpack(packed);
            REQUIRE(bounds.value.size() == truth.size());
            std::size_t outside = 0, finite = 0;
            for (std::size_t i = 0; i < truth.size(); ++i) {
                outside += truth[i] > bounds.value[i];
                finite += bounds.value[i] < Grid::unbounded;
            }
            CHECK(outside == 0);
            CHECK(finite == truth.size());
        }
        // Each level covers every triangle of the levels above it.
        const auto level = view["bvs"]["level"].get<std::vector<std::size_t>>();
        for (std::size_t l = 0; l + 1 < std::min<std::size_t>(level.size(), 4); ++l) {
            std::size_t all = 0;
            for (std::size_t b = level[l]; b < level[l + 1]; ++b)
                all += view["bvs"]["count"][b].get<std::size_t>();
            CHECK(3 * all == corners.size());
        }
    }
}

TEST_CASE("intersecting triangles of a view are those of its pairs, and other bodies' too")
{
    const Json view = make_view(request("santa-ring-5", 6));
    const auto pairs = view["contacts"]["pairs"].get<std::vector<std::size_t>>(),
               count = view["contacts"]["count"].get<std::vector<std::size_t>>();
    const Unpacked touching = unpack(view["contacts"]["triangles"]);
    REQUIRE(pairs.size() == 6);
    std::size_t first = 0, frames_with_some = 0, triangles = 0;
    for (const Json& body : view["bodies"])
        triangles += body["triangles"].get<std::size_t>();
    for (std::size_t f = 0; f < 6; ++f) {
        CHECK((pairs[f] == 0) == (count[f] == 0));
        CHECK(count[f] <= 2 * pairs[f]);
        for (std::size_t i = first; i < first + count[f]; ++i) {
            CHECK(static_cast<std::size_t>(touching.value[i]) < triangles);
            CHECK((i == first || touching.value[i - 1] < touching.value[i]));
        }
        first += count[f];
        frames_with_some += count[f] > 0;
    }
    CHECK(first == touching.value.size());
    CHECK(frames_with_some > 0);
}

TEST_CASE("cinch view writes a page that is complete, small, and without a word for the network")
{
    test::TemporaryFolder folder;
    const std::string page = (folder.path() / "page.html").string();
    const auto run = test::cinch("view brain-pull --frames 20 --bits 14 --report " + page);
    REQUIRE(run.status == 0);
    CHECK(run.out.find("20 frames") != std::string::npos);
    CHECK(std::filesystem::file_size(page) < 8000000);
    std::ifstream in(page);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    CHECK(text.find("</html>") != std::string::npos);
    CHECK(text.find(" src=") == std::string::npos);
    CHECK(text.find("@import") == std::string::npos);
    if (!has_three())
        CHECK(text.find("apt-get install libjs-three") != std::string::npos);
}

TEST_CASE("cinch view says what is wrong in one line")
{
    test::TemporaryFolder folder;
    const std::string page = " --report " + (folder.path() / "p.html").string();
    auto refused = [&](const std::string& arguments, const std::string& why) {
        const auto run = test::cinch("view " + arguments);
        INFO(run.err);
        CHECK(run.status == 2);
        CHECK(run.err.find(why) != std::string::npos);
        CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
    };
    refused("nothing" + page, "no such file, and no shape");
    refused("nothing.json" + page, "no such file");
    refused("brain-3500", "--report");
    refused("brain-3500 --report /nonexistent/p.html", "cannot be written");
    refused("brain-3500 --frames 0" + page, "--frames");
    refused("brain-3500 --kdop 7" + page, "--kdop");
    refused("brain-3500 --methods nothing" + page, "expected names of convex");
    refused("brain-3500 --methods vertices" + page, "expected names of convex");
    refused("--frames 5" + page, "--frames");
    CHECK(std::filesystem::is_empty(folder.path()));
    CHECK_THROWS_AS(make_view(request("nothing", 5)), InputError);
}

TEST_CASE("a view of one's own weights and transforms")
{
    const test::TemporaryFolder folder;
    const std::string mesh = folder.write("m.obj",
                                          "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"),
                      weights = folder.write("w.txt", "4 2\n1 0 1\n1 1 1\n2 0 0.5 1 0.5\n1 0 1\n"),
                      clips = folder.write("t.txt", "2\nstill 1 2\n0 1 0 0 0 0 1 0 0 0 0 1 0 1 0 0 0 0 1 0 0 0 0 1 0\n"
                                                    "move 2 2\n0 1 0 0 0 0 1 0 0 0 0 1 0 1 0 0 0 0 1 0 0 0 0 1 0\n"
                                                    "1 1 0 0 0 0 1 0 0 0 0 1 0 1 0 0 5 0 1 0 0 0 0 1 0\n");
    const std::string skin = "view " + mesh + " --weights " + weights + " --transforms " + clips;
    const test::Run run = test::cinch(skin + " --clip move --json");
    REQUIRE(run.status == 0);
    const Json view = Json::parse(run.lines().at(0));
    CHECK(view.at("frames") == 2);
    CHECK(view.at("view").at("time_s").size() == 2);
    CHECK(test::cinch(skin + " --clip jump --json").status == 2);
    CHECK(test::cinch("view " + mesh + " --weights " + weights + " --json").status == 2);
}
