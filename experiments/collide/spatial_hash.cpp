// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/baselines/spatial_hash.hpp"

#include "experiments/collide/own.hpp"
#include "experiments/collide/positions.hpp"

namespace cinch {
namespace {

class Hash final : public Backend {
public:
    explicit Hash(const CollideScene& scene) : positions_(scene) {}
    void evaluate(std::size_t frame) override { positions_.evaluate(frame); }
    void update() override
    {
        std::vector<SpatialHash::Body> bodies;
        for (std::size_t b = 0; b < positions_.bodies(); ++b)
            bodies.push_back({&positions_.mesh(b), positions_.of(b)});
        hash_.load(bodies);
    }
    void query(std::vector<TrianglePair>& pairs) override { hash_.find(pairs); }
    std::size_t bytes() const override { return positions_.bytes() + hash_.bytes(); }

private:
    Positions positions_;
    SpatialHash hash_;
};

} // namespace

std::unique_ptr<Backend> make_spatial_hash(const CollideScene& scene) { return std::make_unique<Hash>(scene); }

} // namespace cinch
