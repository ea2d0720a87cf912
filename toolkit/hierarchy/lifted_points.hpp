// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "toolkit/bounds/bound_moments.hpp"

namespace cinch {

/// A vertex lifted, as it is rounded, and how far each component may be off.
struct LiftedVertex {
    Lifted value{}, off{};
};

/// Of a vertex at d (off by u|d|) whose simulation nodes stand at these places, in units.
LiftedVertex lift(const Vec3& d, Weights::Row row, std::span<const Vec3> place, double unit);

/// Few of many lifted vectors whose hull comes near all of them.
struct LiftedPoints {
    std::vector<std::uint32_t> chosen; ///< places in `all`
    /// For what is not chosen, coefficients of the chosen ones: multiples of 2^-53 that sum to exactly 1.
    std::vector<std::vector<double>> combination; ///< parallel to `all`; empty for the chosen
};

/// Most points of any BV, how many one of so many vertices has (large ones also have many simulation nodes, which take
/// longer), and in what units their distances are measured, for surfaces of this size: gradients of
/// displacements are about 1, and change by about 1 over it.
inline constexpr std::size_t most_lifted_points = 64;
constexpr std::size_t lifted_points_of(std::size_t vertices)
{
    return std::clamp<std::size_t>(vertices / 8, 32, most_lifted_points);
}
Lifted lifted_scale(double unit);

/// At most `most` of them, from 6 to most_lifted_points; all where there are no more. Greedy: first the extremes of the
/// first three components, then what is farthest from the hull of those before it, among a sample at first; distances
/// measured in components times `scale` by pairwise Frank-Wolfe. They need not be exact, as nothing relies on them: the
/// combinations are what counts.
LiftedPoints choose_lifted(std::span<const Lifted> all, const Lifted& scale, std::size_t most);

} // namespace cinch
