// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <set>

#include <catch2/catch.hpp>

#include "experiments/baselines/cell_grid.hpp"

using namespace cinch;

namespace {

using limits = std::numeric_limits<double>;

Aabb box(const Vec3& a, const Vec3& b) { return {a.cwiseMin(b), a.cwiseMax(b)}; }
bool overlap(const Aabb& a, const Aabb& b)
{
    return (a.lower.array() <= b.upper.array()).all() && (b.lower.array() <= a.upper.array()).all();
}

std::vector<Aabb> random_boxes(std::size_t count, double scale, double size, const Vec3& offset)
{
    std::mt19937_64 random(8);
    std::uniform_real_distribution<double> uniform(-1, 1);
    const auto point = [&] { return Vec3(uniform(random), uniform(random), uniform(random)); };
    std::vector<Aabb> boxes;
    for (std::size_t i = 0; i < count; ++i) {
        Vec3 corner = offset + scale * point(), extent = size * point();
        if (i % 4 == 1) // corners and faces on borders of cells
            for (double& x : corner)
                x = std::floor(x);
        if (i % 4 == 2)
            extent.setZero();
        if (i % 4 == 3) // touches the last one
            corner = boxes.back().upper;
        boxes.push_back(box(corner, corner + extent));
    }
    return boxes;
}

using Pair = std::pair<std::size_t, std::size_t>;

/// What a backend does, with the cells in place of their hash buckets: how often each overlapping pair is reported.
std::map<Pair, int> reported_pairs(const CellGrid& grid, const std::vector<Aabb>& boxes)
{
    std::map<Cell, std::vector<std::size_t>> bucket;
    std::vector<CellRange> range;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        const auto found = cells(grid, boxes[i], 1u << 20);
        REQUIRE(found.has_value());
        range.push_back(*found);
        for_each_cell(range[i], [&](const Cell& c) { bucket[c].push_back(i); });
    }
    std::map<Pair, int> reported;
    for (const auto& [cell, entries] : bucket)
        for (std::size_t i : entries)
            for (std::size_t j : entries)
                if (i < j && reports(cell, range[i], range[j]) && overlap(boxes[i], boxes[j]))
                    ++reported[{i, j}];
    return reported;
}

} // namespace

TEST_CASE("every overlapping pair of boxes is reported exactly once")
{
    struct Setting {
        double scale, size, cell;
        Vec3 offset;
    };
    for (const Setting& s :
         {Setting{5, 1, 1, Vec3::Zero()}, Setting{5, 3, 0.7, Vec3(1e8, -1e8, 0)}, Setting{5, 2, 100, Vec3::Zero()},
          Setting{100, 30, 1e-30, Vec3(1e18, 1e18, 0)}, Setting{1e-300, 1e-301, 1e-301, Vec3::Zero()}}) {
        const std::vector<Aabb> boxes = random_boxes(600, s.scale, s.size, s.offset);
        CellGrid grid = choose_grid(boxes, s.cell);
        if (s.cell < s.size / 100) // checked for its indices below; here the cells must be few enough to visit
            grid.cell = s.size;
        const std::map<Pair, int> reported = reported_pairs(grid, boxes);
        std::size_t expected = 0;
        for (std::size_t i = 0; i < boxes.size(); ++i)
            for (std::size_t j = i + 1; j < boxes.size(); ++j)
                if (overlap(boxes[i], boxes[j])) {
                    ++expected;
                    REQUIRE(reported.contains({i, j}));
                    REQUIRE(reported.at({i, j}) == 1);
                }
        CHECK(reported.size() == expected);
        CHECK(expected > 100);
    }
}

