// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/baselines/spatial_hash.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "toolkit/collide/triangle_pair.hpp"

namespace cinch {
namespace {

constexpr std::uint64_t most_cells = 4096; // of a triangle

TrianglePoints points_of(const SpatialHash::Body& body, std::uint32_t t)
{
    const Triangle& corners = body.mesh->triangles[t];
    return {body.positions[corners[0]], body.positions[corners[1]], body.positions[corners[2]]};
}

bool apart(const Aabb& a, const Aabb& b) // false for what is not a number
{
    for (int r = 0; r < 3; ++r)
        if (a.upper[r] < b.lower[r] || b.upper[r] < a.lower[r])
            return true;
    return false;
}

} // namespace

void SpatialHash::load(std::span<const Body> bodies)
{
    loaded_ = false;
    bodies_.assign(bodies.begin(), bodies.end());
    items_.clear();
    everywhere_.clear();
    std::vector<Aabb> boxes; // of the triangles
    double edges = 0;
    for (std::uint32_t b = 0; b < bodies.size(); ++b) {
        if (bodies[b].positions.size() != bodies[b].mesh->vertices.size())
            throw std::invalid_argument("SpatialHash::load: one position per vertex is needed");
        for (std::uint32_t t = 0; t < bodies[b].mesh->triangles.size(); ++t) {
            const TrianglePoints p = points_of(bodies[b], t);
            bool finite = true;
            for (const Vec3& x : p)
                finite &= x.allFinite();
            Aabb box{p[0].cwiseMin(p[1]).cwiseMin(p[2]), p[0].cwiseMax(p[1]).cwiseMax(p[2])};
            if (!finite) // apart from nothing; of NaN cwiseMin says nothing
                box = {Vec3::Constant(-std::numeric_limits<double>::infinity()),
                       Vec3::Constant(std::numeric_limits<double>::infinity())};
            items_.push_back({b, t, box, {}, !finite});
            if (!finite)
                continue;
            const double edge = (p[1] - p[0]).norm() + (p[2] - p[1]).norm() + (p[0] - p[2]).norm();
            edges += edge < std::numeric_limits<double>::max() / 1e12 ? edge : 0;
            boxes.push_back(box);
        }
    }
    const CellGrid grid = choose_grid(boxes, boxes.empty() ? 1 : edges / (3 * static_cast<double>(boxes.size())));
    const auto buckets = static_cast<std::uint32_t>(std::max<std::size_t>(items_.size(), 1) | 1);
    bucket_.assign(std::size_t{buckets} + 1, 0);
    std::uint64_t count = 0;
    for (std::uint32_t i = 0; i < items_.size(); ++i) {
        Item& item = items_[i];
        const auto range = item.everywhere ? std::nullopt : cells(grid, item.box, most_cells);
        item.everywhere = !range;
        if (!range) {
            everywhere_.push_back(i);
            continue;
        }
        item.range = *range;
        for_each_cell(item.range, [&](const Cell& cell) {
            ++bucket_[hash(cell, buckets)];
            ++count;
        });
    }
    if (count > std::numeric_limits<std::uint32_t>::max())
        throw std::length_error("SpatialHash::load: over 2^32 entries");
    for (std::size_t b = 1; b < bucket_.size(); ++b) // where each ends
        bucket_[b] += bucket_[b - 1];
    entries_.resize(static_cast<std::size_t>(count));
    for (std::uint32_t i = static_cast<std::uint32_t>(items_.size()); i-- > 0;)
        if (!items_[i].everywhere)
            for_each_cell(items_[i].range, [&](const Cell& cell) {
                entries_[--bucket_[hash(cell, buckets)]] = {cell, i};
            });
    loaded_ = true;
}

bool SpatialHash::intersect(const Item& a, const Item& b) const
{
    return !apart(a.box, b.box) &&
           cinch::intersect(points_of(bodies_[a.body], a.triangle), points_of(bodies_[b.body], b.triangle));
}

void SpatialHash::find(std::vector<TrianglePair>& pairs) const
{
    if (!loaded_)
        throw std::logic_error(
            "SpatialHash::find: nothing is loaded; call load() first, and again after one that threw");
    const auto buckets = static_cast<std::uint32_t>(bucket_.size() - 1);
    auto report = [&](const Item& a, const Item& b) { // a.body < b.body
        if (intersect(a, b))
            pairs.push_back({a.body, a.triangle, b.body, b.triangle});
    };
    for (std::uint32_t i = 0; i < items_.size(); ++i) {
        const Item& item = items_[i];
        if (item.everywhere)
            continue;
        for_each_cell(item.range, [&](const Cell& cell) {
            const std::uint32_t bucket = hash(cell, buckets);
            for (std::uint32_t e = bucket_[bucket]; e < bucket_[bucket + 1]; ++e) {
                const Item& other = items_[entries_[e].item];
                if (other.body >= item.body) // entries are in order of items, and so of bodies
                    break;
                if (entries_[e].cell == cell && reports(cell, other.range, item.range))
                    report(other, item);
            }
        });
    }
    for (const std::uint32_t i : everywhere_)
        for (std::uint32_t j = 0; j < items_.size(); ++j) {
            const Item &a = items_[i], &b = items_[j];
            if (b.everywhere && j <= i)
                continue; // it was i's turn
            if (a.body < b.body)
                report(a, b);
            else if (b.body < a.body)
                report(b, a);
        }
}

std::size_t SpatialHash::bytes() const
{
    return items_.capacity() * sizeof(Item) + everywhere_.capacity() * 4 + bucket_.capacity() * 4 +
           entries_.capacity() * sizeof(Entry);
}

} // namespace cinch
