# SPDX-License-Identifier: GPL-3.0-or-later
"""Bounds over intervals of time against the vertices: between two keys a vertex stays below the chord of what it
reaches at both ends plus a parabola as high as its second derivative allows."""
from fractions import Fraction

from certificate.interval import BITS
from certificate.path import Piece
from certificate.values import WEIGHT_BITS, bits_after_point, require, scaled

MOST_HALVINGS, SPARE_PIECES, PIECES_PER_KEY = 40, 2000, 64
DISPLACED_BITS = 160  # after the point, of displaced rest positions


class Vertices:
    """Rest positions and displacements as whole numbers of 2^-bits, and rows of weights."""

    def __init__(self, surface, used, targets):
        """`targets`: per target its vertices and their displacements."""
        every = [x for position in surface.positions for x in position]
        every += [x for _, displacements in targets for d in displacements for x in d]
        self.bits = max(map(bits_after_point, every))
        if targets:
            self.bits = max(self.bits, DISPLACED_BITS)
        self.rest = [[scaled(x, self.bits) for x in position] for position in surface.positions]
        self.rows, self.used = surface.rows, used
        self.by = {}  # per displaced vertex
        for i, (vertices, displacements) in enumerate(targets):
            for v, d in zip(vertices, displacements):
                self.by.setdefault(v, []).append((i, [scaled(x, self.bits) for x in d]))
        self.one = 1 << self.bits
        self.unit_bits = self.bits + BITS + WEIGHT_BITS  # of places

    def blended(self, v, maps):
        """Of the maps of all simulation nodes the mean by its weights: middles and radii."""
        (j, u, _), *others = self.rows[v]
        mid, rad = maps[j]
        mid, rad = [u * x for x in mid], [u * x for x in rad]
        for j, u, _ in others:
            other, radius = maps[j]
            mid = [a + u * x for a, x in zip(mid, other)]
            rad = [a + u * x for a, x in zip(rad, radius)]
        return mid, rad

    def displaced(self, v, weights, k, still):
        """Its rest position, or 0, plus displacements times the k-th number of each weight: middles and radii."""
        mid, rad = (list(self.rest[v]) if still else [0] * 3), [0] * 3
        for i, d in self.by[v]:
            w = weights[i][k]
            for c in range(3):
                mid[c] += (w.mid * d[c]) >> BITS
                rad[c] += (w.rad * abs(d[c]) >> BITS) + 2
        return mid, rad

    def place(self, v, maps, weights, end):
        """Where it is at one end of a piece: middles and radii."""
        if weights and v in self.by:
            return moved(self.blended(v, maps), *self.displaced(v, weights, end, True), self.one)
        x, y, z = self.rest[v]
        (j, u, _), *others = self.rows[v]
        mid, most = [u * n for n in maps[j][0]], max(maps[j][1])
        for j, u, _ in others:
            mid = [n + u * o for n, o in zip(mid, maps[j][0])]
            most = max(most, *maps[j][1])
        a, b, c, d, e, f, g, h, i, k, l, m = mid
        one = self.one
        rad = (abs(x) + abs(y) + abs(z) + one) * most << WEIGHT_BITS
        return [a * x + b * y + c * z + d * one, e * x + f * y + g * z + h * one,
                i * x + k * y + l * z + m * one], [rad, rad, rad]

    def bend(self, v, enclosed):
        """An enclosure of its second derivative on all of a piece."""
        if not enclosed.weights or v not in self.by:
            return moved(self.blended(v, enclosed.bend), self.rest[v], STILL, self.one)
        # (T e)'' = T'' e + 2 T' e' + T e''
        parts = [moved(self.blended(v, maps), *self.displaced(v, enclosed.weights, k, k == 2), one)
                 for maps, k, one in ((enclosed.bend, 2, self.one), (enclosed.slope, 3, 0), (enclosed.all, 4, 0))]
        return tuple([a + 2 * b + c for a, b, c in zip(*(part[i] for part in parts))] for i in (0, 1))


STILL = [0] * 3


def moved(blend, y, radius, one):
    m, r = blend
    mid, rad = [], []
    for at in (0, 4, 8):
        a, b, c, d = m[at:at + 4]
        e, f, g, h = r[at:at + 4]
        mid.append(a * y[0] + b * y[1] + c * y[2] + d * one)
        rad.append(abs(a) * radius[0] + abs(b) * radius[1] + abs(c) * radius[2] + e * (abs(y[0]) + radius[0]) +
                   f * (abs(y[1]) + radius[1]) + g * (abs(y[2]) + radius[2]) + h * one)
    return mid, rad


def along(axes, place):
    """Middles and radii along each axis; the first three are those of the coordinates."""
    mid, rad = place
    if len(axes) == 3:
        return mid, rad
    return ([sum(a * x for a, x in zip(axis, mid)) for axis in axes],
            [sum(r for a, r in zip(axis, rad) if a) for axis in axes])


