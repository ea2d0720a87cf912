// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>

#include "toolkit/simulate/body_forces.hpp"
#include "toolkit/simulate/integration.hpp"

namespace cinch {

/// A body, its effects and its state. Moving it keeps it valid.
class BodySimulation {
public:
    /// Positions and velocities begin at rest at the body's own places.
    BodySimulation(MeshlessBody body, std::optional<DeformableSurface> surface);

    void add(std::unique_ptr<const Effect> effect);
    void add(Pin pin);

    /// Advances by `dt_s` ≥ 0 in as many steps as the method and the pins' turning need; 0 changes nothing. Throws
    /// std::invalid_argument for a negative or non-finite dt. If a step fails, says so; then, and if an effect or a pin
    /// throws, the state stays that before it, what effects remember included.
    StepReport advance(double dt_s, const Integration& integration);

    const BodyModel& model() const { return *model_; }
    const MeshlessBody& body() const { return model_->body; }
    const std::optional<DeformableSurface>& surface() const { return model_->surface; }
    std::span<const std::unique_ptr<const Effect>> effects() const { return model_->effects; }
    EffectCost cost(std::size_t effect) const { return forces_.cost(effect); }
    /// Of computing J and carrying stresses to nodes.
    double shared_seconds() const { return forces_.shared_seconds(); }

    const BodyState& state() const { return state_; }
    /// One that state() gave once, since the last effect was added.
    void set_state(BodyState state) { state_ = std::move(state); }
    void set_memory(std::size_t effect, Memory memory) { state_.memory.at(effect) = std::move(memory); }
    double time_s() const { return state_.time_s; }
    const Field& positions() const { return state_.x; }
    const Field& velocities() const { return state_.v; }
    void place(const Field& positions, const Field& velocities); ///< at time 0
    /// The shape at rest, turned about its 0 and moved by `position`; without the rounding of positions in the world.
    void place(const Vec3& position, const Mat3& rotation, const Field& velocities);
    const Reference& reference() const { return state_.reference; }
    const std::vector<Mat3>& plastic_inverse() const { return state_.plastic_inverse; }

    /// T_j of every node, seen from a point of the world.
    std::vector<AffineMap> frame(const Vec3& from = Vec3::Zero()) const;
    /// Energies of the present state, J.
    double kinetic() const { return state_.kinetic(body()); }
    double potential() const;
    /// The forces on the nodes at present, N; of the effect of that index alone, if one is given.
    Field forces(std::optional<std::size_t> only = {}) const;
    /// ∂²U/∂X² · dx at present, N.
    Field stiffness(const Field& dx) const;

    /// See BodyState; a stream that is too short is left failed, and the state as it was.
    void save(std::ostream& out) const { state_.save(out); }
    void restore(std::istream& in);

private:
    std::unique_ptr<BodyModel> model_; ///< at a place that stays
    BodyState state_;
    BodyForces forces_;
    Completion completion_ = Completion::on;
};

} // namespace cinch
