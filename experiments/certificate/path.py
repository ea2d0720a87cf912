# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves of glTF 2.0 as functions of real time: on a piece of time between keys, what they are at both ends, and
enclosures of values and derivatives on all of it. Time on a piece runs from 0 to 1."""
import bisect
from fractions import Fraction

from certificate.interval import (ONE, ZERO, arc_tangent_of_quarter, hull, of_double, of_ratio, root,
                                  sine_and_cosine, sine_and_cosine_between)

IDENTITY = [[ONE, ZERO, ZERO], [ZERO, ONE, ZERO], [ZERO, ZERO, ONE]]
NOTHING = [[ZERO] * 3 for _ in range(3)]


class Piece:
    """Of time, between two rational numbers; `middle` is that of the piece between keys in which it lies."""

    def __init__(self, first, last, middle):
        self.first, self.last, self.middle = first, last, middle


class Curve:
    """Keys of some numbers each; a cubic spline has in-tangents, values and out-tangents as rows."""

    def __init__(self, interpolation, times, rows):
        self.interpolation, self.times, self.rows = interpolation, [Fraction(t) for t in times], rows
        self.value = rows[1::3] if interpolation == "CUBICSPLINE" else rows
        self.turns = {}

    def place(self, middle):
        """The last key at or before it, and whether the curve waits there."""
        key = bisect.bisect_right(self.times, middle) - 1
        if key < 0:
            return 0, True
        return key, key + 1 == len(self.times) or self.interpolation == "STEP"

    def part(self, key, piece):
        """Where the piece begins and ends, as parts of the way from the key to the next."""
        length = self.times[key + 1] - self.times[key]
        ends = ((t - self.times[key]) / length for t in (piece.first, piece.last))
        return list(map(of_fraction, ends))

    def controls(self, piece):
        """Per number Bezier's control points on the piece: one where it waits, two, or four."""
        key, waits = self.place(piece.middle)
        first = [of_double(x) for x in self.value[key]]
        if waits:
            return [[x] for x in first]
        last = [of_double(x) for x in self.value[key + 1]]
        begin, end = self.part(key, piece)
        if self.interpolation == "LINEAR":
            return [[a + (b - a) * begin, a + (b - a) * end] for a, b in zip(first, last)]
        third = (self.times[key + 1] - self.times[key]) / 3
        out, into = ([of_fraction(third * Fraction(x)) for x in self.rows[3 * key + i]] for i in (2, 3))
        return [subdivided([a, a + o, b - i, b], begin, end)
                for a, b, o, i in zip(first, last, out, into)]


def of_fraction(x):
    return of_ratio(x.numerator, x.denominator)


def lerp(a, b, s):
    return a + (b - a) * s


def subdivided(c, begin, end):
    """The control points of the part between two places, by blossoms."""
    def blossom(r, s, t):
        x, y, z = (lerp(c[i], c[i + 1], r) for i in range(3))
        x, y = lerp(x, y, s), lerp(y, z, s)
        return lerp(x, y, t)
    return [blossom(begin, begin, begin), blossom(begin, begin, end), blossom(begin, end, end), blossom(end, end, end)]


def jets(controls):
    """The value at both ends, and of the value and its first two derivatives a hull each."""
    if len(controls) == 1:
        return controls[0], controls[0], (controls[0], ZERO, ZERO)
    degree = len(controls) - 1
    slopes = [(b - a).times(degree) for a, b in zip(controls, controls[1:])]
    bends = [(b - a).times(degree - 1) for a, b in zip(slopes, slopes[1:])]
    return controls[0], controls[-1], (hull(controls), hull(slopes), hull(bends) if bends else ZERO)


def polar(a, b):
    """2 x the symmetric bilinear form of q -> |q|^2 R(q); quaternions are (x, y, z, w)."""
    def s(i, j):
        return a[i] * b[j] + a[j] * b[i]
    xx, yy, zz, ww = s(0, 0), s(1, 1), s(2, 2), s(3, 3)
    return [[ww + xx - yy - zz, (s(0, 1) - s(2, 3)).times(2), (s(0, 2) + s(1, 3)).times(2)],
            [(s(0, 1) + s(2, 3)).times(2), ww - xx + yy - zz, (s(1, 2) - s(0, 3)).times(2)],
            [(s(0, 2) - s(1, 3)).times(2), (s(1, 2) + s(0, 3)).times(2), ww - xx - yy + zz]]


def each(f, *matrices):
    return [[f(*entries) for entries in zip(*rows)] for rows in zip(*matrices)]


def product(a, b):
    return [[a[r][0] * b[0][c] + a[r][1] * b[1][c] + a[r][2] * b[2][c] for c in range(3)] for r in range(3)]


