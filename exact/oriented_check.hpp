// SPDX-License-Identifier: GPL-3.0-or-later
// Internal to exact/.
#pragma once

#include <vector>

#include "cinch/bvh.hpp"
#include "exact/formulas.hpp"

namespace cinch::exact {

/// Decides x ∈ centre + Z, Z = {Σ β_i a_i : |β_i| ≤ 1}, whatever the axes a_i: reflected, exchanged, parallel or zero,
/// so that Z is a parallelepiped, a polygon, a segment or a point. Z is the set of all y with
///     |n·y| ≤ h(n) = Σ_i |n·a_i|
/// for every n: h is its support function. Finitely many n do. With three independent axes those across two of them,
/// its facets' normals. Else, whatever the rank: a_i × a_j and a_i × e_s, among which are normals that span the
/// complement of Z's span, where h is 0; and (a_i × a_j) × a_k, a_i and e_s, among which are those of Z's edges or
/// ends. Every other n is right too, only superfluous. Lives under DirectedRounding.
class OrientedCheck {
public:
    explicit OrientedCheck(const OrientedBox& box);

    /// Where an axis is infinite, so is the box; where anything is NaN, or the centre not finite, it contains nothing.
    bool contains(const Vec3& x) const;

private:
    template <class N> struct Face {
        Point<N> normal;
        N reach; // h(normal)
    };
    template <class N> static Point<N> cross(const Point<N>& a, const Point<N>& b);
    template <class N> static N dot(const Point<N>& a, const Point<N>& b);
    template <class N> static Face<N> face(const Point<N>& normal, const Point<N> (&axis)[3]);
    template <class N> bool within(const std::vector<Face<N>>& faces, const Vec3& x) const;

    Vec3 centre_;
    bool valid_ = true, infinite_ = false;
    std::vector<Face<Interval>> filter_; // empty unless the axes are certainly independent
    std::vector<Face<Exact>> exact_;
};

} // namespace cinch::exact
