// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/collide/peers.hpp"

#include <fcl/fcl.h>

#include "experiments/collide/positions.hpp"

namespace cinch {
namespace {

using Model = fcl::BVHModel<fcl::AABB<double>>;

// Boxes by FCL, triangles by the exact test all others use. fcl::collide() would copy both models on every call.
class Traversal final : public fcl::detail::BVHCollisionTraversalNode<fcl::AABB<double>> {
public:
    const Positions* positions = nullptr;
    std::uint32_t a = 0, b = 0;
    std::vector<TrianglePair>* pairs = nullptr;

    void leafTesting(int node_a, int node_b) const override
    {
        const auto i = static_cast<std::uint32_t>(model1->getBV(node_a).primitiveId()),
                   j = static_cast<std::uint32_t>(model2->getBV(node_b).primitiveId());
        if (positions->intersect(a, i, b, j))
            pairs->push_back({a, i, b, j});
    }
    bool canStop() const override { return false; }
};

class Fcl final : public Backend {
public:
    explicit Fcl(const CollideScene& scene) : positions_(scene)
    {
        for (std::size_t b = 0; b < positions_.bodies(); ++b) {
            const TriangleMesh& mesh = positions_.mesh(b);
            std::vector<fcl::Triangle> triangles;
            for (const Triangle& t : mesh.triangles)
                triangles.emplace_back(t[0], t[1], t[2]);
            auto model = std::make_unique<Model>();
            model->beginModel(static_cast<int>(triangles.size()), static_cast<int>(mesh.vertices.size()));
            model->addSubModel(mesh.vertices, triangles);
            model->endModel();
            models_.push_back(std::move(model));
        }
    }
    void evaluate(std::size_t frame) override { positions_.evaluate(frame); }
    void update() override
    {
        for (std::size_t b = 0; b < models_.size(); ++b) {
            models_[b]->beginReplaceModel(); // beginUpdateModel would make swept boxes
            models_[b]->replaceSubModel(positions_.of(b));
            models_[b]->endReplaceModel(true, true);
        }
    }
    void query(std::vector<TrianglePair>& pairs) override
    {
        std::vector<Vec3> low, high;
        for (const auto& model : models_) {
            low.push_back(model->getBV(0).bv.min_);
            high.push_back(model->getBV(0).bv.max_);
        }
        for (const auto& [a, b] : overlapping_bodies(low, high)) {
            Traversal traversal;
            traversal.model1 = models_[a].get();
            traversal.model2 = models_[b].get();
            traversal.positions = &positions_;
            traversal.a = a;
            traversal.b = b;
            traversal.pairs = &pairs;
            fcl::detail::collide<double>(&traversal);
        }
    }
    std::size_t bytes() const override
    {
        std::size_t bytes = positions_.bytes();
        for (const auto& model : models_)
            bytes += static_cast<std::size_t>(model->memUsage(0));
        return bytes;
    }

private:
    Positions positions_;
    std::vector<std::unique_ptr<Model>> models_;
};

} // namespace

std::unique_ptr<Backend> make_fcl(const CollideScene& scene) { return std::make_unique<Fcl>(scene); }

} // namespace cinch
