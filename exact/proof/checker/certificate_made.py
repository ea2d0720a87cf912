# SPDX-License-Identifier: GPL-3.0-or-later
"""A certificate made from the formulas alone: a bumpy sheet, random transforms, bounds that are as tight as can be."""
import math
import random
from fractions import Fraction

from certificate_forge import sealed

FACES = [(1, 0, 0), (0, 1, 0), (0, 0, 1)]
CORNERS = [(1, 1, 1), (1, 1, -1), (1, -1, 1), (1, -1, -1)]
EDGES = [(1, 1, 0), (1, 0, 1), (0, 1, 1), (1, -1, 0), (1, 0, -1), (0, 1, -1)]
AXES = {6: FACES, 14: FACES + CORNERS, 18: FACES + EDGES, 26: FACES + CORNERS + EDGES}
ONE = 1 << 53


def up(x):
    """The least double that is at least a fraction."""
    y = float(x)
    return y if Fraction(y) >= x else math.nextafter(y, math.inf)




def weights_of(rng, nodes):
    """Positive multiples of 2^-53 with sum 1."""
    chosen = sorted(rng.sample(range(nodes), min(nodes, rng.randrange(1, 5))))
    units = [rng.randrange(1, ONE // len(chosen)) for _ in chosen]
    units[0] += ONE - sum(units)
    return chosen, units


def tree_of(triangles, leaf):
    """Records of BVs: halves until a leaf holds at most so many."""
    out, pending = [], [list(range(triangles))]
    at = 0
    while at < len(pending):
        held = pending[at]
        if len(held) <= leaf:
            out.append({"bv": at, "triangles": held})
        else:
            out.append({"bv": at, "children": [len(pending), len(pending) + 1]})
            pending += held[:len(held) // 2], held[len(held) // 2:]
        at += 1
    return out


def computed(x, row, m):
    """As cinch evaluates it."""
    out = [0.0, 0.0, 0.0]
    for j, w in row:
        for r in range(3):
            a, b, c, d = m[j][4 * r:4 * r + 4]
            out[r] = out[r] + w * (((a * x[0] + b * x[1]) + c * x[2]) + d)
    return out


def exact(x, row, m):
    return [sum(Fraction(w) * (sum(Fraction(m[j][4 * r + s]) * Fraction(x[s]) for s in range(3)) +
                               Fraction(m[j][4 * r + 3])) for j, w in row) for r in range(3)]


def made(seed=1, rows=6, nodes=6, frames=3, leaf=4, kdop=6, method="limited", spread=1.0):
    rng = random.Random(seed)
    places = [[(c + rng.uniform(-.2, .2)) * spread, (r + rng.uniform(-.2, .2)) * spread, rng.uniform(-1, 1)]
              for r in range(rows) for c in range(rows)]
    weights = [weights_of(rng, nodes) for _ in places]
    triangles = []
    for r in range(rows - 1):
        for c in range(rows - 1):
            a = r * rows + c
            triangles += [a, a + 1, a + rows + 1], [a, a + rows + 1, a + rows]
    bvs = tree_of(len(triangles), leaf)
    skin = [[(j, u / ONE) for j, u in zip(*w)] for w in weights]
    records = [{"certificate": "cinch 2", "method": method, "rest_shape": "aabb", "kdop": kdop, "vertices": 0,
                "triangles": 0, "nodes": nodes, "bvs": 0, "frames": 0, "clip": "made", "partial": False,
                "missing": [], "sha256": {}}]
    records += [{"vertex": k, "rest": [x.hex() for x in p], "nodes": w[0], "weights": [(u / ONE).hex() for u in w[1]]}
                for k, (p, w) in enumerate(zip(places, weights))]
    records += [{"triangle": t, "vertices": v} for t, v in enumerate(triangles)]
    records += bvs
    below = [None] * len(bvs)
    for i in range(len(bvs) - 1, -1, -1):
        b = bvs[i]
        below[i] = ({v for t in b["triangles"] for v in triangles[t]} if "triangles" in b else
                    below[b["children"][0]] | below[b["children"][1]])
    for f in range(frames):
        m = [[rng.uniform(-1, 1) for _ in range(12)] for _ in range(nodes)]
        records.append({"frame": f, "time": (f / 8).hex(), "maps": [[x.hex() for x in row] for row in m]})
        ends = [(exact(x, row, m), [Fraction(c) for c in computed(x, row, m)]) for x, row in zip(places, skin)]
        for i in range(len(bvs)):
            bounds, lambdas = [], []
            for axis in AXES[kdop]:
                for sign in (1, -1):
                    g = [sign * a for a in axis]
                    least = max(sum(a * c for a, c in zip(g, e)) for v in below[i] for e in ends[v])
                    if method == "limited":
                        lam, dual = lambda_and_dual(g, [places[v] for v in below[i]], [skin[v] for v in below[i]], m)
                        lambdas.append(lam.hex())
                        least = max(least, dual)
                    bounds.append(up(least).hex())
            record = {"frame": f, "bv": i, "bounds": bounds}
            if method == "limited":
                record["lambda"] = lambdas
            records.append(record)
    records.append({"end": "cinch 2", "frames": 0, "proven": 0, "infinite": 0, "violated": 0, "sha256": {}})
    return sealed(records)


def lambda_and_dual(g, places, rows, m):
    """A middling double, and the dual function there."""
    low, high = ([end(p[s] for p in places) for s in range(3)] for end in (min, max))
    rows = [dict(row) for row in rows]
    b = {}
    for j in sorted({j for row in rows for j in row}):
        q = [sum(g[r] * Fraction(m[j][4 * r + s]) for r in range(3)) for s in range(4)]
        b[j] = q[3] + sum(max(q[s] * Fraction(low[s]), q[s] * Fraction(high[s])) for s in range(3))
    lam = float(sorted(b.values())[len(b) // 2])
    total = Fraction(lam)
    for j, x in b.items():
        ws = [row.get(j, 0.0) for row in rows]
        total += Fraction(max(ws) if x > lam else min(ws)) * (x - Fraction(lam))
    return lam, total
