// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <initializer_list>
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "toolkit/simulate/effect.hpp"
#include "toolkit/simulate/pin.hpp"

namespace cinch {

/// How a body is moved through time.
struct Integration {
    enum class Method { explicit_euler, implicit_euler };
    Method method = Method::implicit_euler;
    double step_s = 1.0 / 60; ///< of the implicit integrator; of the explicit one the longest substep
    double safety = 0.6;      ///< explicit: share of the longest stable substep
    double tolerance =
        1e-5; ///< implicit: greatest error of an acceleration that is left, over the greatest one (ImplicitStep)
    int most_iterations = 200; ///< implicit: of Newton's method
    bool project =
        true; ///< implicit: make the Hessian positive semidefinite where it proves not to be (off only in experiments)
    Completion completion = Completion::on;
    bool (*cancelled)() = nullptr; ///< asked between steps; a cancelled call fails, and keeps the state before it
};

/// What a step did.
struct StepReport {
    double dt_s = 0;
    int substeps = 0, iterations = 0, products = 0; ///< Newton iterations; products with the Hessian
    int halved = 0;                                 ///< steps that were taken back and made in halves
    int projected = 0;                              ///< iterations that needed a positive semidefinite Hessian
    double residual =
        0; ///< m/s², of the last step: the greatest error of an acceleration; 0 for the explicit integrator
    double acceleration = 0; ///< m/s², of the last step: what the tolerance was relative to
    bool at_rounding =
        false; ///< the residual is what rounding leaves of forces inside the body that balance (ImplicitStep)
    double kinetic = 0, potential = 0; ///< J, at the end
    double seconds = 0;                ///< of wall time
    std::string failure;               ///< why it could not be made; the state is that before it
};

/// A body, its effects and its state.
class BodySimulation {
public:
    /// An effect, and what it cost so far.
    struct Slot {
        std::unique_ptr<Effect> effect;
        double seconds = 0;
        std::size_t calls = 0;
    };

    /// Positions and velocities begin at rest at the body's own places.
    BodySimulation(MeshlessBody body, std::optional<DeformableSurface> surface);

    void add(std::unique_ptr<Effect> effect);
    void add(Pin pin);

    /// Advances by `dt_s` ≥ 0 in as many steps as the method and the pins' turning need; 0 changes nothing. Throws
    /// std::invalid_argument for a negative or non-finite dt. If a step fails, says so and keeps the state before it,
    /// what effects remember included.
    StepReport advance(double dt_s, const Integration& integration);

    const MeshlessBody& body() const { return body_; }
    const std::optional<DeformableSurface>& surface() const { return surface_; }
    const std::vector<Slot>& effects() const { return effects_; }
    double time_s() const { return time_s_; }
    double shared_seconds() const { return shared_s_; } ///< of computing J and carrying stresses to nodes
    const Field& positions() const { return x_; }
    const Field& velocities() const { return v_; }
    void place(const Field& positions, const Field& velocities); ///< at time 0
    /// The shape at rest, turned about its 0 and moved by `position`; without the rounding of positions in the world.
    void place(const Vec3& position, const Mat3& rotation, const Field& velocities);
    const Reference& reference() const { return reference_; }
    const std::vector<Mat3>& plastic_inverse() const { return plastic_inverse_; }

    /// T_j of every node, seen from a point of the world.
    std::vector<AffineMap> frame(const Vec3& from = Vec3::Zero());
    /// Energies of the present state, J.
    double kinetic() const;
    double potential();
    /// The forces on the nodes at present, N; of the effect of that index alone, if one is given.
    Field forces(std::optional<std::size_t> only = {});

    /// ∂²U/∂X² · dx at present, N.
    Field stiffness(const Field& dx);

    void save(std::ostream& out) const;
    void restore(std::istream& in);

private:
    friend class ImplicitStep;
    friend class ExplicitStep;

    /// At displacements u.
    Configuration configure(const Field& u, double time_s, const Vec3& datum = Vec3::Zero());
    /// `greatest`, where given: is raised to the greatest acceleration, m/s², of a node that is not pinned by one
    /// effect, or by all stresses together; `applied`: to that by one effect alone.
    void add_forces(const Configuration& c, Field& force, std::optional<std::size_t> only = {},
                    double* greatest = nullptr, double* applied = nullptr);
    double greatest_acceleration(const Field& force) const;
    /// The reference that fits displacements from the present one best, by mass; the present one where pins hold the
    /// body, so that these stay where they are to the last bit. A turn by less than 2⁻²⁶ is left to the displacements:
    /// they are fine enough, and two rotations of doubles differ by a strain of some u.
    Reference fitted(const Field& u) const;
    /// Changes the reference; `fields`: displacements that are to stay where they are.
    void refer_to(const Reference& to, std::initializer_list<Field*> fields);
    void update_positions();
    enum class Parts {
        all,
        stiffness,
        damping
    }; ///< of the second derivatives: all, of what does not dissipate, by velocity
    /// With Parts::all, add_forces must have been called for the same configuration before.
    void assemble(const Configuration& c, Parts parts);
    /// out += −K p of what assemble() found; add_local_product leaves out what is not local to a node.
    void add_product(const Configuration& c, const Field& p, Field& out);
    void add_local_product(const Field& p, Field& out);
    void begin_product(const Field& p, Field& out);
    void end_product(const Field& p, Field& out);
    /// The end of a step: pins in place, with their velocity, and what flows.
    void finish(double from_s, double dt_s);
    void move_pins(Field& u, double time_s) const;
    bool pins_move(double from_s, double to_s) const;
    double potential_at(const Field& u, double time_s, const Vec3& datum);
    void zero_pinned(Field& f) const;
    template <class Call> static void timed(Slot& slot, const Call& call)
    {
        const auto start = std::chrono::steady_clock::now();
        call(*slot.effect);
        slot.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        ++slot.calls;
    }

    MeshlessBody body_;
    std::optional<DeformableSurface> surface_;
    std::vector<Slot> effects_;
    std::vector<Pin> pins_;
    std::vector<std::uint8_t> pinned_;
    bool needs_deformation_ = false;
    Completion completion_ = Completion::on;
    double shared_s_ = 0;

    double time_s_ = 0;
    Reference reference_;
    Field u_, v_; ///< displacements from the reference, velocities in the world
    Field x_;     ///< positions in the world
    std::vector<Mat3> plastic_inverse_;

    Field from_origin_;                                             ///< scratch: positions from the reference's origin
    MatrixField gradient_, strain_, deformation_, stress_, change_; ///< scratch; empty unless some effect needs J
    std::vector<double> spring_;                                    ///< scratch; empty unless some effect has springs
    std::vector<Mat9> local_;
    std::vector<Mat3> block_;
    Field slow_mode_; ///< explicit: where the last power iteration ended
};

} // namespace cinch
