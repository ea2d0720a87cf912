// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "toolkit/simulate/body_state.hpp"

namespace cinch {

/// What an effect cost so far.
struct EffectCost {
    double seconds = 0;
    std::size_t calls = 0;
};

/// The forces of a body's effects and their derivatives, with the room to compute them in, which states share. The
/// model must stay where it is, and alive; effects that join it are seen. Of one thread at a time.
class BodyForces {
public:
    explicit BodyForces(const BodyModel& model, Completion completion = Completion::on);
    void set(Completion completion) { completion_ = completion; }

    /// What effects see of a state whose nodes are displaced by `u`. Holds until the next call, and while `state` and
    /// `u` stay.
    Configuration configure(const BodyState& state, const Field& u, double time_s, const Vec3& datum = Vec3::Zero());

    /// Adds the forces on nodes, N; of the effect of that index alone, if one is given.
    void add(const Configuration& c, Field& force, std::optional<std::size_t> only = {});
    /// m/s²: the greatest acceleration of a node that is not pinned by one effect, or by all stresses together; and by
    /// one effect that acts from outside alone.
    struct Greatest {
        double any = 0, applied = 0;
    };
    Greatest add_and_measure(const Configuration& c, Field& force);
    /// U of one effect, J.
    double energy(const Configuration& c, std::size_t effect);
    /// J: of all effects whose energy is one of a state, not of a step.
    double potential(const Configuration& c) const;

    enum class Parts {
        all,
        stiffness,
        damping
    }; ///< of the second derivatives: all, of what does not dissipate, by velocity
    /// With Parts::all, forces must have been added for the same configuration before.
    void assemble(const Configuration& c, Parts parts);
    /// Makes what is local to a node positive semidefinite.
    void project();
    /// out += −K p of what assemble() found; add_local_product leaves out what is not local to a node.
    void add_product(const Configuration& c, const Field& p, Field& out);
    void add_local_product(const Field& p, Field& out);
    /// The diagonal blocks of K, about; `held`: the size of each, N/m, of forces that depend on where a node is in the
    /// world.
    std::vector<Mat3> diagonal(const Configuration& c, std::vector<double>& held) const;

    /// The beginning of a step from `c`, which is of that state: what effects remember.
    void begin_step(const Configuration& c, double dt_s, BodyState& state) const;
    /// The end of a step that brought the state here: pins in place, with their velocity, and what flows.
    void end_step(double from_s, double dt_s, BodyState& state);
    /// Whether what effects remember allows an explicit step of that length.
    bool allow(const Configuration& c, double dt_s) const;

    const BodyModel& model() const { return *model_; }
    EffectCost cost(std::size_t effect) const { return effect < cost_.size() ? cost_[effect] : EffectCost(); }
    double shared_seconds() const { return shared_s_; } ///< of computing J and carrying stresses to nodes
    /// Of the last assemble(): v_i ∂P_i/∂J_i of every node; and of the last forces: −v_i P_i, and springs. Empty where
    /// no effect needs them.
    const std::vector<Mat9>& local() const { return local_; }
    const MatrixField& stress() const { return stress_; }
    const std::vector<double>& spring() const { return spring_; }

private:
    template <class Call> void timed(const Configuration& c, std::size_t effect, const Call& call);
    double greatest_acceleration(const Field& force) const;
    void begin_forces();
    void scatter(const Field& x, Field& force);
    void begin_product(const Field& p, Field& out);

    const BodyModel* model_;
    Completion completion_;
    std::vector<EffectCost> cost_;
    double shared_s_ = 0;

    Field from_origin_, part_; ///< positions from the reference's origin; the forces of one effect
    MatrixField gradient_, strain_, deformation_, stress_, change_; ///< empty unless some effect needs J
    std::vector<double> spring_;                                    ///< empty unless some effect has springs
    std::vector<Mat9> local_;
    std::vector<Mat3> block_;
    std::vector<std::vector<Touch>> touching_; ///< of every effect
};

} // namespace cinch
