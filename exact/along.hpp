// SPDX-License-Identifier: GPL-3.0-or-later
// Internal to exact/: places of vertices, and what they reach along axes, from enclosed maps. Needs DirectedRounding.
#pragma once

#include <vector>

#include "cinch/bounds.hpp"
#include "exact/displacements.hpp"
#include "exact/motion_enclosure.hpp"
#include "exact/number.hpp"

namespace cinch::exact {

using Place = std::array<Interval, 3>;

inline Interval interval_of(const Enclosure& x) { return {x.low, x.high}; }

/// Adds Σ w_j (A_j y + shift · t_j), each entry enclosed.
void add_place(const Weights::Row& row, const Place& y, const std::vector<MapEnclosure>& maps, bool shift, Place& out);

/// Displacements of one vertex by morph targets.
using DisplacedBy = std::span<const Displacements::One>;

/// Adds Σ a_i d_i.
void add_displacement(DisplacedBy by, const std::vector<Enclosure>& weights, Place& out);

/// γ·x, γ the axis or its opposite.
Interval along(const Axis& axis, bool against, const Place& x);

/// Σ w_j γᵀA_j and Σ w_j γᵀt_j.
struct Along {
    Place g;
    Interval shift;

    Along(const Weights::Row& row, const std::vector<MapEnclosure>& maps, const Axis& axis, bool against);
    Interval of(const Vec3& y) const { return g[0] * Interval(y[0]) + g[1] * Interval(y[1]) + g[2] * Interval(y[2]); }
};

/// Σ_i a_i g·d_i with every weight anywhere in its interval: all of it, or its greatest value.
Interval displaced_along(const Along& along, DisplacedBy by, const std::vector<Enclosure>& weights, bool greatest);

} // namespace cinch::exact
