// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/collide/own.hpp"

#include "experiments/collide/positions.hpp"

namespace cinch {
namespace {

using Quad = Eigen::Array4f;

// In floats, rounded outward cheaply: a float's ulp is at most 2^-23 of it.
struct Box {
    Quad low, high; // x, y, z, 0

    bool overlaps(const Box& other) const { return !((low > other.high) || (other.low > high)).any(); }
};
Box outward(const Vec3& low, const Vec3& high)
{
    const Quad l(static_cast<float>(low[0]), static_cast<float>(low[1]), static_cast<float>(low[2]), 0);
    const Quad h(static_cast<float>(high[0]), static_cast<float>(high[1]), static_cast<float>(high[2]), 0);
    return {l - l.abs() * 0x1p-23f, h + h.abs() * 0x1p-23f};
}

// The exact box of a triangle, computed where a leaf is tested.
struct TriangleBox {
    Vec3 low, high;

    explicit TriangleBox(const TrianglePoints& p)
        : low(p[0].cwiseMin(p[1]).cwiseMin(p[2])), high(p[0].cwiseMax(p[1]).cwiseMax(p[2]))
    {
    }
    bool overlaps(const TriangleBox& other) const
    {
        for (int r = 0; r < 3; ++r)
            if (high[r] < other.low[r] || other.high[r] < low[r])
                return false;
        return true;
    }
};

// The classical way [van den Bergen 1997]: all vertices, all triangles' boxes, all boxes bottom-up, then two trees
// against each other.
class FullRefit final : public Backend {
public:
    FullRefit(const CollideScene& scene, bool single) : positions_(scene)
    {
        for (const Input& body : scene.bodies) {
            const Bvh& bvh =
                scene.trees.of(body.surface, single ? ClusterSize{1, 3} : ClusterSize{16, 16}, RestDetail::boxes);
            Tree& tree = trees_.emplace_back();
            tree.triangle = bvh.triangle;
            for (const Bv& bv : bvh.bvs) {
                Node node{bv.first_child, bv.first_triangle, bv.triangle_count,
                          static_cast<std::uint32_t>(tree.vertex.size()), 0};
                if (bv.is_leaf()) {
                    const auto vertices = vertices_of(body.surface, bvh, bv);
                    tree.vertex.insert(tree.vertex.end(), vertices.begin(), vertices.end());
                    node.vertices = static_cast<std::uint32_t>(vertices.size());
                }
                tree.nodes.push_back(node);
            }
            tree.boxes.resize(bvh.bvs.size());
        }
    }
    void evaluate(std::size_t frame) override { positions_.evaluate(frame); }
    void update() override
    {
        for (std::size_t b = 0; b < trees_.size(); ++b)
            refit(b);
    }
    void query(std::vector<TrianglePair>& pairs) override
    {
        std::vector<Vec3> low, high;
        for (const Tree& tree : trees_) {
            low.push_back(tree.boxes[0].low.head<3>().cast<double>());
            high.push_back(tree.boxes[0].high.head<3>().cast<double>());
        }
        for (const auto& [a, b] : overlapping_bodies(low, high))
            descend(a, b, pairs);
    }
    std::size_t bytes() const override
    {
        std::size_t bytes = positions_.bytes();
        for (const Tree& tree : trees_)
            bytes += tree.boxes.size() * (sizeof(Box) + sizeof(Node)) +
                     (tree.triangle.size() + tree.vertex.size()) * sizeof(std::uint32_t);
        return bytes;
    }

private:
    struct Node {
        std::uint32_t child, first, count, first_vertex, vertices; // child: 0 for a leaf; first, count: triangles
    };
    struct Tree {
        std::vector<std::uint32_t> triangle, vertex; // vertex: of each leaf, each once
        std::vector<Node> nodes;                     // children after parents
        std::vector<Box> boxes;
    };

    void refit(std::size_t b)
    {
        Tree& tree = trees_[b];
        const Vec3* const positions = positions_.of(b).data();
        for (std::size_t i = tree.nodes.size(); i-- > 0;) {
            const Node& node = tree.nodes[i];
            if (node.child) {
                const Box &left = tree.boxes[node.child], &right = tree.boxes[node.child + 1];
                tree.boxes[i] = {left.low.min(right.low), left.high.max(right.high)};
                continue;
            }
            const std::uint32_t* const vertex = &tree.vertex[node.first_vertex];
            Vec3 low = positions[vertex[0]], high = low;
            for (std::uint32_t v = 1; v < node.vertices; ++v) {
                low = low.cwiseMin(positions[vertex[v]]);
                high = high.cwiseMax(positions[vertex[v]]);
            }
            tree.boxes[i] = outward(low, high);
        }
    }
    void descend(std::uint32_t a, std::uint32_t b, std::vector<TrianglePair>& pairs)
    {
        const Tree &ta = trees_[a], &tb = trees_[b];
        stack_.assign(1, {0, 0});
        while (!stack_.empty()) {
            const auto [i, j] = stack_.back();
            stack_.pop_back();
            const Node &x = ta.nodes[i], &y = tb.nodes[j];
            if (!x.child && !y.child) {
                test(a, b, i, j, pairs);
                continue;
            }
            const bool open_a = x.child && (!y.child || x.count >= y.count);
            for (std::uint32_t c = 0; c < 2; ++c) {
                const std::uint32_t p = open_a ? x.child + c : i, q = open_a ? j : y.child + c;
                if (ta.boxes[p].overlaps(tb.boxes[q]))
                    stack_.emplace_back(p, q);
            }
        }
    }
    void test(std::uint32_t a, std::uint32_t b, std::uint32_t i, std::uint32_t j, std::vector<TrianglePair>& pairs)
    {
        const Tree &ta = trees_[a], &tb = trees_[b];
        const Node &x = ta.nodes[i], &y = tb.nodes[j];
        near_.clear();
        for (std::uint32_t t = y.first; t < y.first + y.count; ++t)
            if (const TriangleBox box(positions_.triangle(b, tb.triangle[t]));
                outward(box.low, box.high).overlaps(ta.boxes[i]))
                near_.emplace_back(tb.triangle[t], box);
        if (near_.empty())
            return;
        for (std::uint32_t s = x.first; s < x.first + x.count; ++s) {
            const TrianglePoints points = positions_.triangle(a, ta.triangle[s]);
            const TriangleBox box(points);
            if (!outward(box.low, box.high).overlaps(tb.boxes[j]))
                continue;
            for (const auto& [t, other] : near_)
                if (box.overlaps(other) && intersect(points, positions_.triangle(b, t)))
                    pairs.push_back({a, ta.triangle[s], b, t});
        }
    }

    Positions positions_;
    std::vector<Tree> trees_;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> stack_;
    std::vector<std::pair<std::uint32_t, TriangleBox>> near_;
};

} // namespace

std::unique_ptr<Backend> make_full_refit_1(const CollideScene& scene)
{
    return std::make_unique<FullRefit>(scene, true);
}
std::unique_ptr<Backend> make_full_refit_16(const CollideScene& scene)
{
    return std::make_unique<FullRefit>(scene, false);
}

} // namespace cinch
