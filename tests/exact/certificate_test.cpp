// SPDX-License-Identifier: GPL-3.0-or-later
// What a certificate says of itself. Its proofs are checked by tests/experiments/certificate_test.py.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "cinch/refit.hpp"
#include "exact/certificate.hpp"
#include "exact/sha256.hpp"
#include "tests/support.hpp"

using namespace cinch;
using namespace cinch::exact;
using nlohmann::json;

TEST_CASE("SHA-256 of the standard's examples, and of numbers from the least significant byte on")
{
    Sha256 hash;
    CHECK(hash.hex() == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    hash.add("abc");
    CHECK(hash.hex() == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    for (int i = 0; i < 1000; ++i)
        hash.add(std::string(1000, 'a'));
    CHECK(hash.hex() == "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
    hash.add(std::uint32_t{0x64636261});
    hash.add(1.0);
    Sha256 bytes;
    bytes.add(std::string_view("abcd\0\0\0\0\0\0\xf0\x3f", 12));
    CHECK(hash.hex() == bytes.hex());
}

TEST_CASE("a certificate counts its bounds, says what is missing, and has an end only when all of its frames are there")
{
    const test::Example e = test::example(60, 6);
    const Bvh bvh = build_bvh(e.surface, 8);
    std::vector<double> supports(bvh.bvs.size() * 6);
    refit(bvh, e.surface, e.frames[1], {Method::limited, 6}, supports);
    const FrameVerdict good = Verifier(e.surface, bvh).check(e.frames[1], Method::limited, 6, supports);

    std::vector<json> lines;
    const Claim claim{Method::limited, 6, RestShape::aabb, "walk", 2, {"morph \"a\"\n", "\xff"}};
    CertificateWriter writer(e.surface, bvh, claim, [&](std::string_view line) { lines.push_back(json::parse(line)); });
    const json header = lines.front();
    CHECK(header["partial"] == true);
    CHECK(header["missing"] == json({"morph \"a\"\n", "\xef\xbf\xbd"})); // not UTF-8: the replacement character
    Sha256 method;
    method.add("7:cinch 27:limited4:aabb1:64:walk10:morph \"a\"\n3:\xef\xbf\xbd");
    CHECK(header["sha256"]["method"] == method.hex());
    CHECK(lines.size() == 1 + e.surface.mesh.vertices.size() + e.surface.mesh.triangles.size() + bvh.bvs.size());

    writer.frame({0.5, e.frames[1]}, supports, good);
    CHECK_THROWS_AS(writer.end(), std::logic_error);
    supports[3] = std::numeric_limits<double>::infinity();
    supports[7] -= 10;
    FrameVerdict bad = Verifier(e.surface, bvh).check(e.frames[1], Method::limited, 6, supports);
    REQUIRE(bad.failed[7] != 0);
    writer.frame({1, e.frames[1]}, supports, bad);
    CHECK_THROWS_AS(writer.frame({2, e.frames[1]}, supports, bad), std::invalid_argument);
    writer.end();
    const json end = lines.back();
    CHECK(end["proven"] == 2 * supports.size() - 2);
    CHECK(end["infinite"] == 1);
    CHECK(end["violated"] == 1);
    CHECK(lines[lines.size() - bvh.bvs.size() - 1]["bounds"][3] == "inf");
}

TEST_CASE("only methods that are proven by duality have lambdas")
{
    const test::Example e = test::example(60, 6);
    const Bvh bvh = build_bvh(e.surface, 8);
    for (const RestShape shape : {RestShape::aabb, RestShape::obb})
        for (const Methods methods : {Methods(Method::eq12), Method::eq12 | Method::convex,
                                      Method::eq12 | Method::local, Methods(Method::best)}) {
            std::vector<double> supports(bvh.bvs.size() * 14);
            RefitOptions options{methods, 14};
            options.rest_shape = shape;
            refit(bvh, e.surface, e.frames[1], options, supports);
            const FrameVerdict verdict = Verifier(e.surface, bvh).check(e.frames[1], methods, 14, supports, shape);
            std::vector<json> lines;
            CertificateWriter writer(e.surface, bvh, {methods, 14, shape, "", 1, {}},
                                     [&](std::string_view line) { lines.push_back(json::parse(line)); });
            CHECK(lines.front()["partial"] == false);
            writer.frame({0, e.frames[1]}, supports, verdict);
            CHECK(lines.back().contains("lambda") == (methods.within(box_methods) && shape == RestShape::aabb));
        }
}
