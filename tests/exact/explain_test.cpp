// SPDX-License-Identifier: GPL-3.0-or-later
#include <sstream>

#include <catch2/catch.hpp>
#include <gmpxx.h>

#include "cinch/refit.hpp"
#include "exact/explain.hpp"
#include "exact/verifier.hpp"
#include "tests/support.hpp"

using namespace cinch;
using namespace cinch::exact;

namespace {

struct Scene {
    test::Example e = test::example(300, 20);
    Bvh bvh = build_bvh(e.surface, 4);
    std::vector<double> supports(Method method, int k) const
    {
        std::vector<double> s(bvh.bvs.size() * static_cast<std::size_t>(k));
        refit(bvh, e.surface, e.frames[2], {method, k}, s);
        return s;
    }
};

} // namespace

TEST_CASE("exact losses are not negative, sum to the total exactly, and are what the verifier reports")
{
    const Scene scene;
    for (Method method : {Method::convex, Method::eq12, Method::limited, Method::vertices}) {
        const auto s = scene.supports(method, 6);
        const FrameVerdict verdict = Verifier(scene.e.surface, scene.bvh).check(scene.e.frames[2], method, 6, s);
        for (std::size_t bv : {std::size_t{0}, std::size_t{5}, scene.bvh.bvs.size() - 1}) {
            double mean[4] = {0, 0, 0, 0};
            for (int d = 0; d < 6; ++d) {
                const ExactLoss loss = exact_loss({scene.e.surface, scene.bvh, scene.e.frames[2], method, 6, bv, d,
                                                   s[6 * bv + static_cast<std::size_t>(d)]});
                mpq_class sum = 0;
                int i = 0;
                for (const std::string* part : {&loss.box, &loss.interval, &loss.corner, &loss.rounding}) {
                    const mpq_class value(*part);
                    CHECK(value >= 0);
                    sum += value;
                    mean[i++] += value.get_d() / 6;
                }
                CHECK(sum == mpq_class(loss.total));
            }
            const Loss& reported = verdict.bvs[bv].loss;
            const double values[] = {reported.box, reported.interval, reported.corner, reported.rounding};
            for (int i = 0; i < 4; ++i)
                CHECK(values[i] == Approx(mean[i]).margin(1e-13));
        }
    }
}

TEST_CASE("a VIPR file derives its bound: the combination gives the objective and its right-hand side is within range")
{
    const Scene scene;
    const auto s = scene.supports(Method::eq12, 14);
    for (int d = 0; d < 14; ++d) {
        const std::size_t bv = 2;
        std::istringstream in(vipr({scene.e.surface, scene.bvh, scene.e.frames[2], Method::eq12, 14, bv, d,
                                    s[14 * bv + static_cast<std::size_t>(d)]}));
        auto read = [&] {
            std::string word;
            in >> word;
            return word;
        };
        std::string comment;
        std::getline(in, comment);
        REQUIRE((read() == "VER" && read() == "1.0" && read() == "VAR"));
        const std::size_t n = std::stoul(read());
        for (std::size_t j = 0; j < n; ++j)
            read();
        auto row = [&] { // sparse
            std::vector<mpq_class> values(n, 0);
            for (std::size_t count = std::stoul(read()); count > 0; --count) {
                const std::size_t j = std::stoul(read());
                values.at(j) = mpq_class(read());
            }
            return values;
        };
        REQUIRE((read() == "INT" && read() == "0" && read() == "OBJ" && read() == "max"));
        const auto objective = row();
        REQUIRE(read() == "CON");
        const std::size_t constraints = std::stoul(read());
        REQUIRE(constraints == 2 * n + 1);
        REQUIRE(std::stoul(read()) == 2 * n);
        struct Constraint {
            std::string sense;
            mpq_class right;
            std::vector<mpq_class> row;
        };
        std::vector<Constraint> all;
        for (std::size_t c = 0; c < constraints; ++c) {
            read();
            Constraint constraint{read(), mpq_class(read()), {}};
            constraint.row = row();
            all.push_back(constraint);
        }
        REQUIRE((read() == "RTP" && read() == "range" && read() == "-inf"));
        const mpq_class bound(read());
        REQUIRE((read() == "SOL" && read() == "0" && read() == "DER" && read() == "1"));
        read();
        REQUIRE(read() == "L");
        const mpq_class derived(read());
        REQUIRE((read() == "OBJ" && read() == "{" && read() == "lin"));
        std::vector<mpq_class> sum(n, 0);
        mpq_class right = 0;
        for (std::size_t count = std::stoul(read()); count > 0; --count) {
            const Constraint& c = all.at(std::stoul(read()));
            const mpq_class multiplier(read());
            CHECK((c.sense == "E" || (c.sense == "L" ? multiplier >= 0 : multiplier <= 0)));
            for (std::size_t j = 0; j < n; ++j)
                sum[j] += multiplier * c.row[j];
            right += multiplier * c.right;
        }
        CHECK((read() == "}" && read() == "-1"));
        CHECK(sum == objective);
        CHECK(right == derived);
        CHECK(derived <= bound);
    }
}
