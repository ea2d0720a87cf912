// SPDX-License-Identifier: Apache-2.0
// No #pragma once: compiled anew for every target.
#if defined(CINCH_PAIR_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CINCH_PAIR_LANES_INL
#undef CINCH_PAIR_LANES_INL
#else
#define CINCH_PAIR_LANES_INL
#endif

#include <utility>

#include "toolkit/bounds/rounding.hpp"
#include "toolkit/hierarchy/kernel/wide-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {

inline constexpr float root_3 = 1.7320510f, two_root_3 = 3.4641020f; // rounded up
inline constexpr float margin_factor = 1 + 0x1p-16f, margin_underflow = 0x1p-120f,
                       greatest_span = 0x1p41f; // see test_clusters

template <std::size_t L> using Point = Wide<L>[3]; ///< one in each lane

/// Triangles, one in a lane, and what margins are made of: d bounds the distance of any two corners, h = κ + 12u d.
template <std::size_t L> struct Triangles {
    Point<L> corner[3];
    Wide<L> d, h;

    HWY_INLINE void measure(float difference)
    {
        auto squared = Wide<L>::all(margin_underflow); // d ≥ 2^-60
        for (std::size_t r = 0; r < 3; ++r) {
            const auto extent = greater(greater(corner[0][r], corner[1][r]), corner[2][r]) -
                                less(less(corner[0][r], corner[1][r]), corner[2][r]);
            squared = fma(extent, extent, squared);
        }
        d = root(squared);
        h = fma(d, Wide<L>::all(12 * unit_roundoff_of<float>), Wide<L>::all(difference));
    }
};

/// On which side, a bit for each lane: certainly above, certainly below.
struct Side {
    std::uint32_t above, below;

    std::uint32_t certain() const { return above | below; }
};
/// x × y and |x × y|₁ of two edges.
template <std::size_t L> struct Normal {
    Point<L> n;
    Wide<L> length;

    HWY_INLINE Normal(const Point<L>& x, const Point<L>& y)
    {
        for (std::size_t r = 0; r < 3; ++r) {
            const std::size_t s = (r + 1) % 3, t = (r + 2) % 3;
            n[r] = fms(x[s], y[t], y[s] * x[t]);
        }
        length = (magnitude(n[0]) + magnitude(n[1])) + magnitude(n[2]);
    }
    /// The sign of n·(to − from), as far as the margin allows.
    HWY_INLINE Side side(const Point<L>& from, const Point<L>& to, const Wide<L>& margin) const
    {
        const auto along = fma(n[0], to[0] - from[0], fma(n[1], to[1] - from[1], n[2] * (to[2] - from[2])));
        return {bits_where_greater(along, margin), bits_where_greater(Wide<L>::all(0) - along, margin)};
    }
};
template <std::size_t L> HWY_INLINE void subtract(const Point<L>& a, const Point<L>& b, Point<L>& out)
{
    for (std::size_t r = 0; r < 3; ++r)
        out[r] = a[r] - b[r];
}

/// Of a pair of triangles in every lane: g and D + √3 g, and whether floats may decide: D is a number below the limit.
/// See test_clusters.
template <std::size_t L> struct Spread {
    Wide<L> off, reach;
    std::uint32_t decides;

    HWY_INLINE Spread(const Wide<L>& d_p, const Wide<L>& d_q, float s)
    {
        const auto D = (d_p + d_q) + Wide<L>::all(5 * s);
        off = fma(D, Wide<L>::all(unit_roundoff_of<float>), Wide<L>::all(s));
        reach = fma(off, Wide<L>::all(root_3), D);
        decides = bits_where_greater(Wide<L>::all(greatest_span), D);
    }
    /// The margin of a determinant of edges of x and y, and a difference between the two triangles.
    HWY_INLINE Wide<L> margin(const Wide<L>& length, const Triangles<L>& x, const Triangles<L>& y) const
    {
        const auto product = fma(x.h, fma(y.h, Wide<L>::all(root_3), y.d), x.d * y.h);
        const auto bend = fma(product, Wide<L>::all(root_3), Wide<L>::all(margin_underflow));
        return fma(fma(off, length, reach * bend), Wide<L>::all(margin_factor), Wide<L>::all(margin_underflow));
    }
};

