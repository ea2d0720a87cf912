// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/collide/brute_force.hpp"

#include <algorithm>
#include <numeric>
#include <set>
#include <sstream>

#include "cinch/deform.hpp"
#include "toolkit/collide/collider_parts.hpp"
#include "toolkit/hierarchy/lazy_refit.hpp"

namespace cinch::test {
namespace {

struct Box {
    Vec3 low, high;
    std::uint32_t triangle;
};

bool apart(const Box& a, const Box& b)
{
    return (a.high.array() < b.low.array()).any() || (b.high.array() < a.low.array()).any();
}

Box box_of(const TrianglePoints& p, std::uint32_t t)
{
    Box box{p[0], p[0], t};
    for (const Vec3& x : p)
        for (int r = 0; r < 3; ++r) {
            box.low[r] = std::min(box.low[r], x[r]);
            box.high[r] = std::max(box.high[r], x[r]);
        }
    return box;
}

// The triangles that reach into `other`, in order of the lower ends along x.
std::vector<Box> boxes_within(const DeformableSurface& surface, const Positions& positions, const Box& other)
{
    std::vector<Box> boxes;
    for (std::uint32_t t = 0; t < surface.mesh.triangles.size(); ++t)
        if (const Box box = box_of(corners_of(surface, positions, t), t); !apart(box, other))
            boxes.push_back(box);
    std::sort(boxes.begin(), boxes.end(), [](const Box& a, const Box& b) { return a.low[0] < b.low[0]; });
    return boxes;
}

Box box_of(const DeformableSurface& surface, const Positions& positions)
{
    const double most = std::numeric_limits<double>::max();
    Box whole{Vec3::Constant(most), Vec3::Constant(-most), 0};
    for (std::uint32_t t = 0; t < surface.mesh.triangles.size(); ++t) {
        const Box box = box_of(corners_of(surface, positions, t), t);
        whole.low = whole.low.cwiseMin(box.low);
        whole.high = whole.high.cwiseMax(box.high);
    }
    return whole;
}

} // namespace

Positions positions_of(const DeformableSurface& surface, const BodyFrame& frame)
{
    if (!frame.positions.empty())
        return {frame.positions.begin(), frame.positions.end()};
    Positions all;
    for (std::size_t k = 0; k < surface.mesh.vertices.size(); ++k)
        all.push_back(evaluate_vertex(surface.mesh.vertices[k], surface.weights.of(k), frame.maps));
    return all;
}

TrianglePoints corners_of(const DeformableSurface& surface, const Positions& positions, std::uint32_t triangle)
{
    const Triangle& corner = surface.mesh.triangles[triangle];
    return {positions[corner[0]], positions[corner[1]], positions[corner[2]]};
}

Pairs brute_force(const std::vector<const DeformableSurface*>& surfaces, const std::vector<Positions>& positions,
                  const std::vector<bool>& left_out)
{
    Pairs pairs;
    std::vector<Box> whole;
    for (std::size_t i = 0; i < surfaces.size(); ++i)
        whole.push_back(box_of(*surfaces[i], positions[i]));
    auto test = [&](std::uint32_t i, const Box& a, std::uint32_t j, const Box& b) {
        if (!apart(a, b) && intersect(corners_of(*surfaces[i], positions[i], a.triangle),
                                      corners_of(*surfaces[j], positions[j], b.triangle)))
            pairs.push_back({i, a.triangle, j, b.triangle});
    };
    for (std::uint32_t i = 0; i < surfaces.size(); ++i)
        for (std::uint32_t j = i + 1; j < surfaces.size(); ++j) {
            if ((!left_out.empty() && (left_out[i] || left_out[j])) || surfaces[i]->mesh.triangles.empty() ||
                surfaces[j]->mesh.triangles.empty() || apart(whole[i], whole[j]))
                continue;
            const std::vector<Box> a = boxes_within(*surfaces[i], positions[i], whole[j]),
                                   b = boxes_within(*surfaces[j], positions[j], whole[i]);
            // Sweep along x: each triangle meets those of the other body that begin while it lasts.
            for (std::size_t m = 0, n = 0; m < a.size() && n < b.size();)
                if (a[m].low[0] <= b[n].low[0]) {
                    for (std::size_t q = n; q < b.size() && b[q].low[0] <= a[m].high[0]; ++q)
                        test(i, a[m], j, b[q]);
                    ++m;
                } else {
                    for (std::size_t p = m; p < a.size() && a[p].low[0] <= b[n].high[0]; ++p)
                        test(i, a[p], j, b[n]);
                    ++n;
                }
        }
    return sorted(std::move(pairs));
}

Pairs sorted(Pairs pairs)
{
    std::sort(pairs.begin(), pairs.end());
    return pairs;
}

std::string difference(const Pairs& truth, const Pairs& found)
{
    Pairs lost, wrong;
    std::set_difference(truth.begin(), truth.end(), found.begin(), found.end(), std::back_inserter(lost));
    std::set_difference(found.begin(), found.end(), truth.begin(), truth.end(), std::back_inserter(wrong));
    std::ostringstream out;
    out << truth.size() << " pairs, " << lost.size() << " lost, " << wrong.size() << " too many";
    for (const Pairs* some : {&lost, &wrong})
        if (!some->empty())
            out << (some == &lost ? "; lost " : "; wrong ") << some->front().body_a << ":" << some->front().triangle_a
                << " " << some->front().body_b << ":" << some->front().triangle_b;
    return out.str();
}

std::vector<const DeformableSurface*> Bodies::surfaces() const
{
    std::vector<const DeformableSurface*> all;
    for (const DeformableSurface& s : surface)
        all.push_back(&s);
    return all;
}

void Bodies::add_frame(std::vector<std::vector<AffineMap>> of_bodies)
{
    maps.push_back(std::move(of_bodies));
    frame.emplace_back();
    for (const auto& m : maps.back()) // what these point to stays where it is
        frame.back().push_back({m});
}

void Bodies::add_positions(std::vector<Positions> of_bodies)
{
    given.push_back(std::move(of_bodies));
    frame.emplace_back();
    for (const auto& p : given.back())
        frame.back().push_back({{}, p});
}

std::vector<Pairs> Bodies::truth(const std::vector<bool>& left_out) const
{
    std::vector<Pairs> all;
    for (const auto& frames : frame) {
        std::vector<Positions> positions;
        for (std::size_t b = 0; b < surface.size(); ++b)
            positions.push_back(positions_of(surface[b], frames[b]));
        all.push_back(brute_force(surfaces(), positions, left_out));
    }
    return all;
}

std::vector<Bvh> Bodies::trees(ClusterSize leaf, RestDetail detail) const
{
    std::vector<Bvh> all;
    for (const DeformableSurface& s : surface)
        all.push_back(build_bvh(s, leaf, detail));
    return all;
}

Pairs in_order_of_trees(const Collider& collider, const Pairs& truth)
{
    const std::set<TrianglePair> wanted(truth.begin(), truth.end());
    const auto trees = collider.parts().trees();
    Pairs out;
    for (std::uint32_t i = 0; i < trees.size(); ++i)
        for (std::uint32_t j = i + 1; j < trees.size(); ++j) {
            const LazyRefit &a = trees[i], &b = trees[j];
            if (a.empty() || b.empty())
                continue;
            std::vector<std::pair<std::uint32_t, std::uint32_t>> level{{0, 0}}, next, leaves;
            for (; !level.empty(); level.swap(next)) {
                next.clear();
                for (const auto& [p, q] : level) {
                    const auto &x = a.link(p), &y = b.link(q);
                    if (x.is_leaf() && y.is_leaf()) {
                        leaves.emplace_back(p, q);
                        continue;
                    }
                    const bool open_x = !x.is_leaf() && (y.is_leaf() || 2 * x.size >= y.size),
                               open_y = !y.is_leaf() && (x.is_leaf() || 2 * y.size >= x.size);
                    for (std::uint32_t c = 0; c < (open_x ? 2u : 1u); ++c)
                        for (std::uint32_t d = 0; d < (open_y ? 2u : 1u); ++d)
                            next.emplace_back(open_x ? x.child + c : p, open_y ? y.child + d : q);
                }
            }
            for (const auto& [p, q] : leaves)
                for (std::uint32_t s = 0; s < a.leaf(p).triangles; ++s)
                    for (std::uint32_t t = 0; t < b.leaf(q).triangles; ++t)
                        if (const TrianglePair pair{i, a.triangle(a.leaf(p).first_triangle + s), j,
                                                    b.triangle(b.leaf(q).first_triangle + t)};
                            wanted.count(pair))
                            out.push_back(pair);
        }
    return out;
}

} // namespace cinch::test
