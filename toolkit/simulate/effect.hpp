// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "toolkit/simulate/configuration.hpp"

namespace cinch {

/// What an effect adds its forces to. A force on node i is force_i, N. A stress P_i, Pa, of the node's volume v_i is
/// added to stress_i as −v_i P_i, N m; it reaches the neighbours by the transpose of the gradient (scatter_stresses).
/// A spring s_i pulls node i's neighbours to it by s_i w_ij (X_i − X_j), N, in the same pass.
struct Forces {
    Field& force;
    MatrixField& stress;         ///< empty unless an effect needs gradients
    std::vector<double>& spring; ///< N/m; empty unless an effect has springs
};

/// Second derivatives of the energy, for the integrators that want them.
struct Curvature {
    std::vector<Mat9>& local; ///< v_i ∂P_i/∂J_i, J stacked by columns; empty unless an effect needs gradients
    std::vector<Mat3>& block; ///< ∂²U/∂X_i², of what does not pass through J
};

/// A point of a body that touches something, and what holds it there.
struct Touch {
    std::size_t point;
    double push = 0, drag = 0; ///< N/m, across the plane that it touches and along it
};

/// One effect on one body: a term of its energy, or a force. What it remembers from step to step is a Memory in the
/// body's state, which it sees through the configuration; it has no other state. Only effects that a scene names are
/// ever constructed.
class Effect {
public:
    explicit Effect(const char* name) : name_(name) {} ///< that stays
    virtual ~Effect() = default;
    Effect(const Effect&) = delete;
    Effect& operator=(const Effect&) = delete;

    const char* name() const { return name_; }
    /// Whether it looks at, or acts through, J.
    virtual bool needs_deformation() const { return false; }
    /// Whether it uses Forces::spring.
    virtual bool has_springs() const { return false; }
    /// Whether its energy is one of a step (what it dissipates), not of a state.
    virtual bool dissipates() const { return false; }
    /// Whether it changes the plastic state.
    virtual bool is_plastic() const { return false; }
    /// U, J; 0 for what has none.
    virtual double energy(const Configuration&) const { return 0; }
    /// Adds −∂U/∂X, or the force.
    virtual void add_forces(const Configuration&, Forces) const {}
    /// Adds the parts of ∂²U that are local to a node.
    virtual void add_curvature(const Configuration&, Curvature) const {}
    /// Whether add_product and add_diagonal are to be called.
    virtual bool couples_nodes() const { return false; }
    /// Called once per configuration before them, for what touches something: they are given it; `worst`: what may
    /// touch within the next steps, not what does.
    virtual void find_touching(const Configuration&, bool worst, std::vector<Touch>& touching) const
    {
        (void)worst, (void)touching;
    }
    /// Adds −∂²U/∂X² · dx, for the parts that are not local to a node. `dj` is the change of every G_i under dx.
    virtual void add_product(const Configuration&, std::span<const Touch> touching, const Field& dx,
                             const MatrixField& dj, Forces) const
    {
        (void)touching, (void)dx, (void)dj;
    }
    /// Adds to the diagonal of ∂²U/∂X² what add_product stands for, about; for the preconditioner.
    virtual void add_diagonal(const Configuration&, std::span<const Touch> touching, std::vector<Mat3>&) const
    {
        (void)touching;
    }
    /// Adds −∂f/∂v, as add_curvature: N s/m for what dissipates, for the explicit integrator's step.
    virtual void add_damping(const Configuration&, Curvature) const {}
    /// The longest explicit step, s, that what it remembers allows: for what comes and goes between two looks at the
    /// stiffness.
    virtual double longest_step(const Configuration&) const { return std::numeric_limits<double>::infinity(); }
    /// Called with every configuration that begins a step of length dt_s: for what lags behind. `memory` is the one
    /// that it sees.
    virtual void remember(const Configuration&, double dt_s, Memory& memory) const { (void)dt_s, (void)memory; }
    /// Called with the configuration that ends a step: for what flows. May change the plastic state.
    virtual void flow(const Configuration&, double dt_s, std::vector<Mat3>& plastic_inverse) const
    {
        (void)dt_s, (void)plastic_inverse;
    }

private:
    const char* name_;
};

} // namespace cinch
