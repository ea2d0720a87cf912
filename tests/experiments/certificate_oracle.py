# SPDX-License-Identifier: GPL-3.0-or-later
"""Supports and duals from the formulas alone."""
from fractions import Fraction


def double_or_ratio(text):
    return Fraction(text) if "/" in text else Fraction(float.fromhex(text))


class Oracle:
    """Supports and duals of a certificate, in fractions, from the formulas alone."""

    def __init__(self, records):
        number = lambda x: Fraction(float.fromhex(x))  # noqa: E731
        vertices = [r for r in records if "rest" in r]
        self.rest = [[number(x) for x in r["rest"]] for r in vertices]
        self.weights = [dict(zip(r["nodes"], map(number, r["weights"]))) for r in vertices]
        self.maps = [[[number(x) for x in m] for m in r["maps"]] for r in records if "maps" in r]
        self.triangles = [r["vertices"] for r in records if "triangle" in r]
        self.bvs = [r for r in records if "bv" in r and "bounds" not in r]

    def vertices(self, bv):
        r = self.bvs[bv]
        if "children" in r:
            return set().union(*map(self.vertices, r["children"]))
        return {v for t in r["triangles"] for v in self.triangles[t]}

    def image(self, frame, node, x, d):
        m, sign = self.maps[frame][node], -1 if d % 2 else 1
        row = m[4 * (d // 2):4 * (d // 2) + 4]  # faces only
        return sign * (sum(a * b for a, b in zip(row, x)) + row[3])

    def support(self, frame, bv, d):
        return max(sum(w * self.image(frame, j, self.rest[v], d) for j, w in self.weights[v].items())
                   for v in self.vertices(bv))

    def dual(self, frame, bv, d, lam):
        vertices = self.vertices(bv)
        total = lam
        for j in {j for v in vertices for j in self.weights[v]}:
            l, h = (f(self.weights[v].get(j, Fraction(0)) for v in vertices) for f in (min, max))
            corners = [[]]
            for s in range(3):
                ends = [f(self.rest[v][s] for v in vertices) for f in (min, max)]
                corners = [c + [x] for c in corners for x in ends]
            b = max(self.image(frame, j, c, d) for c in corners)
            total += (h if b > lam else l) * (b - lam)
        return total
