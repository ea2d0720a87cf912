# SPDX-License-Identifier: GPL-3.0-or-later
"""How simulation nodes move on a piece of time: chains of bones by glTF's curves, or frames interpolated entry by
entry. A map is a row-major affine 3 x 4 matrix, enclosed: twelve middles and twelve radii, units as in interval.py; one
that is 0 is None."""
import bisect
from fractions import Fraction

from certificate.interval import BITS, ZERO, hull, of_double, of_ratio
from certificate.path import jets, rotation, rotation_jets

NOTHING = [0] * 12, [0] * 12


class Enclosed:
    """On a piece of time from 0 to 1, per simulation node: maps at both ends and on all of it, with their first two
    derivatives. And per morph target its weight at both ends, and on all of it with two derivatives."""

    def __init__(self, first, last, all_of=None, slope=None, bend=None, weights=None):
        self.first, self.last, self.all, self.slope, self.bend = first, last, all_of, slope, bend
        self.weights = weights


def map_of(linear, shift):
    """Of rows of intervals and a column; either may be missing."""
    entries = []
    for r in range(3):
        entries += *(linear[r] if linear else (ZERO,) * 3), shift[r] if shift else ZERO
    return [x.mid for x in entries], [x.rad for x in entries]


def affine(numbers):
    entries = [of_double(x) for x in numbers]
    return [x.mid for x in entries], [x.rad for x in entries]


def chained(x, y, shift):
    """x y, where y's last row is (0 0 0 1), or (0 0 0 0) of a derivative."""
    if x is None or y is None:
        return None
    (xm, xr), (ym, yr) = x, y
    most = [abs(m) + r for m, r in zip(ym, yr)]
    mid, rad = [], []
    for at in (0, 4, 8):
        a, b, c, d = xm[at:at + 4]
        e, f, g, h = xr[at:at + 4]
        i, j, k = abs(a), abs(b), abs(c)
        for s in (0, 1, 2, 3):
            mid.append(a * ym[s] + b * ym[s + 4] + c * ym[s + 8] >> BITS)
            rad.append((i * yr[s] + j * yr[s + 4] + k * yr[s + 8] + e * most[s] + f * most[s + 4] + g * most[s + 8] >>
                        BITS) + 2)
        if shift:
            mid[-1] += d
            rad[-1] += h
    return mid, rad


def total(*parts):
    """The sum of maps, each with a whole factor > 0."""
    parts = [(n, m) for n, m in parts if m is not None]
    if not parts:
        return None
    return tuple([sum(n * x for (n, _), x in zip(parts, entries)) for entries in zip(*(m[i] for _, m in parts))]
                 for i in (0, 1))


def scaled(matrix, by):
    """Columns of intervals times numbers."""
    return None if matrix is None or by is None else [[x * s for x, s in zip(row, by)] for row in matrix]


def added(*parts):
    """The sum of matrices of intervals, each with a whole factor."""
    parts = [(n, m) for n, m in parts if m is not None]
    if not parts:
        return None
    out = [[x.times(parts[0][0]) for x in row] for row in parts[0][1]]
    for n, m in parts[1:]:
        out = [[a + x.times(n) for a, x in zip(*rows)] for rows in zip(out, m)]
    return out


class Bone:
    """Its transform to its parent, x -> p(t) + R(t) S(t) x."""

    def __init__(self, parent, translation, rotation_, scale, matrix):
        self.parent, self.matrix = parent, matrix
        self.still = [[of_double(x) for x in translation], rotation(rotation_), [of_double(x) for x in scale]]

    def constant(self):
        if self.matrix:  # by columns
            return affine([self.matrix[4 * c + r] for r in range(3) for c in range(4)])
        p, r, s = self.still
        return map_of(scaled(r, s), p)

    def moved(self, curves, piece):
        """Of the map: both ends, and on all of the piece it and its two derivatives."""
        ends = [list(self.still), list(self.still)]
        p, r, s = ([x, None, None] for x in self.still)
        for what, curve in curves.items():
            if what == "rotation":
                ends[0][1], ends[1][1], r = rotation_jets(curve, piece)
                continue
            each = [jets(c) for c in curve.controls(piece)]
            at = 0 if what == "translation" else 2
            ends[0][at], ends[1][at] = ([j[e] for j in each] for e in (0, 1))
            hulls = [[j[2][k] for j in each] for k in range(3)]
            hulls = [h if k == 0 or any(x.mid or x.rad for x in h) else None for k, h in enumerate(hulls)]
            if what == "translation":
                p = hulls
            else:
                s = hulls
        linear = [scaled(r[0], s[0]), added((1, scaled(r[1], s[0])), (1, scaled(r[0], s[1]))),
                  added((1, scaled(r[2], s[0])), (2, scaled(r[1], s[1])), (1, scaled(r[0], s[2])))]
        own = [map_of(m, shift) if m or shift else None for m, shift in zip(linear, p)]
        return *(map_of(scaled(e[1], e[2]), e[0]) for e in ends), own


