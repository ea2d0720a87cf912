// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include <cmath>
#include <cstdio>
#include <random>

#include <catch2/catch.hpp>
#include <rapidcheck/catch.h>

#include "cinch/surface.hpp"
#include "toolkit/deform/dyadic.hpp"

using namespace cinch;

namespace {

void check_dyadic(const std::vector<double>& weights)
{
    std::int64_t units = 0;
    for (double w : weights) {
        REQUIRE(w >= 0);
        REQUIRE(w * 0x1p53 == std::floor(w * 0x1p53));
        units += static_cast<std::int64_t>(w * 0x1p53);
    }
    REQUIRE(units == std::int64_t{1} << 53);
}

} // namespace

TEST_CASE("rounded weights are multiples of 2^-53 and sum to exactly 1, whatever comes in")
{
    rc::prop("random mantissas over the whole exponent range",
             [](std::vector<std::pair<std::uint32_t, std::uint8_t>> parts) {
                 RC_PRE(!parts.empty());
                 std::vector<double> weights;
                 for (const auto& [mantissa, exponent] : parts)
                     weights.push_back(std::ldexp(mantissa + 1.0, exponent - 128));
                 round_dyadic(weights);
                 check_dyadic(weights);
             });
    rc::prop("equal weights", [] {
        std::vector<double> weights(*rc::gen::inRange<std::size_t>(1, 3000), 0.1);
        round_dyadic(weights);
        check_dyadic(weights);
    });
}

TEST_CASE("rounding stays within n + 2 units of the real quotient")
{
    std::vector<double> weights;
    for (int i = 1; i <= 500; ++i)
        weights.push_back(std::sqrt(i));
    long double sum = 0;
    for (double w : weights)
        sum += w;
    std::vector<double> rounded = weights;
    round_dyadic(rounded);
    for (std::size_t i = 0; i < weights.size(); ++i)
        CHECK(std::abs(static_cast<double>(rounded[i] - weights[i] / sum)) <= 502 * weight_unit);
}

TEST_CASE("dyadic weights that sum to 1 come back unchanged")
{
    rc::prop("idempotent", [](std::vector<std::uint32_t> parts) {
        RC_PRE(!parts.empty());
        std::vector<double> weights(parts.begin(), parts.end());
        weights.push_back(1);
        round_dyadic(weights);
        std::vector<double> again = weights;
        round_dyadic(again);
        RC_ASSERT(again == weights);
    });
}

TEST_CASE("extreme weights")
{
    std::vector<double> huge{1e308, 1e308, 1e308}, tiny{5e-324, 5e-324}, mixed{1, 1e-300};
    round_dyadic(huge);
    round_dyadic(tiny);
    round_dyadic(mixed);
    check_dyadic(huge);
    CHECK(tiny == std::vector<double>{0.5, 0.5});
    CHECK(mixed == std::vector<double>{1, 0});
}

TEST_CASE("a file's weights are normalised, rows without weight bound, and both counted")
{
    Influences influences;
    influences.node_count = 3;
    influences.row = {0, 2, 3, 5};
    influences.node = {0, 2, 1, 1, 2};
    influences.weight = {0.1, 0.1, 0, 1, 1e-30};
    WeightReport report;
    const Weights weights = to_dyadic(influences, &report);
    CHECK(weights.row == std::vector<std::uint32_t>{0, 2, 3, 4}); // 1e-30 rounds to 0 and is dropped
    CHECK(weights.weight == std::vector<double>{0.5, 0.5, 1, 1});
    CHECK(report.vertices == 3);
    CHECK(report.normalised == 1);
    CHECK(report.largest_change == Approx(4)); // from 0.1 to 0.5
    CHECK(report.without_weight == 1);
    CHECK(report.least_sum == 0.2);
    CHECK(report.greatest_sum == 1);
}

TEST_CASE("normalising is reported where it changes weights by more than rounding, with the largest change")
{
    std::mt19937_64 random(5);
    auto uniform = [&](double low, double high) { return std::uniform_real_distribution<>(low, high)(random); };
    for (std::size_t i = 0; i < 2000; ++i) {
        const std::size_t n = 1 + random() % 12;
        Influences one;
        one.node_count = 12;
        const int kind = static_cast<int>(i % 3); // stored as binary32, printed with 9 digits, as bytes
        std::vector<float> raw;
        float sum = 0;
        for (std::size_t j = 0; j < n; ++j) {
            raw.push_back(static_cast<float>(uniform(0.001, 1)));
            sum += raw.back();
        }
        if (kind == 2) {
            one.step = 1.0 / 255;
            int left = 255;
            for (std::size_t j = 0; j < n; ++j) {
                const int part =
                    j + 1 == n ? left : static_cast<int>(random() % static_cast<std::uint64_t>(left / 2 + 1));
                left -= part;
                one.weight.push_back(part / 255.0);
            }
        } else {
            for (const float w : raw)
                one.weight.push_back(kind == 0 ? static_cast<double>(w / sum) : std::stod([&] {
                    char text[32];
                    std::snprintf(text, sizeof text, "%.9g", static_cast<double>(w / sum));
                    return std::string(text);
                }()));
        }
        for (std::size_t j = 0; j < n; ++j)
            one.node.push_back(static_cast<std::uint32_t>(j));
        one.row.push_back(static_cast<std::uint32_t>(n));
        WeightReport report;
        to_dyadic(one, &report);
        CHECK(report.normalised == 0);
        CHECK(report.largest_change == 0);

        const double scale = uniform(0, 1) < 0.5
                                 ? 1 + std::exp(uniform(std::log(2e-6), std::log(9.0)))
                                 : 1 - std::exp(uniform(std::log(2e-6), std::log(0.9))); // from far below 0.001
        for (double& w : one.weight)
            w *= scale;
        to_dyadic(one, &report);
        INFO(scale << " of " << n);
        CHECK(report.normalised == 1);
        CHECK(report.largest_change == Approx(std::abs(1 / scale - 1)).epsilon(0.5).margin(2 * sum_rounding(n)));
        CHECK((report.beyond_steps == 1) ==
              (std::abs(scale - 1) > sum_rounding(n) + 0.5 * one.step * static_cast<double>(n)));
    }
}
