// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "cinch/bounds.hpp"
#include "cinch/bvh.hpp"
#include "exact/displacements.hpp"
#include "exact/motion_enclosure.hpp"

namespace cinch::exact {

/// What has to hold for a bound to be proven; bits of a mask.
enum Statement : std::uint8_t {
    rest_data = 1,    ///< the BV's rest box and weight intervals hold all its vertices
    weight_space = 2, ///< bound ≥ exact maximum over W' of exact extrema: of the deformed rest box for the box_methods,
                      ///< of each simulation node's own vertices for oriented boxes and where `local` is with them; no
                      ///< statement for other methods
    exact_vertices = 4, ///< bound ≥ every vertex deformed in real arithmetic
    computed_vertices =
        8, ///< bound ≥ every vertex as evaluate_vertex computes it; only +∞ contains a coordinate that is not finite
};
std::string name_of(Statement statement);

struct Violation {
    std::size_t bv = 0;
    int direction =
        -1; ///< place in axes_of(k): 2a along axis a, 2a + 1 against it; −1 where all directions are concerned
    Statement statement = rest_data;
    std::string detail; ///< what is violated by how much, exactly: fractions p/q
};

/// How much tightness a bound gives away, averaged over a BV's directions (axes scaled to unit length), in units of
/// length. The four add up to bound − true support.
struct Loss {
    double box =
        0; ///< true support → extrema (rest boxes, or each node's own vertices) with the vertices' actual weights
    double interval = 0; ///< actual weights → anything in W'
    double corner = 0;   ///< W' → what the method takes; negative where it knows more of the weights than W' does
    double rounding = 0; ///< real arithmetic → proven double; part of `corner` for methods other than the box_methods
};

struct BvReport {
    double true_radius = 0, bound_radius = 0; ///< half diagonals of the axis-aligned boxes
    Loss loss;
};

struct FrameVerdict {
    std::vector<std::uint8_t> failed; ///< per BV and direction, place bv·k + d: mask of violated statements, 0 = proven
    std::vector<BvReport> bvs;
    std::size_t decided_by_filter = 0; ///< bounds that interval arithmetic settled; the rest took exact arithmetic
    std::vector<Violation> examples;   ///< the first few, in order of BV
    std::vector<double>
        lambda; ///< per BV and direction for the box_methods: bound ≥ D(λ) certifies the weight-space statement; else 0
    std::map<std::size_t, std::string> exact_lambda; ///< places where no double λ was found to do so: λ as "p/q"
};

/// Proves the bounds of one surface's BVH, frame by frame, in exact arithmetic behind an interval filter. It reads the
/// toolkit's data and repeats none of its algorithms. Both statements of the guarantee are decided for every BV and
/// direction.
class Verifier {
public:
    /// Checks the rest data of every BV at once: both must stay as they are from here on, and alive. Throws
    /// std::invalid_argument if the tree is no tree over the mesh's triangles, lacks rest data (RestDetail), a rest
    /// vertex is not finite, or the weights are not dyadic and convex; std::runtime_error for a changed floating-point
    /// environment. `pause` is called every few BVs, here and in check(), on any thread: what it throws ends the call.
    /// `targets`: morph targets, of known displacements, that must stay as well; where they displace a BV there is no
    /// statement on weight spaces, and all that a bound gives away is Loss::corner.
    Verifier(const DeformableSurface& surface, const Bvh& bvh, void (*pause)() = nullptr,
             std::span<const MorphTarget> targets = {});

    /// Why rest data fail, per BV; empty strings where they hold.
    const std::vector<std::string>& rest_data_faults() const { return faults_; }

    /// `supports` as refit() fills them for this frame. Results do not depend on the thread count.
    /// `weights`: of the morph targets in this frame; empty where they displace nothing.
    FrameVerdict check(std::span<const AffineMap> maps, Methods methods, int kdop, std::span<const double> supports,
                       RestShape shape = RestShape::aabb, std::span<const double> weights = {}) const;

    /// Where a frame's maps and weights put a vertex, enclosed.
    std::array<Enclosure, 3> place(std::uint32_t vertex, std::span<const AffineMap> maps,
                                   std::span<const double> weights) const;

private:
    const DeformableSurface& surface_;
    const Bvh& bvh_;
    void (*pause_)();
    std::span<const MorphTarget> targets_;
    Displacements displacements_;
    std::vector<std::vector<std::uint32_t>> vertices_; // of each BV, each once
    std::vector<std::string> faults_;
};

} // namespace cinch::exact
