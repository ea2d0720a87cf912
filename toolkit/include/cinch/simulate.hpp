// SPDX-License-Identifier: Apache-2.0
#pragma once

/// \file
/// Scenes of simulated bodies: nodes with least-squares gradients, and only the effects that a scene names.

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cinch/io.hpp"

namespace cinch {

/// A force of one's own on the simulation nodes of a body, beside the effects that the scene names.
class OwnForce {
public:
    /// Where a body's simulation nodes are. Views.
    struct Nodes {
        std::span<const Vec3> position; ///< m, in the world
        std::span<const double> mass;   ///< kg
        double time_s = 0;              ///< since the start of the scene
    };

    virtual ~OwnForce() = default;
    /// U, J: the implicit integrator minimises it together with all others.
    virtual double energy(const Nodes& nodes) const = 0;
    /// Adds −∂U/∂X, N. Called by several threads at once.
    virtual void add(const Nodes& nodes, std::span<Vec3> force) const = 0;
};

/// A scene (JSON, its schema is data/scenes/schema.json) on its way through time.
class SceneSimulation {
public:
    /// Throws InputError, one line with file, place in it and reason, for what cannot be. `decoders`: of characters in
    /// compressed files.
    explicit SceneSimulation(const std::filesystem::path& scene, const Decompression* decoders = nullptr);
    /// From text; `name` is for messages, and relative file names are taken from `folder`.
    SceneSimulation(std::string_view json, const std::string& name, const std::filesystem::path& folder,
                    const Decompression* decoders = nullptr);
    ~SceneSimulation();
    /// What was moved from can only be assigned to or destroyed.
    SceneSimulation(SceneSimulation&&) noexcept;
    /// The same.
    SceneSimulation& operator=(SceneSimulation&&) noexcept;

    /// Bodies are 0, 1, ..., in the order of the scene.
    std::size_t body_count() const;
    /// As the scene calls it.
    const std::string& name(std::size_t body) const;
    /// What a body's nodes deform; null where it has no surface. It stays where it is.
    const DeformableSurface* surface(std::size_t body) const;
    /// Acts from the next step on.
    void add(std::size_t body, std::unique_ptr<const OwnForce> force);

    std::size_t frame() const;       ///< 0 at the start
    std::size_t frame_count() const; ///< that the scene asks for, the start included
    double time_s() const;           ///< since the start
    /// To the next frame. The same bits for any number of threads. Throws std::runtime_error with time, body and reason
    /// for a step that cannot be solved; the state is that before it then.
    void advance();
    /// One map per simulation node, at present: what moves the surface.
    std::vector<AffineMap> transforms(std::size_t body) const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

} // namespace cinch
