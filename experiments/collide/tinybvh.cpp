// SPDX-License-Identifier: GPL-3.0-or-later
// tinybvh (its header's path is given to CMake, CINCH_TINYBVH): a binned SAH tree over each body's triangles, refitted;
// pairs by descending both trees at once, the larger box first. It has no query between two trees of its own.
#include "experiments/collide/peers.hpp"

#include <cmath>

#include <immintrin.h>

#define TINYBVH_IMPLEMENTATION
#include CINCH_TINYBVH

#include "experiments/collide/positions.hpp"

namespace cinch {
namespace {

using Node = tinybvh::BVH::BVHNode;

class TinyBvh final : public Backend {
public:
    explicit TinyBvh(const CollideScene& scene) : positions_(scene), bodies_(positions_.bodies())
    {
        positions_.evaluate(0);
        for (std::size_t b = 0; b < bodies_.size(); ++b) {
            Body& body = bodies_[b];
            for (const Triangle& t : positions_.mesh(b).triangles)
                body.index.insert(body.index.end(), t.begin(), t.end());
            body.vertex.resize(positions_.of(b).size());
            take_vertices(b);
            body.tree.Build(body.vertex.data(), body.index.data(), static_cast<std::uint32_t>(body.index.size() / 3));
        }
    }
    void evaluate(std::size_t frame) override { positions_.evaluate(frame); }
    void update() override
    {
        for (std::size_t b = 0; b < bodies_.size(); ++b) {
            take_vertices(b);
            bodies_[b].tree.Refit();
        }
    }
    void query(std::vector<TrianglePair>& pairs) override
    {
        std::vector<Vec3> low, high;
        for (const Body& body : bodies_) {
            const Node& root = body.tree.bvhNode[0];
            const Vec3 room = Vec3::Constant(body.rounding);
            low.push_back(Vec3(root.aabbMin.x, root.aabbMin.y, root.aabbMin.z) - room);
            high.push_back(Vec3(root.aabbMax.x, root.aabbMax.y, root.aabbMax.z) + room);
        }
        for (const auto& [a, b] : overlapping_bodies(low, high))
            descend(a, b, pairs);
    }
    std::size_t bytes() const override
    {
        std::size_t bytes = positions_.bytes();
        for (const Body& body : bodies_)
            bytes += body.vertex.size() * sizeof body.vertex[0] + body.index.size() * 2 * sizeof(std::uint32_t) +
                     body.tree.usedNodes * sizeof(Node);
        return bytes;
    }

private:
    struct Body {
        std::vector<tinybvh::bvhvec4> vertex;
        std::vector<std::uint32_t> index;
        tinybvh::BVH tree;
        float rounding = 0; // how far vertices of float may be from those of double
    };

    void take_vertices(std::size_t b)
    {
        Body& body = bodies_[b];
        const std::vector<Vec3>& places = positions_.of(b);
        double most = 0;
        for (std::size_t v = 0; v < places.size(); ++v) {
            body.vertex[v] = {static_cast<float>(places[v][0]), static_cast<float>(places[v][1]),
                              static_cast<float>(places[v][2]), 0};
            most = std::max(most, places[v].cwiseAbs().maxCoeff());
        }
        body.rounding = static_cast<float>(most * 0x1p-23);
    }

    static float size_of(const Node& node)
    {
        const tinybvh::bvhvec3 d = node.aabbMax - node.aabbMin;
        return d.x * d.y + d.y * d.z + d.z * d.x;
    }

    void descend(std::uint32_t a, std::uint32_t b, std::vector<TrianglePair>& pairs)
    {
        const tinybvh::BVH &tree_a = bodies_[a].tree, &tree_b = bodies_[b].tree;
        const __m128 room = _mm_set1_ps(bodies_[a].rounding + bodies_[b].rounding);
        stack_.assign(1, {0, 0});
        while (!stack_.empty()) {
            const auto [i, j] = stack_.back();
            stack_.pop_back();
            const Node &p = tree_a.bvhNode[i], &q = tree_b.bvhNode[j];
            const __m128 p_low = _mm_loadu_ps(&p.aabbMin.x), p_high = _mm_loadu_ps(&p.aabbMax.x),
                         q_low = _mm_loadu_ps(&q.aabbMin.x), q_high = _mm_loadu_ps(&q.aabbMax.x);
            const __m128 apart =
                _mm_or_ps(_mm_cmpgt_ps(_mm_sub_ps(p_low, room), q_high), _mm_cmpgt_ps(_mm_sub_ps(q_low, room), p_high));
            if (_mm_movemask_ps(apart) & 7)
                continue;
            if (p.isLeaf() && q.isLeaf()) {
                for (std::uint32_t m = 0; m < p.triCount; ++m)
                    for (std::uint32_t n = 0; n < q.triCount; ++n) {
                        const std::uint32_t s = tree_a.primIdx[p.leftFirst + m], t = tree_b.primIdx[q.leftFirst + n];
                        if (positions_.intersect(a, s, b, t))
                            pairs.push_back({a, s, b, t});
                    }
            } else if (q.isLeaf() || (!p.isLeaf() && size_of(p) >= size_of(q))) {
                stack_.push_back({p.leftFirst + 1, j});
                stack_.push_back({p.leftFirst, j});
            } else {
                stack_.push_back({i, q.leftFirst + 1});
                stack_.push_back({i, q.leftFirst});
            }
        }
    }

    Positions positions_;
    std::vector<Body> bodies_;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> stack_;
};

} // namespace

std::unique_ptr<Backend> make_tinybvh(const CollideScene& scene) { return std::make_unique<TinyBvh>(scene); }

} // namespace cinch
