// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "cinch/deform.hpp"

namespace cinch {

/// How simulation nodes move during a closed interval [a, b] of time, D = b − a, m its middle. Of each, for the places
/// x(t) = T_j(t) y of all rest vertices y that it influences:
struct MotionInterval {
    double first_s = 0, last_s = 0;     ///< a and b
    std::vector<AffineMap> first, last; ///< T_j at both ends, computed
    std::vector<AffineMap> bend;        ///< −(D²/8) T_j″(m), computed
    /// In the unit of the surface.
    struct Limits {
        double remainder = 0;  ///< ≥ (D³/32) sup ‖x‴‖
        double bump = 0;       ///< ≥ (D²/8) sup ‖x″‖
        double path = 0;       ///< ≥ D sup ‖x′‖
        double error = 0;      ///< ≥ how far `first` and `last` put x from where it is
        double bend_error = 0; ///< ≥ how far `bend` is from what it stands for, at y
    };
    std::vector<Limits> limits;

    /// Where morph targets displace vertices, x(t) = T_j(t) (y + Σ_i a_i(t) d_i), limits are of that. Empty where they
    /// do not.
    struct Morph {
        std::vector<double> first, last;       ///< a at both ends, computed
        std::array<std::vector<double>, 3> at; ///< a, a′ and a″ at m, computed
        std::vector<AffineMap> slope, still;   ///< −(D²/4) T_j′(m) and −(D²/8) T_j(m), computed
        bool empty() const { return first.empty(); }
    };
    Morph morph;
};

/// A clip as a function of real time.
struct TimedMotion {
    std::string name;         ///< of the clip
    std::vector<double> keys; ///< ascending, each once: the times at which something may turn, the
                              ///< first and the last time among them
    std::function<std::vector<AffineMap>(double)> at;   ///< T_j(t), computed
    std::function<std::vector<double>(double)> weights; ///< of morph targets, computed; none where they move nothing
    /// Of an interval without a key strictly inside. At a key where a curve jumps, the interval's own value counts.
    std::function<MotionInterval(double, double)> over;

    double first_s() const { return keys.front(); }
    double last_s() const { return keys.back(); }
};

/// A ball about the rest vertices that a simulation node influences.
struct Reach {
    Vec3 centre = Vec3::Zero();
    double radius = 0; ///< rounded up
    bool any = false;  ///< false: there are none
};
std::vector<Reach> reaches(const DeformableSurface& surface);

/// The maps of a clip's frames interpolated entry by entry between its times, as simulated frames are. `of` and its
/// surface are copied as far as they are needed.
TimedMotion linear_motion(const Clip& of, const DeformableSurface& surface);

} // namespace cinch