/// Turns the corners so that the first is the one that certain sides, given by `above`, separate from the other two;
/// then exchanges the other two where asked.
struct Apex {
    std::uint32_t first, second, third; ///< which corner it is

    explicit Apex(const std::uint32_t (&above)[3])
    {
        first = ~(above[1] ^ above[2]);
        second = ~(above[0] ^ above[2]) & ~first;
        third = ~(first | second);
    }
    std::uint32_t of(const std::uint32_t (&bits)[3]) const
    {
        return (bits[0] & first) | (bits[1] & second) | (bits[2] & third);
    }
};
template <std::size_t L> HWY_INLINE void turn(const Apex& apex, std::uint32_t exchange, Point<L> (&corner)[3])
{
    for (std::size_t r = 0; r < 3; ++r) {
        const auto a = corner[0][r], b = corner[1][r], c = corner[2][r];
        corner[0][r] = select(apex.second, b, select(apex.third, c, a));
        const auto next = select(apex.second, c, select(apex.third, a, b)),
                   last = select(apex.second, a, select(apex.third, b, c));
        corner[1][r] = select(exchange, last, next);
        corner[2][r] = select(exchange, next, last);
    }
}

/// Lanes that certainly intersect, and those that are too close to call; all others certainly do not. Triangle pairs p
/// and q in the lanes of `left`, coordinates between them off by s at most.
struct Answer {
    std::uint32_t hits, doubtful;
};
template <std::size_t L>
HWY_INLINE Answer intersect_lanes(Triangles<L>& p, Triangles<L>& q, std::uint32_t left, float s)
{
    const Spread<L> spread(p.d, q.d, s);
    std::uint32_t above_p[3], above_q[3], certain = left & spread.decides;
    auto sides = [&](const Triangles<L>& plane, const Triangles<L>& points, std::uint32_t(&above)[3]) HWY_ATTR {
        Point<L> e, f;
        subtract<L>(plane.corner[1], plane.corner[0], e);
        subtract<L>(plane.corner[2], plane.corner[0], f);
        const Normal<L> normal(e, f);
        const auto margin = spread.margin(normal.length, plane, plane);
        std::uint32_t all_above = spread.decides, all_below = spread.decides;
        for (std::size_t c = 0; c < 3; ++c) {
            const Side side = normal.side(plane.corner[0], points.corner[c], margin);
            above[c] = side.above;
            all_above &= side.above;
            all_below &= side.below;
            certain &= side.certain();
        }
        left &= ~(all_above | all_below); // apart
    };
    sides(p, q, above_q);
    if (left == 0)
        return {0, 0};
    sides(q, p, above_p);
    certain &= left;
    if (certain == 0)
        return {0, left};
    // [Guigue, Devillers 2003], as in triangle_pair.cpp; orientation(q0, q1, p0, p1) = −det[q1 − q0, p1 − p0, p0 − q0]
    // and orientation(q0, q2, p2, p0) = det[q2 − q0, p2 − p0, p0 − q0] must not be positive.
    const Apex apex_p(above_p), apex_q(above_q);
    turn<L>(apex_p, ~apex_q.of(above_q), p.corner);
    turn<L>(apex_q, ~apex_p.of(above_p), q.corner);
    auto orientation = [&](std::size_t c) HWY_ATTR { // of det[q_c − q0, p_c − p0, p0 − q0]
        Point<L> x, y;
        subtract<L>(q.corner[c], q.corner[0], x);
        subtract<L>(p.corner[c], p.corner[0], y);
        const Normal<L> normal(x, y);
        return normal.side(q.corner[0], p.corner[0], spread.margin(normal.length, q, p));
    };
    const Side first = orientation(1), second = orientation(2);
    const std::uint32_t hits = certain & first.above & second.below, misses = certain & (first.below | second.above);
    return {hits, left & ~(hits | misses)};
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
