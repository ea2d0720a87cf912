// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cinch/bvh.hpp"

namespace cinch {

/// Boxes of the displacements of every BV's vertices, one per morph target that displaces any of them.
class MorphBoxes {
public:
    /// Of each of the surface's BVs.
    MorphBoxes(const Bvh& bvh, const DeformableSurface& surface, std::span<const MorphTarget> targets);

    /// Displacements with weights a, pushed through linear parts of maps: z = Σ_i a_i A_j d_i at a vertex of node j.
    struct Term {
        std::span<const double> weight;  ///< of every target
        std::span<const AffineMap> maps; ///< of every simulation node
    };
    /// Adds to every support of k per BV what the sum of the terms reaches along its direction, over the boxes and W':
    /// the greatest Σ_j w_j c_j, c_j = Σ_terms (g·c + |g|·h), g = A_jᵀγ, c and h the centre Σ a_i c_i and the half
    /// extents Σ |a_i| h_i of the BV's box. Rounds to nearest but for the last sum: of m targets and n simulation nodes
    /// every c_j and the mean are off by at most (m + n + 16) u ‖γ‖ times 4 Σ_terms ‖A_j‖ Σ_i |a_i| max ‖d_i‖.
    void add(std::span<const Term> terms, int kdop, std::span<double> supports) const;
    /// The same to those of the BVs listed, k per BV of the list.
    void add(std::span<const Term> terms, int kdop, std::span<const std::uint32_t> bvs,
             std::span<double> supports) const;

    /// Adds to the supports of the BVs that one such term displaces, A_j the linear parts of the frame's own maps, what
    /// is rounded where frames have morph targets: with E = Σ_i |a_i| max ‖d_i‖∞ and X = `farthest` ≥ every ‖v⁰‖∞,
    ///   add()                                                          4 (m + n + 16) u ‖γ‖₁ ‖A_j‖∞ E,
    ///   displace(): m products and sums per coordinate, pushed by A_j  (m + 2) u ‖γ‖₁ ‖A_j‖∞ (X + E),
    ///   evaluate_vertex() of what is displaced, beyond what it         (n + 9) u ‖γ‖₁ ‖A_j‖∞ E,
    ///   rounds of v⁰, which the bounds have already
    /// together at most 6 (m + n + 16) u ‖γ‖₁ max ‖A_j‖∞ (X + E); 8 are taken, for the rounding of this sum itself.
    void add_error(const Term& term, double farthest, int kdop, std::span<double> supports) const;

    /// How many targets displace a BV.
    std::size_t count(std::size_t bv) const { return row_[bv + 1] - row_[bv]; }

private:
    void add(std::span<const Term> terms, std::span<const Axis> axes, std::size_t bv, std::vector<double>& scratch,
             std::span<double> supports) const;

    const Bvh& bvh_;
    std::vector<std::uint32_t> row_{0}; // a BV's entries
    std::vector<std::uint32_t> target_; // of each entry
    std::vector<Vec3> centre_, half_;
};

} // namespace cinch