TEST_CASE("the cell is doubled until every index fits 32 bits, and no further")
{
    struct Setting {
        Vec3 a, b;
        double cell;
    };
    const double m = limits::max();
    const Vec3 o = Vec3::Zero(), one = Vec3::Ones();
    const Setting settings[] = {{{-1e18, 0, 1e18}, {1e18, 1, 1e18}, 1e-3},
                                {{1e18, 0, 0}, {1e18, 1, 0}, 1e-3},
                                {{-m, -m, 0}, {m, m, 0}, 1e-3},
                                {{m, m, m}, {m, m, m}, 1},
                                {o, one, 0x1p-1074},
                                {o, one, 0},
                                {o, one, -1},
                                {o, one, limits::quiet_NaN()},
                                {{-m, 0, 0}, {m, 0, 0}, limits::infinity()},
                                {o, {0x1p32 - 2, 0, 0}, 1},
                                {o, {0x1p32 - 1, 0, 0}, 1},
                                {o, {0x1p32, 0, 0}, 1},
                                {{5, 5, 5}, {5, 5, 5}, 0}};
    for (const Setting& s : settings) {
        const std::vector<Aabb> boxes{box(s.a, s.a), box(s.b, s.b)};
        const CellGrid grid = choose_grid(boxes, s.cell);
        CHECK(grid.origin.allFinite());
        CHECK(std::isfinite(grid.cell));
        CHECK(grid.cell > 0);
        for (const Aabb& b : boxes) {
            const auto range = cells(grid, b, 1);
            REQUIRE(range.has_value());
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const auto i = static_cast<Eigen::Index>(axis);
                CHECK(range->first[axis] == std::floor((b.lower[i] - grid.origin[i]) / grid.cell));
            }
        }
        if (grid.cell > s.cell && s.cell >= limits::min()) {
            const CellGrid half{grid.origin, grid.cell / 2};
            CHECK_FALSE((cells(half, boxes[0], 1).has_value() && cells(half, boxes[1], 1).has_value()));
        }
        if (s.cell >= limits::min() && std::isfinite(s.cell))
            CHECK(std::exp2(std::round(std::log2(grid.cell / s.cell))) == Approx(grid.cell / s.cell).epsilon(1e-9));
    }
    // The greatest index itself, which a loop must not step over, and a box that reaches beyond.
    const std::vector<Aabb> boxes{box({0, 0, 0}, {0x1p32 - 2, 0, 0})};
    const CellGrid grid = choose_grid(boxes, 1);
    CHECK(grid.cell == 1);
    const auto last = cells(grid, box(boxes[0].upper, boxes[0].upper), 1);
    REQUIRE(last.has_value());
    CHECK(last->first == Cell{2147483647, 0, 0});
    int visited = 0;
    for_each_cell(*last, [&](const Cell& c) { visited += c == last->first; });
    CHECK(visited == 1);
    CHECK_FALSE(cells(grid, box({0x1p32 - 1, 0, 0}, {0x1p32, 0, 0}), 1000).has_value());
    CHECK_FALSE(cells(grid, box({-2, 0, 0}, {0, 0, 0}), 1000).has_value());
}

TEST_CASE("boxes that are not finite, no boxes or giants are handed back as everywhere, and do not move the grid")
{
    const std::vector<Aabb> usual{box({0, 0, 0}, {1, 1, 1}), box({3, 3, 3}, {4, 4, 4})};
    const CellGrid grid = choose_grid(usual, 1);
    for (double unknown : {limits::quiet_NaN(), limits::infinity(), -limits::infinity()})
        for (Eigen::Index axis = 0; axis < 3; ++axis)
            for (bool upper : {false, true}) {
                std::vector<Aabb> boxes = usual;
                (upper ? boxes[1].upper : boxes[1].lower)[axis] = unknown;
                CHECK_FALSE(cells(grid, boxes[1], 1000).has_value());
                const CellGrid other = choose_grid(boxes, 1);
                CHECK(other.origin == Vec3(0.5, 0.5, 0.5));
                CHECK(other.cell == 1);
            }
    CHECK_FALSE(cells(grid, {Vec3(1, 0, 0), Vec3(0, 1, 1)}, 1000).has_value());
    CHECK(cells(grid, usual[0], 8).has_value());
    CHECK_FALSE(cells(grid, usual[0], 7).has_value());
    const CellGrid none = choose_grid({}, 0.25);
    CHECK(none.origin == Vec3::Zero());
    CHECK(none.cell == 0.25);
}

TEST_CASE("indices never decrease with the coordinate")
{
    std::mt19937_64 random(9);
    std::uniform_real_distribution<double> uniform(-1e6, 1e6);
    const std::vector<Aabb> boxes{box(Vec3::Constant(-1e6), Vec3::Constant(1e6))};
    const CellGrid grid = choose_grid(boxes, 0.1);
    for (int i = 0; i < 100000; ++i) {
        const double x = random() % 2 ? uniform(random) : std::round(uniform(random)) * 0.1,
                     next = std::nextafter(x, 1e7);
        const auto range = cells(grid, box(Vec3(x, 0, 0), Vec3(next, 0, 0)), 2);
        REQUIRE(range.has_value());
        REQUIRE(range->first[0] <= range->last[0]);
        REQUIRE(std::abs(range->first[0] - x / 0.1) < 1.001);
    }
}

TEST_CASE("the hash is Teschner's, modulo 2^32, and spreads")
{
    CHECK(hash({1, 0, 0}, 0xffffffff) == 73856093u);
    CHECK(hash({0, 1, 0}, 0xffffffff) == 19349663u);
    CHECK(hash({0, 0, 1}, 0xffffffff) == 83492791u);
    CHECK(hash({1, 1, 1}, 0xffffffff) == (73856093u ^ 19349663u ^ 83492791u));
    CHECK(hash({-1, 0, 0}, 0xffffffff) == 4221111203u); // 2^32 − 73856093
    CHECK(hash({2147483647, -2147483647, 2147483647}, 1009) < 1009);
    std::set<std::uint32_t> used;
    for (int x = -5; x < 5; ++x)
        for (int y = -5; y < 5; ++y)
            for (int z = -5; z < 5; ++z)
                used.insert(hash({x, y, z}, 1009));
    CHECK(used.size() > 400);
}
