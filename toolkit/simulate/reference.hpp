// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>

#include "toolkit/simulate/field.hpp"

namespace cinch {

/// Where a rigid copy of a body's rest shape stands: its own origin, and how it is turned. Node i is at origin + low +
/// R (x_i − c) + u_i, and what is stored and solved for is the displacement u_i: forces come from differences of
/// displacements, so that their rounding is relative to the strain, however stiff the body is, and wherever it has got
/// to.
struct Reference {
    Vec3 origin = Vec3::Zero(), low = Vec3::Zero(); ///< m; `low` holds what the doubles of `origin` cannot
    Mat3 rotation = Mat3::Identity();
    Vec3 centre = Vec3::Zero(); ///< c, m, of the rest shape: 0, unless that is far from 0

    /// Where the node that rests at x stands in the rigid copy, seen from the origin.
    Vec3 place(const Vec3& rest) const { return rotation * (rest - centre); }

    /// A point of the world seen from the origin.
    Vec3 relative(const Vec3& world) const { return (world - origin) - low; }
    /// The way from this origin to that of `to`.
    Vec3 way_to(const Reference& to) const { return (to.origin - origin) + (to.low - low); }
    /// Moves the origin by `step`, rounded no more than `low` is (Knuth's two-sum).
    void move(const Vec3& step)
    {
        for (int r = 0; r < 3; ++r) {
            const double sum = origin[r] + step[r], part = sum - origin[r];
            low[r] += (origin[r] - (sum - part)) + (step[r] - part);
            origin[r] = sum;
        }
    }
    void save(std::ostream& out) const;
    void restore(std::istream& in);
};

} // namespace cinch
