# SPDX-License-Identifier: GPL-3.0-or-later
"""Bounds for every pose within limits of bones against the vertices: between the pose of the file and another one lie
poses in which one bone after another, from the joint upward, is moved. A step moves a vertex by at most
move + 2 sin(angle/2) |M x| in the frame of the bone's parent, and by that times the stretches of the bones above."""
import math

from certificate.interval import BITS, ONE, ZERO, Interval, of_double, root, sine_and_cosine
from certificate.path import Piece
from certificate.times import along
from certificate.values import WEIGHT_BITS, require


def size(x):
    return root(x[0].square() + x[1].square() + x[2].square())


def entries(enclosed):
    """A map's rows of intervals."""
    mid, rad = enclosed
    return [[Interval(mid[4 * r + c], rad[4 * r + c]) for c in range(4)] for r in range(3)]


def turned(rows, x):
    return [row[0] * x[0] + row[1] * x[1] + row[2] * x[2] for row in rows]


def stretch(rows):
    """At least the 2-norm: of M^T M the root of the greatest sum of a row."""
    columns = [[row[c] for row in rows] for c in range(3)]
    most = 0
    for a in columns:
        products = (a[0] * b[0] + a[1] * b[1] + a[2] * b[2] for b in columns)
        most = max(most, sum(max(p.high(), -p.low()) for p in products))
    return Interval(root(Interval(most)).high())


def stretch_of_bone(bone, rows):
    """Of a rotation after a scale its greatest factor."""
    if bone.matrix:
        return stretch(rows)
    return Interval(max(max(x.high(), -x.low()) for x in bone.still[2]))


def chord(angle):
    if angle >= math.pi:
        return ONE.times(2)
    return sine_and_cosine(of_double(angle).over(2))[0].times(2)


class Link:
    """A bone as the file has it; what poses may do to it, and by how much the bones above stretch that."""

    def __init__(self, bone, angle, move, above):
        self.parent, self.rows = bone.parent, entries(bone.constant())
        self.chord, self.move = chord(angle), of_double(move)
        self.lever = above.lever * above.stretch if above else ONE
        self.stretch = stretch_of_bone(bone, self.rows)


class PoseProof:
    """Of the pose of a proof's motion and all others within limits (angle, move), one per bone."""

    def __init__(self, still, character, limits):
        self.still, self.character, self.links = still, character, []
        for bone, (angle, move) in zip(character.bones, limits):  # parents come first
            self.links.append(Link(bone, angle, move, self.links[bone.parent] if bone.parent >= 0 else None))

    def intervals(self, mid, rad):
        shift = BITS - self.still.vertices.bits
        return [Interval(m << shift, r << shift) if shift >= 0 else Interval(m >> -shift, (r >> -shift) + 2)
                for m, r in zip(mid, rad)]

    def off(self, v, weights):
        """How far poses put the vertex from where the file's pose has it, in units of 2^-(BITS + WEIGHT_BITS)."""
        vertices, total, ball = self.still.vertices, 0, ZERO
        y = self.intervals(vertices.rest[v], [0] * 3)
        if weights and v in vertices.by:  # where they are known the vertex is one point, else that and a ball
            if self.character.any:
                ball = size(self.intervals(*vertices.displaced(v, weights, 0, False)))
            else:
                y = self.intervals(*vertices.displaced(v, weights, 0, True))
        for j, u, _ in vertices.rows[v]:
            i, bind = self.character.joints[j]
            rows = entries(bind)
            x, of_joint = [a + row[3] for a, row in zip(turned(rows, y), rows)], ZERO
            reach = ball * stretch(rows)
            while i >= 0:
                link = self.links[i]
                x, reach = turned(link.rows, x), reach * link.stretch
                of_joint = of_joint + link.lever * (link.move + link.chord * (size(x) + reach))
                x = [a + row[3] for a, row in zip(x, link.rows)]
                i = link.parent
            total += u * of_joint.high()
        return total

    def check(self, first, last, bounds):
        still = self.still
        limits, vertices, axes = still.limits(bounds), still.vertices, still.axes
        joints = {j for v in limits for j, _, _ in vertices.rows[v]}
        enclosed = still.motion.on(Piece(first, last, first), joints)
        lengths = [root(ONE.times(sum(a * a for a in axis))).high() for axis in axes]
        for v, limit in limits.items():
            off = self.off(v, enclosed.weights) << vertices.bits
            mid, rad = along(axes, vertices.place(v, enclosed.first, enclosed.weights, 0))
            for a, (m, r) in enumerate(zip(mid, rad)):
                reach = r + (off * lengths[a] >> BITS) + 1
                for d, x in ((2 * a, m), (2 * a + 1, -m)):
                    require(x + reach <= limit[d], "direction {}: vertex {} is not shown to stay within the bound in "
                            "every pose", d, v)
