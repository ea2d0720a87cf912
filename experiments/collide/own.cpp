// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/collide/own.hpp"

#include "experiments/report/interrupt.hpp"

namespace cinch {
namespace {

class Own final : public Backend {
public:
    Own(const CollideScene& scene, const LazyOptions& options, ClusterSize leaf)
        : scene_(scene), collider_(options), frames_(scene.bodies.size())
    {
        const RestDetail detail = options.methods.within(box_methods) ? RestDetail::boxes : RestDetail::inner;
        for (const Input& body : scene.bodies) { // the trees keep what they need
            throw_if_interrupted();
            collider_.add(Bvh(scene.trees.of(body.surface, leaf, detail)), body.surface);
        }
    }
    void evaluate(std::size_t frame) override
    {
        for (std::size_t b = 0; b < frames_.size(); ++b)
            frames_[b] = {scene_.maps(b, frame)};
    }
    void update() override { collider_.update(frames_); }
    void query(std::vector<TrianglePair>& pairs) override
    {
        collider_.find(Query::pairs, [&](std::span<const TrianglePair> some) {
            pairs.insert(pairs.end(), some.begin(), some.end());
            return true;
        });
    }
    std::size_t bytes() const override { return collider_.bytes(); }
    const QueryCounts* counts() const override { return &collider_.counts(); }

private:
    const CollideScene& scene_;
    Collider collider_;
    std::vector<BodyFrame> frames_;
};

LazyOptions with_update(Update update)
{
    LazyOptions options;
    options.update = update;
    return options;
}

} // namespace

std::unique_ptr<Backend> make_default(const CollideScene& scene)
{
    return std::make_unique<Own>(scene, LazyOptions{}, ClusterSize{16, 16});
}

std::unique_ptr<Backend> make_simd_refit(const CollideScene& scene)
{
    return std::make_unique<Own>(scene, with_update(Update::full), ClusterSize{16, 16});
}

std::unique_ptr<Backend> make_pair_front(const CollideScene& scene)
{
    LazyOptions options = with_update(Update::lazy);
    options.keep_cut = false;
    return std::make_unique<Own>(scene, options, ClusterSize{16, 16});
}

std::unique_ptr<Backend> make_paper(const CollideScene& scene, int kdop, RestShape shape)
{
    LazyOptions options = with_update(Update::lazy);
    options.methods = Method::eq12;
    options.kdop = kdop;
    options.rest_shape = shape;
    options.lanes = 4;
    return std::make_unique<Own>(scene, options, ClusterSize{1, 3});
}

} // namespace cinch
