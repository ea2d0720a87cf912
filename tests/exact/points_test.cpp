// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <CGAL/QP_functions.h>
#include <CGAL/QP_models.h>

#include "cinch/bvh.hpp"
#include "exact/number.hpp"
#include "tests/support.hpp"

using namespace cinch;
using cinch::exact::Exact;

namespace {

// The squared distance of x from the convex hull of the points, exactly, by CGAL's quadratic programming.
CGAL::Quotient<Exact> squared_distance(const Vec3& x, const std::vector<Vec3>& points)
{
    CGAL::Quadratic_program<Exact> program(CGAL::EQUAL, true, Exact(0), false);
    auto difference = [&](std::size_t i, int s) { return Exact(points[i][s]) - Exact(x[s]); };
    for (int i = 0; i < static_cast<int>(points.size()); ++i) {
        program.set_a(i, 0, Exact(1));
        for (int j = 0; j <= i; ++j) {
            Exact dot(0);
            for (int s = 0; s < 3; ++s)
                dot = dot + difference(static_cast<std::size_t>(i), s) * difference(static_cast<std::size_t>(j), s);
            program.set_d(i, j, dot + dot);
        }
    }
    program.set_b(0, Exact(1));
    return CGAL::solve_quadratic_program(program, Exact()).objective_value();
}

} // namespace

TEST_CASE("every vertex of a BV lies within the slack of the hull of its points")
{
    const test::Example e = test::example(400, 30);
    const Bvh bvh = build_bvh(e.surface, 1);
    std::size_t checked = 0;
    for (std::size_t i = 0; i < bvh.bvs.size(); ++i) {
        const RestBv rest = bvh.rest(i);
        const auto vertices = vertices_of(e.surface, bvh, bvh.bvs[i]);
        REQUIRE(rest.point.size() <= 64);
        std::vector<Vec3> points;
        for (std::uint32_t k : rest.point) {
            REQUIRE(std::find(vertices.begin(), vertices.end(), k) != vertices.end());
            points.push_back(e.surface.mesh.vertices[k]);
        }
        if (rest.point.size() == vertices.size()) {
            REQUIRE(rest.slack == 0);
            continue;
        }
        for (std::uint32_t k : vertices) {
            const auto squared = squared_distance(e.surface.mesh.vertices[k], points);
            REQUIRE(squared <= CGAL::Quotient<Exact>(Exact(rest.slack) * Exact(rest.slack)));
            ++checked;
        }
        CHECK(rest.slack < 0.2 * rest.box.half.maxCoeff()); // and is worth having
    }
    CHECK(checked > 500);
}