def stays_below(first, last, bump, limit):
    """(1 - t) first + t last + 4 t (1 - t) bump <= limit for all t from 0 to 1; whole numbers."""
    most = max(first, last)
    if most + max(bump, 0) <= limit:
        return True
    if most > limit:
        return False
    if bump <= 0 or abs(last - first) >= 4 * bump:
        return True
    # (first + last)/2 + bump + (last - first)^2/(16 bump) <= limit
    return 8 * bump * (2 * limit - first - last - 2 * bump) >= (last - first) ** 2


class IntervalProof:
    """Of one clip; `axes` of the k-DOP."""

    def __init__(self, vertices, surface, motion, axes):
        self.vertices, self.surface, self.motion, self.axes = vertices, surface, motion, axes
        self.kept, self.endless = None, 1 << (vertices.unit_bits + 5000)

    def limits(self, bounds):
        """Per vertex and direction the least bound of the BVs that contain it, in units of places rounded down."""
        bits, surface = self.vertices.unit_bits, self.surface
        of_bv = [[self.endless if x is None else floor_units(x, bits) for x in of] for of in bounds]
        out = {}
        for i, pair in enumerate(surface.children):
            if pair:  # children come after their parents
                for c in pair:
                    of_bv[c] = list(map(min, of_bv[c], of_bv[i]))
            else:
                for v in surface.corners[i]:
                    out[v] = list(map(min, out[v], of_bv[i])) if v in out else of_bv[i]
        return out

    def check(self, first, last, bounds):
        """Proves the bounds of all BVs from one time to another, of which None is infinity."""
        limits, motion = self.limits(bounds), self.motion
        begin, end = Fraction(first), Fraction(last)
        cuts = [begin, *(Fraction(t) for t in motion.keys if first < t < last), end]
        open_pieces = []
        if begin < end:
            open_pieces = [(a, b, (a + b) / 2, 0, None) for a, b in zip(cuts, cuts[1:])]
        open_pieces.append((end, end, end, 0, None))  # to which a curve may jump
        budget = SPARE_PIECES + PIECES_PER_KEY * len(open_pieces)
        open_pieces.reverse()
        while open_pieces:
            a, b, middle, halvings, which = open_pieces.pop()
            left = self.on(Piece(a, b, middle), limits, limits if which is None else which)
            budget -= 1
            if left:
                v, d = left[0]
                require(halvings < MOST_HALVINGS and budget > 0 and a < b,
                        "direction {}: vertex {} is not shown to stay within the bound from {} to {} s", d, v,
                        float(a), float(b))
                c, which = (a + b) / 2, list(dict.fromkeys(v for v, _ in left))
                open_pieces.append((c, b, middle, halvings + 1, which))
                open_pieces.append((a, c, middle, halvings + 1, which))

    def on(self, piece, limits, which):
        """The vertices, each with a direction, of which it is open whether they stay within their limits."""
        try:
            enclosed = self.motion.on(piece, {j for v in which for j, _, _ in self.vertices.rows[v]})
        except ZeroDivisionError:
            return [(v, d) for v in which for d, limit in enumerate(limits[v]) if limit < self.endless]
        vertices, left = self.vertices, []
        # A half begins where the one before it ends; what is between other keys may begin elsewhere.
        begun = self.kept[1] if self.kept and self.kept[0] == (piece.middle, piece.first) else {}
        ends = {}
        instant = piece.first == piece.last
        bends = enclosed.bend and not instant
        for v in which:
            first = begun.get(v) or vertices.place(v, enclosed.first, enclosed.weights, 0)
            last = first if instant else vertices.place(v, enclosed.last, enclosed.weights, 1)
            ends[v] = last
            bend = vertices.bend(v, enclosed) if bends else (STILL, STILL)
            for d, limit in self.exceeded(first, last, bend, limits[v]):
                left.append((v, d))
                for when, place in ((piece.first, first), (piece.last, last)):
                    mid, rad = (x[d // 2] for x in along(self.axes, place))
                    require((mid if d % 2 == 0 else -mid) - rad <= limit,
                            "direction {}: vertex {} lies beyond the bound at {} s", d, v, float(when))
                break
        self.kept = (piece.middle, piece.last), ends
        return left

    def exceeded(self, first, last, bend, limits):
        """The directions in which the limit is not shown to hold."""
        d = 0
        for p, pr, q, qr, s, sr in zip(*along(self.axes, first), *along(self.axes, last), *along(self.axes, bend)):
            # 4 t (1 - t) times -x''/8, rounded up, has a second derivative of at most x''.
            if not stays_below(p + pr, q + qr, -((s - sr) // 8), limits[d]):
                yield d, limits[d]
            if not stays_below(pr - p, qr - q, -((-s - sr) // 8), limits[d + 1]):
                yield d + 1, limits[d + 1]
            d += 2


def floor_units(x, bits):
    p, q = x.as_integer_ratio()
    return (p << bits) // q