def exact_units(q):
    """Doubles as whole numbers of one unit."""
    ratios = [x.as_integer_ratio() for x in q]
    most = max(d for _, d in ratios)
    return [n * (most // d) for n, d in ratios]


def rotation(q):
    """R(q) of doubles; the identity of 0."""
    x, y, z, w = exact_units(q)
    n = x * x + y * y + z * z + w * w
    if n == 0:
        return IDENTITY
    h = [[w * w + x * x - y * y - z * z, 2 * (x * y - z * w), 2 * (x * z + y * w)],
         [2 * (x * y + z * w), w * w - x * x + y * y - z * z, 2 * (y * z - x * w)],
         [2 * (x * z - y * w), 2 * (y * z + x * w), w * w - x * x - y * y + z * z]]
    return [[of_ratio(x, n) for x in row] for row in h]


class Turn:
    """Spherical interpolation from one quaternion to another of any lengths: R(q0) exp(angle [n]x), the shorter way;
    None as `angle` where it stays. `axis` and `square` are R(q0) [n]x and R(q0) [n]x^2."""

    def __init__(self, first, last):
        self.first, self.angle = rotation(first), None
        p, q = exact_units(first), exact_units(last)
        if not any(p) or not any(q):
            return
        # conj(q0) q1 = (v, c), whole numbers
        c = sum(a * b for a, b in zip(p, q))
        v = [p[3] * q[i] - q[3] * p[i] - (p[(i + 1) % 3] * q[(i + 2) % 3] - p[(i + 2) % 3] * q[(i + 1) % 3])
             for i in range(3)]
        if not any(v):
            return
        if c < 0:
            c, v = -c, [-x for x in v]
        far, most = max(map(abs, v)), max(c, *map(abs, v))  # v may be far less than c
        x, y, z = (of_ratio(e, far) for e in v)
        size = root(x.square() + y.square() + z.square())
        self.angle = arc_tangent_of_quarter(size * of_ratio(far, most), of_ratio(c, most)).times(2)
        x, y, z = (e / size for e in (x, y, z))
        self.axis = [[ZERO, -z, y], [z, ZERO, -x], [-y, x, ZERO]]
        n = (x, y, z)
        self.square = [[n[r] * n[s] - (ONE if r == s else ZERO) for s in range(3)] for r in range(3)]

        self.axis, self.square = product(self.first, self.axis), product(self.first, self.square)

    def at(self, sine, cosine):
        rest = ONE - cosine
        return each(lambda r, a, b: r + sine * a + rest * b, self.first, self.axis, self.square)

    def jets(self, begin, end):
        if self.angle is None:
            return self.first, self.first, (self.first, None, None)
        first, last = self.angle * begin, self.angle * end
        ends = sine_and_cosine(first), sine_and_cosine(last)
        sine, cosine = sine_and_cosine_between(first, last, ends)
        way = self.angle * (end - begin)
        rate, change = [way * x for x in (sine, cosine)], [way * way * x for x in (sine, cosine)]
        slope = each(lambda a, b: rate[1] * a + rate[0] * b, self.axis, self.square)
        bend = each(lambda a, b: change[1] * b - change[0] * a, self.axis, self.square)
        return self.at(*ends[0]), self.at(*ends[1]), (self.at(sine, cosine), slope, bend)


def cubic_rotation(controls):
    """R(q(t)) of a polynomial quaternion: H/N with N = |q|^2; ZeroDivisionError where N may be 0."""
    ends = [jets(c) for c in controls]
    def turned(q):
        n = q[0].square() + q[1].square() + q[2].square() + q[3].square()
        return each(lambda h: h.over(2) / n, polar(q, q))
    q, q1, q2 = ([end[2][k] for end in ends] for k in range(3))
    def dot(a, b):
        return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]
    n = q[0].square() + q[1].square() + q[2].square() + q[3].square()
    n1, n2 = dot(q, q1).times(2), (dot(q1, q1) + dot(q, q2)).times(2)
    r = each(lambda h: h.over(2) / n, polar(q, q))
    r1 = each(lambda h, a: (h - n1 * a) / n, polar(q, q1), r)
    r2 = each(lambda h, g, a, b: (h + g - (n1 * b).times(2) - n2 * a) / n, polar(q1, q1), polar(q, q2), r, r1)
    return turned([end[0] for end in ends]), turned([end[1] for end in ends]), (r, r1, r2)


def rotation_jets(curve, piece):
    """Of a rotation's curve: R at both ends, and enclosures of R, R' and R'' (None where they are 0)."""
    key, waits = curve.place(piece.middle)
    if not waits and curve.interpolation == "CUBICSPLINE":
        return cubic_rotation(curve.controls(piece))
    if waits:
        r = rotation(curve.value[key])
        return r, r, (r, None, None)
    if key not in curve.turns:
        curve.turns[key] = Turn(curve.value[key], curve.value[key + 1])
    return curve.turns[key].jets(*curve.part(key, piece))
