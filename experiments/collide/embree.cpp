// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/collide/peers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include "cinch/surface.hpp"
#include "experiments/collide/positions.hpp"

namespace cinch {
namespace {

// User geometry per body (rtcCollide takes no other), refitted in place: REFIT needs a dynamic scene, or it rebuilds
// silently.
class Embree final : public Backend {
public:
    explicit Embree(const CollideScene& scene) : positions_(scene), device_(rtcNewDevice("threads=1"))
    {
        if (!device_)
            throw InputError("Embree: no device");
        bodies_.resize(positions_.bodies());
        for (std::size_t b = 0; b < bodies_.size(); ++b) {
            Body& body = bodies_[b];
            body.owner = this;
            body.index = static_cast<std::uint32_t>(b);
            body.scene = rtcNewScene(device_);
            rtcSetSceneFlags(body.scene, RTC_SCENE_FLAG_DYNAMIC);
            rtcSetSceneBuildQuality(body.scene, RTC_BUILD_QUALITY_LOW);
            body.geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_USER);
            rtcSetGeometryBuildQuality(body.geometry, RTC_BUILD_QUALITY_REFIT);
            rtcSetGeometryUserPrimitiveCount(body.geometry, static_cast<unsigned>(positions_.mesh(b).triangles.size()));
            rtcSetGeometryUserData(body.geometry, &body);
            rtcSetGeometryBoundsFunction(body.geometry, bounds, nullptr);
            rtcCommitGeometry(body.geometry);
            rtcAttachGeometryByID(body.scene, body.geometry, 0);
        }
    }
    ~Embree() override
    {
        for (Body& body : bodies_) {
            rtcReleaseGeometry(body.geometry);
            rtcReleaseScene(body.scene);
        }
        rtcReleaseDevice(device_);
    }
    void evaluate(std::size_t frame) override { positions_.evaluate(frame); }
    void update() override
    {
        for (Body& body : bodies_) {
            rtcCommitGeometry(body.geometry);
            rtcCommitScene(body.scene);
        }
    }
    void query(std::vector<TrianglePair>& pairs) override
    {
        std::vector<Vec3> low, high;
        for (const Body& body : bodies_) {
            RTCBounds box;
            rtcGetSceneBounds(body.scene, &box);
            low.emplace_back(box.lower_x, box.lower_y, box.lower_z);
            high.emplace_back(box.upper_x, box.upper_y, box.upper_z);
        }
        pairs_ = &pairs;
        for (const auto& [a, b] : overlapping_bodies(low, high)) {
            a_ = a;
            b_ = b;
            rtcCollide(bodies_[a].scene, bodies_[b].scene, collide, this);
        }
    }
    std::size_t bytes() const override { return positions_.bytes(); }

private:
    struct Body {
        Embree* owner;
        std::uint32_t index;
        RTCScene scene;
        RTCGeometry geometry;
    };
    static void bounds(const RTCBoundsFunctionArguments* args)
    {
        const auto& body = *static_cast<const Body*>(args->geometryUserPtr);
        const TrianglePoints p = body.owner->positions_.triangle(body.index, args->primID);
        const Vec3 low = p[0].cwiseMin(p[1]).cwiseMin(p[2]), high = p[0].cwiseMax(p[1]).cwiseMax(p[2]);
        // Rounded outward cheaply: a float's ulp is at most 2^-23 of it.
        auto down = [](double x) { return static_cast<float>(x - std::abs(x) * 0x1p-23); };
        auto up = [](double x) { return static_cast<float>(x + std::abs(x) * 0x1p-23); };
        *args->bounds_o = {down(low[0]), down(low[1]), down(low[2]), 0, up(high[0]), up(high[1]), up(high[2]), 0};
    }
    static void collide(void* self, RTCCollision* collisions, unsigned count)
    {
        auto& me = *static_cast<Embree*>(self);
        for (unsigned i = 0; i < count; ++i)
            if (me.positions_.intersect(me.a_, collisions[i].primID0, me.b_, collisions[i].primID1)) {
                const std::lock_guard lock(me.mutex_);
                me.pairs_->push_back({me.a_, collisions[i].primID0, me.b_, collisions[i].primID1});
            }
    }

    Positions positions_;
    RTCDevice device_;
    std::vector<Body> bodies_;
    std::vector<TrianglePair>* pairs_ = nullptr;
    std::uint32_t a_ = 0, b_ = 0;
    std::mutex mutex_; // collisions may come from several threads
};

} // namespace

std::unique_ptr<Backend> make_embree(const CollideScene& scene) { return std::make_unique<Embree>(scene); }

} // namespace cinch
