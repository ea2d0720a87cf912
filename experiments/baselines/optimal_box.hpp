// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cinch/surface.hpp"
#include "toolkit/deform/aligned.hpp"

namespace cinch {

/// The optimal AABB of a deformed surface: every vertex, evaluated in SIMD with fused multiply-adds, in T. What the
/// bound replaces.
template <class T> class OptimalBox {
public:
    OptimalBox(const DeformableSurface& surface, std::span<const AffineMap> maps);
    /// Six supports, in the order of axes_of(6).
    void bound(std::span<double> supports) const;

private:
    AlignedVector<T> column_;   // per simulation node 4 columns of 4
    AlignedVector<T> position_; // per vertex 3
    std::vector<std::uint32_t> row_;
    struct Influence { // as the kernel reads it
        std::uint32_t node;
        T weight;
    };
    std::vector<Influence> influence_;
};

} // namespace cinch
