// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "cinch/collider.hpp"
#include "experiments/collide/rest_trees.hpp"
#include "experiments/input.hpp"

namespace cinch {

/// The bodies of a scene and their frames; all bodies have the same number of them. The frames are made beforehand:
/// what is timed is what a backend does with them.
class CollideScene {
public:
    CollideScene(std::string scene_name, std::vector<Input> scene_bodies)
        : name(std::move(scene_name)), bodies(std::move(scene_bodies))
    {
        for (const Input& body : bodies) {
            maps_.emplace_back();
            for (std::size_t f = 0; f < frames(); ++f)
                maps_.back().push_back(body.clip.frame(f));
        }
    }

    std::string name;
    std::vector<Input> bodies;

    std::size_t frames() const { return bodies[0].clip.frame_count(); }
    std::span<const AffineMap> maps(std::size_t body, std::size_t frame) const { return maps_[body][frame]; }

    mutable RestTrees trees; ///< while backends are built

private:
    std::vector<std::vector<Clip::Frame>> maps_; ///< by body and frame
};

/// A way of finding the intersecting pairs of triangles of a scene. The three steps of a frame are timed one by one.
class Backend {
public:
    virtual ~Backend() = default;

    virtual void evaluate(std::size_t frame) = 0; ///< all vertices; nothing where they are evaluated on demand
    virtual void update() = 0;
    virtual void query(std::vector<TrianglePair>& pairs) = 0;     ///< appends; in any order
    virtual std::size_t bytes() const = 0;                        ///< of what it keeps besides surfaces and clips
    virtual const QueryCounts* counts() const { return nullptr; } ///< of the last frame, if it counts
};

/// One that can be had by name.
struct BackendKind {
    std::string name, what; ///< what: for people
    std::unique_ptr<Backend> (*make)(const CollideScene& scene);
};

/// This project's own, its baselines, and the peers that were there when the program was built.
const std::vector<BackendKind>& backend_kinds();

/// The pairs of bodies whose world boxes overlap, a < b. `low` and `high` per body.
std::vector<std::pair<std::uint32_t, std::uint32_t>> overlapping_bodies(const std::vector<Vec3>& low,
                                                                        const std::vector<Vec3>& high);

} // namespace cinch
