// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/collide/peers.hpp"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include "experiments/collide/positions.hpp"

namespace cinch {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Iterator = std::vector<Kernel::Triangle_3>::const_iterator;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, CGAL::AABB_triangle_primitive<Kernel, Iterator>>>;

// It has no refit: every frame builds anew. The triangles of one body near the other are asked for one by one; boxes by
// CGAL, triangles by the exact test all others use.
class Cgal final : public Backend {
public:
    explicit Cgal(const CollideScene& scene)
        : positions_(scene), triangles_(positions_.bodies()), trees_(positions_.bodies())
    {
    }
    void evaluate(std::size_t frame) override { positions_.evaluate(frame); }
    void update() override
    {
        auto point = [](const Vec3& v) { return Kernel::Point_3(v[0], v[1], v[2]); };
        for (std::size_t b = 0; b < trees_.size(); ++b) {
            triangles_[b].clear();
            for (std::uint32_t t = 0; t < positions_.mesh(b).triangles.size(); ++t) {
                const TrianglePoints p = positions_.triangle(b, t);
                triangles_[b].emplace_back(point(p[0]), point(p[1]), point(p[2]));
            }
            trees_[b] = std::make_unique<Tree>(triangles_[b].begin(), triangles_[b].end());
            trees_[b]->build();
        }
    }
    void query(std::vector<TrianglePair>& pairs) override
    {
        std::vector<Vec3> low, high;
        for (const auto& tree : trees_) {
            const CGAL::Bbox_3 box = tree->bbox();
            low.emplace_back(box.xmin(), box.ymin(), box.zmin());
            high.emplace_back(box.xmax(), box.ymax(), box.zmax());
        }
        std::vector<Tree::Primitive_id> near;
        for (const auto& [a, b] : overlapping_bodies(low, high)) {
            const CGAL::Bbox_3 other = trees_[b]->bbox();
            near.clear();
            trees_[a]->all_intersected_primitives(Kernel::Iso_cuboid_3(other), std::back_inserter(near));
            for (const Iterator i : near) {
                std::vector<Tree::Primitive_id> found;
                trees_[b]->all_intersected_primitives(Kernel::Iso_cuboid_3(i->bbox()), std::back_inserter(found));
                const auto s = static_cast<std::uint32_t>(i - triangles_[a].begin());
                for (const Iterator j : found)
                    if (const auto t = static_cast<std::uint32_t>(j - triangles_[b].begin());
                        positions_.intersect(a, s, b, t))
                        pairs.push_back({a, s, b, t});
            }
        }
    }
    std::size_t bytes() const override
    {
        std::size_t bytes = positions_.bytes();
        for (const auto& triangles : triangles_)
            bytes += triangles.size() * (sizeof(Kernel::Triangle_3) + sizeof(CGAL::Bbox_3));
        return bytes;
    }

private:
    Positions positions_;
    std::vector<std::vector<Kernel::Triangle_3>> triangles_;
    std::vector<std::unique_ptr<Tree>> trees_;
};

} // namespace

std::unique_ptr<Backend> make_cgal(const CollideScene& scene) { return std::make_unique<Cgal>(scene); }

} // namespace cinch
