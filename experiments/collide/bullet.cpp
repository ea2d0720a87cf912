// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/collide/peers.hpp"

#include <algorithm>
#include <cmath>

#include <BulletCollision/Gimpact/btGImpactQuantizedBvh.h>

#include "experiments/collide/positions.hpp"

namespace cinch {
namespace {

// GImpact's quantised tree: the grid is fixed when it is built, so it is built from boxes 8 times as far apart and
// refitted from then on. It rounds to the nearest grid point, so boxes are grown by one.
class Bullet final : public Backend {
public:
    explicit Bullet(const CollideScene& scene) : positions_(scene)
    {
        trees_.resize(positions_.bodies());
        positions_.evaluate(0);
        for (std::size_t b = 0; b < trees_.size(); ++b) {
            Tree& tree = trees_[b];
            tree.boxes = {&positions_, b};
            tree.boxes.scale = 8;
            const auto& x = positions_.of(b);
            Vec3 low = x[0], high = x[0];
            for (const Vec3& v : x) {
                low = low.cwiseMin(v);
                high = high.cwiseMax(v);
            }
            tree.boxes.centre = low / 2 + high / 2;
            tree.boxes.quantum = (high - low) * (2 * 8 / 65535.0); // twice that of the grid
            tree.bvh.setPrimitiveManager(&tree.boxes);
            tree.bvh.buildSet();
            tree.boxes.scale = 1;
        }
    }
    void evaluate(std::size_t frame) override { positions_.evaluate(frame); }
    void update() override
    {
        for (Tree& tree : trees_)
            tree.bvh.update();
    }
    void query(std::vector<TrianglePair>& pairs) override
    {
        std::vector<Vec3> low, high;
        for (const Tree& tree : trees_) {
            btAABB root; // the global box is that of the grid
            tree.bvh.getNodeBound(0, root);
            low.emplace_back(root.m_min.x(), root.m_min.y(), root.m_min.z());
            high.emplace_back(root.m_max.x(), root.m_max.y(), root.m_max.z());
        }
        const btTransform identity = btTransform::getIdentity();
        for (const auto& [a, b] : overlapping_bodies(low, high)) {
            btPairSet found;
            btGImpactQuantizedBvh::find_collision(&trees_[a].bvh, identity, &trees_[b].bvh, identity, found);
            for (int i = 0; i < found.size(); ++i) {
                const auto s = static_cast<std::uint32_t>(found[i].m_index1),
                           t = static_cast<std::uint32_t>(found[i].m_index2);
                if (positions_.intersect(a, s, b, t))
                    pairs.push_back({a, s, b, t});
            }
        }
    }
    std::size_t bytes() const override
    {
        std::size_t bytes = positions_.bytes();
        for (const Tree& tree : trees_)
            bytes += static_cast<std::size_t>(tree.bvh.getNodeCount()) * sizeof(BT_QUANTIZED_BVH_NODE);
        return bytes;
    }

private:
    struct Boxes final : btPrimitiveManagerBase {
        const Positions* positions = nullptr;
        std::size_t body = 0;
        double scale = 1;
        Vec3 centre = Vec3::Zero(), quantum = Vec3::Zero();

        Boxes() = default;
        Boxes(const Positions* p, std::size_t b) : positions(p), body(b) {}
        bool is_trimesh() const override { return true; }
        int get_primitive_count() const override { return static_cast<int>(positions->mesh(body).triangles.size()); }
        void get_primitive_box(int primitive, btAABB& box) const override
        {
            const TrianglePoints p = positions->triangle(body, static_cast<std::uint32_t>(primitive));
            const Vec3 low = p[0].cwiseMin(p[1]).cwiseMin(p[2]) - quantum,
                       high = p[0].cwiseMax(p[1]).cwiseMax(p[2]) + quantum;
            auto vector = [&](const Vec3& v) {
                const Vec3 x = scale == 1 ? v : Vec3(centre + scale * (v - centre));
                return btVector3(static_cast<btScalar>(x[0]), static_cast<btScalar>(x[1]), static_cast<btScalar>(x[2]));
            };
            box.m_min = vector(low);
            box.m_max = vector(high);
        }
        void get_primitive_triangle(int, btPrimitiveTriangle&) const override {}
    };
    struct Tree {
        Boxes boxes;
        btGImpactQuantizedBvh bvh;
    };

    Positions positions_;
    std::vector<Tree> trees_;
};

} // namespace

std::unique_ptr<Backend> make_bullet(const CollideScene& scene) { return std::make_unique<Bullet>(scene); }

} // namespace cinch