class Character:
    """Bones, of which parents come first; joints: (bone, inverse bind). `weights`: of morph targets, where no curve
    sets them, or none of them: `limits`, the least and the greatest of any at any time."""

    def __init__(self, bones, joints, weights, limits=()):
        self.bones, self.weights = bones, weights
        self.any = hull([of_double(x) for x in limits]) if limits else None
        self.joints = [(bone, affine(bind)) for bone, bind in joints]
        self.constants = [bone.constant() for bone in bones]

    def clip(self, curves, morphs):
        """Curves of bones, {bone: {what: Curve}}, and of morph targets, (first target, Curve)."""
        return CharacterClip(self, curves, morphs)


class CharacterClip:
    def __init__(self, character, curves, morphs):
        self.character, self.curves, self.morphs = character, curves, morphs
        self.every = [c for of in curves.values() for c in of.values()] + [c for _, c in morphs]
        self.keys = sorted({t for c in self.every for t in c.times})
        self.displaces = bool(morphs) or any(character.weights) or character.any is not None

    def on(self, piece, nodes):
        """Of these simulation nodes, None for others. ZeroDivisionError where a quaternion may pass 0."""
        character, world, wanted = self.character, [], set()
        for j in nodes:
            i = character.joints[j][0]
            while i >= 0 and i not in wanted:
                wanted.add(i)
                i = character.bones[i].parent
        for i, bone in enumerate(character.bones):
            if i not in wanted:
                world.append(None)
                continue
            if i in self.curves:
                first, last, own = bone.moved(self.curves[i], piece)
            else:
                first = last = character.constants[i]
                own = first, None, None
            if bone.parent < 0:
                world.append((first, last, *own))
                continue
            begin, end, w0, w1, w2 = world[bone.parent]
            inside = (chained(w0, own[0], True),
                      total((1, chained(w1, own[0], True)), (1, chained(w0, own[1], False))),
                      total((1, chained(w2, own[0], True)), (2, chained(w1, own[1], False)),
                            (1, chained(w0, own[2], False))))
            still = inside[1] is None and inside[2] is None
            world.append((inside[0], inside[0], *inside) if still else
                         (chained(begin, first, True), chained(end, last, True), *inside))
        of = [[None] * len(character.joints) for _ in range(5)]
        for j in nodes:
            bone, bind = character.joints[j]
            for out, m in zip(of, world[bone]):
                out[j] = chained(m, bind, True) or NOTHING
        return Enclosed(*of, self.weights_on(piece) if self.displaces else None)

    def weights_on(self, piece):
        if self.character.any:  # with each set of weights by itself a vertex moves as its simulation nodes do
            return [(self.character.any,) * 3 + (ZERO, ZERO)] * len(self.character.weights)
        out = [(of_double(w),) * 3 + (ZERO, ZERO) for w in self.character.weights]
        for first_target, curve in self.morphs:
            for i, controls in enumerate(curve.controls(piece)):
                first, last, inside = jets(controls)
                out[first_target + i] = (first, last, *inside)
        return out


class Frames:
    """Maps of frames, interpolated entry by entry between their times."""

    def __init__(self, times, maps):
        self.times, self.maps = times, maps
        self.keys = sorted(set(times))

    def on(self, piece, nodes):
        """Of all simulation nodes."""
        i = max(bisect.bisect_right(self.times, piece.middle) - 1, 0)
        if i + 1 == len(self.times):
            maps = [affine(m) for m in self.maps[i]]
            return Enclosed(maps, maps)
        length = Fraction(self.times[i + 1]) - Fraction(self.times[i])
        ends = []
        for t in (piece.first, piece.last):
            s = (t - Fraction(self.times[i])) / length
            s = of_ratio(s.numerator, s.denominator)
            ends.append([between(a, b, s) for a, b in zip(self.maps[i], self.maps[i + 1])])
        return Enclosed(*ends)


def between(a, b, s):
    entries = [of_double(p) + (of_double(q) - of_double(p)) * s for p, q in zip(a, b)]
    return [x.mid for x in entries], [x.rad for x in entries]
