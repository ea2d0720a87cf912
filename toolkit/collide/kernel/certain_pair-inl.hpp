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

inline constexpr float root_3 = 1.7320510f, two_root_3 = 3.4641020f, three_root_3 = 5.1961530f; // rounded up
inline constexpr float margin_factor = 1 + 0x1p-16f, margin_underflow = 0x1p-120f;

/// det[b − a, c − a, d − a] as computed.
HWY_INLINE float determinant(const float* a, const float* b, const float* c, const float* d)
{
    float x[3], y[3], z[3];
    for (int r = 0; r < 3; ++r) {
        x[r] = b[r] - a[r];
        y[r] = c[r] - a[r];
        z[r] = d[r] - a[r];
    }
    const float n0 = std::fma(x[1], y[2], -(x[2] * y[1])), n1 = std::fma(x[2], y[0], -(x[0] * y[2])), n2 = std::fma(x[0], y[1], -(x[1] * y[0]));
    return std::fma(n0, z[0], std::fma(n1, z[1], n2 * z[2]));
}

/// The vertex that the other triangle's plane separates from the other two, for three signs that are not all the same: 1 or −1 each.
HWY_INLINE std::size_t apex(const std::array<int, 3>& s) { return s[1] == s[2] ? 0 : s[0] == s[2] ? 1 : 2; }

/// Whether two triangles intersect, given the certain sides of each one's corners to the plane of the other, not all the same: 1, −1 if not,
/// 0 if two more orientations (as in triangle_pair.cpp) are too close to call. `twice_error`, D: see test_clusters.
HWY_INLINE int certain_pair(const float (&p)[3][3], const float (&q)[3][3], const std::array<int, 3>& side_of_p, const std::array<int, 3>& side_of_q, float twice_error, float D)
{
    const std::size_t of_p = apex(side_of_p), of_q = apex(side_of_q);
    const float *p0 = p[of_p], *p1 = p[(of_p + 1) % 3], *p2 = p[(of_p + 2) % 3];
    const float *q0 = q[of_q], *q1 = q[(of_q + 1) % 3], *q2 = q[(of_q + 2) % 3];
    if (side_of_q[of_q] < 0)
        std::swap(p1, p2);
    if (side_of_p[of_p] < 0)
        std::swap(q1, q2);
    const float g = twice_error + 8 * unit_roundoff_of<float> * D, reach = D + root_3 * g;
    const float margin = (three_root_3 * g) * (reach * reach) * margin_factor + margin_underflow;
    const float first = determinant(q0, q1, p0, p1), second = determinant(q0, q2, p2, p0);
    if (first > margin || second > margin)
        return -1;
    return first < -margin && second < -margin ? 1 : 0;
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
