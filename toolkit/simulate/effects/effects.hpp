// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>

#include "toolkit/simulate/effect.hpp"

namespace cinch {

/// −m g·X. `acceleration` in m/s².
std::unique_ptr<Effect> make_gravity(const Vec3& acceleration);

/// A force in N on the nodes together, spread by mass; sin(2π t / period) times, if there is a period (s), from `start`
/// s until `end` s.
struct PullingForce {
    std::vector<std::uint32_t> nodes;
    Vec3 force = Vec3::Zero();
    double start_s = 0, end_s = 0, period_s = 0;
};
std::unique_ptr<Effect> make_pulling(const MeshlessBody& body, PullingForce pull);

/// ½ k ‖X − target(t)‖² per node, k = stiffness (N/m, of all nodes together) spread by mass.
struct PullingTarget {
    std::vector<std::uint32_t> nodes;
    double stiffness = 0;
    std::function<Vec3(std::size_t place_in_nodes, double time_s)> target; ///< m, seen from `origin`
    Vec3 origin = Vec3::Zero();                                            ///< m
};
std::unique_ptr<Effect> make_pulling(const MeshlessBody& body, PullingTarget pull);

/// Stable neo-Hookean energy of Smith et al. 2018, with the logarithm: finite for every F, inverted ones included, and
/// its only minima are rotations. E in Pa.
std::unique_ptr<Effect> make_neo_hookean(double young, double poisson);

/// St. Venant–Kirchhoff. `paper_literal`: with the paper's strain JᵀJ − I, which makes the same E four times as stiff.
std::unique_ptr<Effect> make_stvk(double young, double poisson, bool paper_literal);

/// ½ k (det J − 1)², k in Pa.
std::unique_ptr<Effect> make_volume(double stiffness);

/// Hourglass control: α E v_i / 2 times the residual of the least-squares fit at node i, Σ_j w_ij ‖X_j − X_i − G_i
/// x_ij‖² over Σ_j w_ij ‖x_ij‖². Being what the fit minimises, it is stationary in G_i: its force is its plain
/// derivative in X. Zero for affine motions; quadratic.
std::unique_ptr<Effect> make_hourglass(const MeshlessBody& body, double alpha, double young);

/// Kelvin–Voigt: stress η dε/dt on Green's strain, η in Pa s. As a potential over one step, ½ η/Δt ‖ε − ε_before‖².
std::unique_ptr<Effect> make_viscosity(double viscosity);

/// −α m v, α in 1/s. As a potential over one step, ½ α m/Δt ‖X − X_before‖².
std::unique_ptr<Effect> make_mass_damping(double rate);

/// Multiplicative plastic flow, F = F_e F_p with det F_p = 1: where the deviator of the elastic logarithmic strain
/// exceeds `yield`, the share min(1, creep·Δt) of the excess flows, until F_p's own strain reaches `most`.
struct PlasticFlow {
    double yield = 0, creep = 0, most = 0; ///< –, 1/s, –
};
std::unique_ptr<Effect> make_plasticity(const PlasticFlow& flow);

/// A plane that pushes back: ½ k d² at depth d below it, k (N/m) of the whole body spread evenly over the vertices of
/// its surface, or over its nodes; friction by the depth and the slip of the step before. It fades below a slow speed,
/// s √(a V^⅓) with s = 5·10⁻⁴, a the acceleration by which the plane holds the body and V its volume: a millimetre per
/// second for a body of half a metre at rest.
struct Ground {
    Vec3 point = Vec3::Zero(), normal = Vec3::UnitZ();
    double stiffness = 0, friction = 0;
    bool at_nodes = false;
};
std::unique_ptr<Effect> make_ground(const Ground& ground);

} // namespace cinch
