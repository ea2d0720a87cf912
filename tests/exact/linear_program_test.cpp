// SPDX-License-Identifier: GPL-3.0-or-later
#include <random>

#include <CGAL/QP_functions.h>
#include <CGAL/QP_models.h>
#include <catch2/catch.hpp>

#include "exact/optimum.hpp"

using namespace cinch;
using namespace cinch::exact;

TEST_CASE("the optimum equals that of CGAL's linear program solver on 1,000 random spaces")
{
    std::mt19937_64 random(31);
    auto uniform = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
    int feasible = 0;
    for (int trial = 0; trial < 1000; ++trial) {
        const std::size_t n = 1 + random() % 12;
        std::vector<double> l, h, b;
        CGAL::Quadratic_program<double> program(CGAL::EQUAL, false, 0, false, 0);
        for (std::size_t j = 0; j < n; ++j) {
            const double mean = 1.0 / static_cast<double>(n);
            l.push_back(trial % 3 ? uniform(0, mean) : static_cast<double>(random() % 2) / 16);
            h.push_back(trial % 3 ? uniform(l[j], 1) : l[j] + static_cast<double>(random() % 5) / 8);
            h[j] = std::min(h[j], 1.0);
            b.push_back(trial % 3 ? uniform(-1e3, 1e3) : static_cast<double>(random() % 5));
            const int column = static_cast<int>(j);
            program.set_a(column, 0, 1);
            program.set_l(column, true, l[j]);
            program.set_u(column, true, h[j]);
            program.set_c(column, -b[j]); // it minimises
        }
        program.set_b(0, 1);
        const auto solution = CGAL::solve_linear_program(program, Exact());
        const auto found = optimum({l, h}, std::vector<Exact>(b.begin(), b.end()));
        REQUIRE(solution.is_optimal() == found.has_value());
        if (!found)
            continue;
        ++feasible;
        REQUIRE(-solution.objective_value().numerator() == found->value * solution.objective_value().denominator());
    }
    CHECK(feasible > 500);
}
