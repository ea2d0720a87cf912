// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <span>

#include "cinch/bvh.hpp"
#include "toolkit/bounds/bound_box.hpp"

namespace cinch {

/// A vertex in the lifted space of the moment bound. With d = v⁰ − c, the first moments ξ = Σ_j w_j z_j and the second
/// moments M = Σ_j w_j z_j z_jᵀ of its weights about the places σ z_j of the simulation nodes, σ a unit of length:
///   d (3),  ξ − d/σ (3),  and N = d ξᵀ − σM/2 by columns (9).
inline constexpr std::size_t lifted_size = 15;
using Lifted = std::array<double, lifted_size>;

/// What the moment bound knows of one simulation node, about a BV's centre c. Any numbers are valid but for the box.
struct MomentInfluence {
    Vec3 place = Vec3::Zero();    ///< z, in units σ; of float precision, so that all arithmetics share it
    double mean = 0;              ///< m, about its mean weight, and
    Vec3 gradient = Vec3::Zero(); ///< f: Σ_j m_j y_j + (Σ_j f_j y_j)·z is about the weighted linear fit of y_j at z_j
    RestBox local;                ///< holds d of every vertex that the node influences
};

/// Rest data of the moment bound of one BV. A view; owns nothing. For every vertex some convex combination of the
/// points differs from its lifted vector by what lies between `least` ≤ 0 and `greatest` ≥ 0, component by component.
struct RestMoments {
    Vec3 centre = Vec3::Zero();                 ///< c; less the rest origin it is of float precision
    double unit = 1;                            ///< σ, a power of two
    std::span<const MomentInfluence> influence; ///< parallel to RestBv::node
    std::span<const Lifted> point;              ///< at least one
    Lifted least{}, greatest{};
};

/// The numbers that the identity of the moment bound leaves free.
struct MomentFit {
    double phi = 0;
    Vec3 linear = Vec3::Zero(), g = Vec3::Zero();
    Vec3 column[3] = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()}; ///< of G

    /// What is multiplied with a lifted vector.
    Lifted functional() const;
};

/// The moment bound: third order in how far the simulation nodes of a BV lie from each other. With q_j = A_jᵀγ, p_j =
/// γ·(A_j c + t_j), a number φ, vectors l and g and a matrix G, all arbitrary, and
///   r_j = q_j − (l − g/σ) − G z_j,   s_j = p_j + σ z_jᵀ G z_j/2 − φ − g·z_j,
/// every vertex is exactly
///   γ·v = φ + l·d + g·(ξ − d/σ) + G:N + Σ_j w_j (s_j + r_j·d):
/// Σ w_j r_j·d takes from Σ w_j q_j·d what l·d − g·d/σ and dᵀGξ add, and Σ w_j s_j from Σ w_j p_j what φ, g·ξ and
/// −σG:M/2 add. The unit keeps squares of lengths from overflowing. All but the last sum is linear in the lifted
/// vector: its support over the points, and what the slack adds. The last sum is D at the best λ over extrema on the
/// nodes' own boxes. The numbers come from linear fits of q_j and of p_j
/// + σ z_jᵀ G z_j/2 over z_j, so that s and r are small (they vanish where maps are the values and gradients of a
/// quadratic motion at the places): whatever rounding makes of the numbers is still exact.
/// Supports as bound_box, proven likewise. With a `start` λ lies where readable_bound has it.
void bound_moments(const RestBv& bv, const RestMoments& rest, std::span<const AffineMap> maps, Rounding rounding,
                   std::span<const Axis> axes, BoundScratch& scratch, std::span<double> supports,
                   std::optional<double> start = {});

// Its parts, for one axis.

/// The fits. Maps are finite.
MomentFit fit_moments(const RestBv& bv, const RestMoments& rest, std::span<const AffineMap> maps, const Axis& axis);

/// Greatest s_j + r_j·d over each node's own box, and greatest −s_j − r_j·d, into `plus` and `minus`. Returns how far
/// any of them may be off; infinite where one is no number.
double remainder_extrema(const RestBv& bv, const RestMoments& rest, std::span<const AffineMap> maps, const Axis& axis,
                         const MomentFit& fit, std::span<double> plus, std::span<double> minus);

/// Greatest φ + functional over the points and the slack, greatest −φ − functional, and how far either may be off.
struct LiftedSupport {
    double along = -HUGE_VAL, against = -HUGE_VAL, error = 0;
};
LiftedSupport lifted_support(const RestMoments& rest, const MomentFit& fit);

} // namespace cinch
