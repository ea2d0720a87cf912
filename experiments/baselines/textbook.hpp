// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "cinch/bvh.hpp"
#include "cinch/surface.hpp"

namespace cinch {

/// How the textbook bounds a transformed box: by its corners, as the paper defines it (Definition 1), or by its centre
/// and axes, the shortcut that the paper mentions in §6.
enum class TransformedBox { corners, axes };

/// Eq. 12 as the paper's §5.4 lists it, by the book: an array of structs, scalar, no proof of its rounding. The
/// yardstick.
class Textbook {
public:
    Textbook(const Bvh& bvh, std::size_t bv, std::span<const AffineMap> maps);
    /// Six supports, in the order of axes_of(6).
    void bound(TransformedBox box, std::span<double> supports);

private:
    void bound_by_corners();
    void bound_by_axes();

    struct SimulationNode {
        Eigen::Matrix3d a;
        Eigen::Vector3d t;
    };
    struct Influence {
        std::uint32_t node;
        double l, h;
    };
    struct Extent {
        double of[6];
    };
    std::vector<SimulationNode> nodes_;
    std::vector<Influence> influences_;
    std::vector<Extent> extents_;
    Eigen::Vector3d centre_, half_;
};

} // namespace cinch
