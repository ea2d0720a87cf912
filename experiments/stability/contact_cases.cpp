// SPDX-License-Identifier: GPL-3.0-or-later
// Hard triangles, and cells that hold them.
#include <algorithm>
#include <map>
#include <numeric>

#include "experiments/baselines/cell_grid.hpp"
#include "experiments/stability/bodies.hpp"
#include "toolkit/collide/triangle_pair.hpp"

namespace cinch {
namespace {

using namespace stability_bodies;

// The verdict over all 72 orders of vertices and triangles: 0 or 1, or −1 if they disagree.
int in_all_orders(const TrianglePoints& a, const TrianglePoints& b)
{
    int yes = 0, count = 0;
    std::array<std::size_t, 3> p{0, 1, 2};
    do {
        std::array<std::size_t, 3> q{0, 1, 2};
        do {
            const TrianglePoints x{a[p[0]], a[p[1]], a[p[2]]}, y{b[q[0]], b[q[1]], b[q[2]]};
            yes += intersect(x, y);
            yes += intersect(y, x);
            count += 2;
        } while (std::next_permutation(q.begin(), q.end()));
    } while (std::next_permutation(p.begin(), p.end()));
    return yes == 0 ? 0 : yes == count ? 1 : -1;
}

struct Pair {
    TrianglePoints a, b;
    bool touch;
};

StabilityOutcome all_of(const std::vector<Pair>& pairs)
{
    std::size_t right = 0;
    for (const Pair& p : pairs)
        right += in_all_orders(p.a, p.b) == (p.touch ? 1 : 0);
    StabilityOutcome out;
    out.pass = right == pairs.size();
    out.observed = fmt::format("{} of {} right, in all 72 orders", right, pairs.size());
    return out;
}

StabilityState flattened()
{
    // A box squeezed to a plane, a line and a point.
    StabilityState state{{box({1, 1, 1}, {2, 2, 2}), {}}, {}};
    state.surface.weights = kernel_weights(state.surface.mesh, {{{0, 0, 0}}, 1}, 4);
    state.frames = {{AffineMap{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 0, 0.1}}}},
                    {AffineMap{{{1, 1, 1, 0}, {1, 1, 1, 0}, {1, 1, 1, 0}}}},
                    {AffineMap{{{0, 0, 0, 0.1}, {0, 0, 0, 0.2}, {0, 0, 0, 0.3}}}}};
    return state;
}

StabilityOutcome collapsed_triangles(Missing)
{
    const Vec3 o(0, 0, 0), x(1, 0, 0), y(0, 1, 0), m(0.25, 0.25, 0), up(0.25, 0.25, 1), down(0.25, 0.25, -1),
        far(3, 3, 0);
    const TrianglePoints t{o, x, y};
    StabilityOutcome out =
        all_of({{t, {m, m, m}, true},
                {t, {up, up, up}, false},
                {t, {up, down, up}, true},
                {t, {up, down, m}, true},
                {t, {up, up, Vec3(3, 3, -1)}, false},
                {t, {m, far, m}, true},
                {t, {Vec3(2, 0, 0), far, far}, false},
                {{o, x, Vec3(0.5, 0, 0)}, {Vec3(0.5, -1, 0), Vec3(0.5, 1, 0), Vec3(0.5, 0, 0)}, true},
                {{o, x, o}, {Vec3(0, 1e-300, 0), Vec3(1, 1e-300, 0), Vec3(0, 1e-300, 0)}, false},
                {{m, m, m}, {m, m, m}, true},
                {{m, m, m}, {up, up, up}, false}});
    out.states.push_back(flattened());
    return out;
}

// Pairs of two meshes that intersect, through cells: how often each is reported.
std::map<std::pair<std::size_t, std::size_t>, int> through_cells(const TriangleMesh& a, const TriangleMesh& b,
                                                                 double cell)
{
    auto points = [](const TriangleMesh& m, std::size_t t) {
        return TrianglePoints{m.vertices[m.triangles[t][0]], m.vertices[m.triangles[t][1]],
                              m.vertices[m.triangles[t][2]]};
    };
    auto box_of = [&](const TriangleMesh& m, std::size_t t) {
        const TrianglePoints p = points(m, t);
        return Aabb{p[0].cwiseMin(p[1]).cwiseMin(p[2]), p[0].cwiseMax(p[1]).cwiseMax(p[2])};
    };
    std::vector<Aabb> boxes;
    for (std::size_t t = 0; t < a.triangles.size(); ++t)
        boxes.push_back(box_of(a, t));
    for (std::size_t t = 0; t < b.triangles.size(); ++t)
        boxes.push_back(box_of(b, t));
    const CellGrid grid = choose_grid(boxes, cell);
    std::map<Cell, std::vector<std::size_t>> bucket;
    for (std::size_t t = 0; t < a.triangles.size(); ++t)
        for_each_cell(*cells(grid, boxes[t], 100000), [&](const Cell& c) { bucket[c].push_back(t); });
    std::map<std::pair<std::size_t, std::size_t>, int> count;
    for (std::size_t u = 0; u < b.triangles.size(); ++u) {
        const CellRange mine = *cells(grid, boxes[a.triangles.size() + u], 100000);
        for_each_cell(mine, [&](const Cell& c) {
            for (const std::size_t t : bucket[c])
                if (reports(c, *cells(grid, boxes[t], 100000), mine) && intersect(points(a, t), points(b, u)))
                    ++count[{t, u}];
        });
    }
    return count;
}

