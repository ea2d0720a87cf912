// SPDX-License-Identifier: Apache-2.0
// No #pragma once: compiled anew for every target.
#if defined(CINCH_CERTAIN_PAIR_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CINCH_CERTAIN_PAIR_INL
#undef CINCH_CERTAIN_PAIR_INL
#else
#define CINCH_CERTAIN_PAIR_INL
#endif

#include <array>
#include <cmath>
#include <utility>

#include <hwy/highway.h>

#include "toolkit/bounds/rounding.hpp"

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {

inline constexpr float root_3 = 1.7320510f, two_root_3 = 3.4641020f; // rounded up
inline constexpr float margin_factor = 1 + 0x1p-16f, margin_underflow = 0x1p-120f;

/// What the margins are made of: s and D of the pair, d and h of either triangle. See test_clusters.
struct Sizes {
    float s, D, d_p, h_p, d_q, h_q;
};

/// The sign of det[q1 − q0, p1 − p0, p0 − q0], 0 where it is too close to call.
HWY_INLINE int sign(const float* p0, const float* p1, const float* q0, const float* q1, const Sizes& m)
{
    float x[3], y[3], z[3];
    for (int r = 0; r < 3; ++r) {
        x[r] = q1[r] - q0[r];
        y[r] = p1[r] - p0[r];
        z[r] = p0[r] - q0[r];
    }
    const float n0 = std::fma(x[1], y[2], -(x[2] * y[1])), n1 = std::fma(x[2], y[0], -(x[0] * y[2])), n2 = std::fma(x[0], y[1], -(x[1] * y[0]));
    const float determinant = std::fma(n0, z[0], std::fma(n1, z[1], n2 * z[2]));
    const float g = m.s + unit_roundoff_of<float> * m.D, bend = root_3 * (m.h_q * (m.d_p + root_3 * m.h_p) + m.d_q * m.h_p);
    const float margin = (g * ((std::abs(n0) + std::abs(n1)) + std::abs(n2)) + bend * (m.D + root_3 * g)) * margin_factor + margin_underflow;
    return determinant > margin ? 1 : determinant < -margin ? -1 : 0;
}

/// The vertex that the other triangle's plane separates from the other two, for three signs that are not all the same: 1 or −1 each.
HWY_INLINE std::size_t apex(const std::array<int, 3>& s) { return s[1] == s[2] ? 0 : s[0] == s[2] ? 1 : 2; }

/// Whether two triangles intersect, given the certain sides of each one's corners to the plane of the other, not all the same: 1, −1 if not,
/// 0 if two more orientations (as in triangle_pair.cpp) are too close to call.
HWY_INLINE int certain_pair(const float (&p)[3][3], const float (&q)[3][3], const std::array<int, 3>& side_of_p, const std::array<int, 3>& side_of_q, const Sizes& sizes)
{
    const std::size_t of_p = apex(side_of_p), of_q = apex(side_of_q);
    const float *p0 = p[of_p], *p1 = p[(of_p + 1) % 3], *p2 = p[(of_p + 2) % 3];
    const float *q0 = q[of_q], *q1 = q[(of_q + 1) % 3], *q2 = q[(of_q + 2) % 3];
    if (side_of_q[of_q] < 0)
        std::swap(p1, p2);
    if (side_of_p[of_p] < 0)
        std::swap(q1, q2);
    // orientation(q0, q1, p0, p1) = −det[q1 − q0, p1 − p0, p0 − q0], orientation(q0, q2, p2, p0) = det[q2 − q0, p2 − p0, p0 − q0]
    const int first = -sign(p0, p1, q0, q1, sizes), second = sign(p0, p2, q0, q2, sizes);
    if (first > 0 || second > 0)
        return -1;
    return first < 0 && second < 0 ? 1 : 0;
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
