// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "toolkit/simulate/body_simulation.hpp"
#include "toolkit/simulate/scene.hpp"

namespace cinch {

/// The bodies of a scene, on their way through time.
class Simulation {
public:
    struct Body {
        std::string name;
        BodySimulation simulation;
        std::vector<std::string> notes; ///< what a user should know of how it was set up
    };

    /// Loads surfaces, samples nodes, constructs the effects that the scene names. Throws InputError, naming file and
    /// path, for what cannot be: missing files, selections without nodes, effects that need what is not there.
    Simulation(Scene scene, const std::string& file);

    /// From one frame to the next. What bodies do to each other is found first, and holds for the frame; then they are
    /// independent of each other, and run in parallel. The same bits for any thread count. One report per body; if one
    /// failed, or an effect or a pin throws, every body has the state of before.
    std::vector<StepReport> advance();

    const Scene& scene() const { return scene_; }
    std::vector<Body>& bodies() { return bodies_; }
    const std::vector<Body>& bodies() const { return bodies_; }
    std::size_t frame() const { return frame_; } ///< 0 at the start
    std::size_t frame_count() const;             ///< the first one at time 0 included
    /// Of all bodies, in the order of the first that has each; with how many, if several have it.
    std::vector<std::string> notes() const;
    double time_s() const { return static_cast<double>(frame_) * scene_.frame_s; }
    /// One per effect of the scene that acts between bodies, in their order.
    std::span<const std::unique_ptr<Coupling>> couplings() const { return couplings_; }

    /// The state, so that restore() on the same scene continues bit for bit. A stream that is too short is left failed,
    /// and the state as it was.
    void save(std::ostream& out) const;
    void restore(std::istream& in);

private:
    Scene scene_;
    std::vector<Body> bodies_;
    std::vector<std::unique_ptr<Coupling>> couplings_;
    std::size_t frame_ = 0;
};

} // namespace cinch