StabilityOutcome duplicates(Missing)
{
    TriangleMesh a = box({1, 1, 1}, {2, 2, 2}), b = a;
    const std::size_t once = a.triangles.size();
    a.triangles.insert(a.triangles.end(), a.triangles.begin(), a.triangles.end()); // every triangle twice,
    for (Vec3& v : b.vertices)
        v += Vec3(0.3, 0.2, 0.1);
    const std::size_t vertices = a.vertices.size();
    for (std::size_t v = 0; v < vertices; ++v)
        a.vertices.push_back(a.vertices[v]); // and the second time with vertices of its own
    for (std::size_t t = once; t < a.triangles.size(); ++t)
        for (auto& v : a.triangles[t])
            v += static_cast<std::uint32_t>(vertices);
    const auto count = through_cells(a, b, 0.3);
    bool each_once = true;
    std::size_t twins = 0;
    for (const auto& [pair, times] : count) {
        each_once &= times == 1;
        twins += pair.first < once && count.count({pair.first + once, pair.second});
    }
    StabilityOutcome out;
    out.pass = each_once && count.size() == 2 * twins && twins > 0;
    out.observed = fmt::format("{} pairs, {} with their twin, {}", count.size(), 2 * twins,
                               each_once ? "each once" : "SOME TWICE");
    DeformableSurface surface{a, kernel_weights(a, {{{0, 0, 0}}, 1}, 4)};
    out.states.push_back({std::move(surface), {{identity_map}}});
    return out;
}

StabilityOutcome touching(Missing)
{
    const Vec3 o(0, 0, 0), x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
    const TrianglePoints t{o, x, y};
    const double third = 1.0 / 3;
    return all_of(
        {{t, {o, z, Vec3(-1, 0, 1)}, true},                                              // a shared vertex
         {t, {o, x, z}, true},                                                           // a shared edge
         {t, t, true},                                                                   // the same
         {t, {Vec3(0.5, 0, 0), Vec3(0.5, -1, 0), Vec3(0.7, -1, 0)}, true},               // vertex on edge, coplanar
         {t, {Vec3(0.2, 0.2, 0), Vec3(2, 2, 0), Vec3(2, 3, 0)}, true},                   // coplanar overlap
         {t, {Vec3(0.1, 0.1, 0), Vec3(0.2, 0.1, 0), Vec3(0.1, 0.2, 0)}, true},           // coplanar, inside
         {t, {Vec3(1 + 1e-16, 1, 0), Vec3(2, 0, 0), Vec3(2, 2, 0)}, false},              // coplanar, beside
         {t, {Vec3(third, third, 0), Vec3(third, third, 1), Vec3(0, 0, 1)}, true},       // vertex on face
         {t, {Vec3(third, third, 5e-324), Vec3(third, third, 1), Vec3(0, 0, 1)}, false}, // by the least there is
         {t, {Vec3(0, -1e-300, 0), Vec3(0, -1, 0), Vec3(1, -1, 0)}, false}});
}

StabilityOutcome index_overflow(Missing)
{
    const std::vector<Aabb> boxes{{Vec3(-1e18, 0, 0), Vec3(-1e18, 1, 1)},
                                  {Vec3(1e18, 0, 0), Vec3(1e18, 1, 1)},
                                  {Vec3(0, 0, 0), Vec3(1e-3, 1e-3, 1e-3)}};
    const CellGrid grid = choose_grid(boxes, 1e-3);
    bool all = true;
    for (const Aabb& b : boxes)
        all &= cells(grid, b, 1000000).has_value();
    const Aabb everywhere{Vec3(-HUGE_VAL, 0, 0), Vec3(HUGE_VAL, 1, 1)}, unknown{Vec3(NAN, 0, 0), Vec3(1, 1, 1)};
    const bool listed = !cells(grid, everywhere, 1000000) && !cells(grid, unknown, 1000000);
    StabilityOutcome out;
    out.pass = all && listed && grid.cell >= 1e18 / 0x1p31;
    out.observed = fmt::format("cell {:.1e}; {}", grid.cell,
                               listed ? "unbounded boxes go to the list" : "an unbounded box got cells");
    return out;
}

} // namespace

std::vector<StabilityCase> contact_cases()
{
    return {{"22 collapsed triangles", "exact in all orders", collapsed_triangles},
            {"23 duplicate vertices and triangles", "each pair of indices once", duplicates},
            {"27 touching triangles", "closed, exact in all orders", touching},
            {"35 cell indices beyond 32 bits", "the cell grows; what is unbounded is listed", index_overflow}};
}

} // namespace cinch
