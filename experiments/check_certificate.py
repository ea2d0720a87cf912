#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Proves a certificate of `cinch verify --certificate FILE` again, with nothing but the Python standard library.

For every BV: its rest box and weight intervals hold all its vertices. For every BV, frame and direction: the bound is at
least D(lambda) = lambda + sum_j [ l_j (b_j - lambda) + (h_j - l_j) max(b_j - lambda, 0) ], which by weak duality is at least
sum_j w_j b_j for all weights l <= w <= h with sum 1, b_j the exact extremum of the deformed rest box; and it is at least every
vertex deformed in exact arithmetic, and every vertex as cinch computes it in doubles. All comparisons are exact: doubles are
integers times a power of two.

Usage: check_certificate.py FILE[.gz]
Exit status: 0 accepted, 1 rejected, 2 not readable as a certificate.
"""
import gzip
import json
import math
import sys
from fractions import Fraction

FACES = [(1, 0, 0), (0, 1, 0), (0, 0, 1)]
CORNERS = [(1, 1, 1), (1, 1, -1), (1, -1, 1), (1, -1, -1)]
EDGES = [(1, 1, 0), (1, 0, 1), (0, 1, 1), (1, -1, 0), (1, 0, -1), (0, 1, -1)]
AXES = {6: FACES, 14: FACES + CORNERS, 18: FACES + EDGES, 26: FACES + CORNERS + EDGES}
WEIGHT_BITS = 53


class Rejected(Exception):
    """The certificate is readable, but proves nothing."""


def finite(text):
    x = float.fromhex(text)
    if not math.isfinite(x):
        raise Rejected(f"{text} is not finite")
    return x


def weight_units(text):
    """A weight as a whole number of 2^-53."""
    units = finite(text) * 2.0**WEIGHT_BITS
    if not (0 <= units <= 2.0**WEIGHT_BITS and units == int(units)):
        raise Rejected(f"weight {text} is not a multiple of 2^-53 between 0 and 1")
    return int(units)


def bits_after_point(x):
    return x.as_integer_ratio()[1].bit_length() - 1


def scaled(x, bits):
    """x * 2^bits, a whole number."""
    p, q = x.as_integer_ratio()
    return p << (bits - (q.bit_length() - 1))


def require(condition, message, *values):
    if not condition:
        raise Rejected(message.format(*values))


class Checker:
    def __init__(self, header):
        self.header = header
        self.axes = AXES[header["kdop"]]
        self.weight_space = header["weight_space"]
        self.rest, self.rows, self.bvs, self.bounds_checked = [], [], [], 0

    # ---- rest data -------------------------------------------------------------------------------------------------

    def add_vertex(self, record):
        require(record["vertex"] == len(self.rest), "vertex {} is out of order", record["vertex"])
        self.rest.append([finite(x) for x in record["rest"]])
        nodes, weights = record["nodes"], record["weights"]
        units = [weight_units(w) for w in weights]
        require(len(nodes) == len(units) and sum(units) == 1 << WEIGHT_BITS, "vertex {}: weights do not sum to 1", record["vertex"])
        require(all(0 <= a < self.header["nodes"] for a in nodes) and all(a < b for a, b in zip(nodes, nodes[1:])),
                "vertex {}: bad simulation nodes", record["vertex"])
        self.rows.append((nodes, units, [float.fromhex(w) for w in weights]))

    def add_bv(self, record):
        require(record["bv"] == len(self.bvs), "BV {} is out of order", record["bv"])
        record["l"] = [weight_units(x) for x in record["l"]]
        record["h"] = [weight_units(x) for x in record["h"]]
        record["centre"] = [finite(x) for x in record["centre"]]
        record["half"] = [float.fromhex(x) for x in record["half"]]
        require(len(record["nodes"]) == len(record["l"]) == len(record["h"]) > 0, "BV {}: lengths differ", record["bv"])
        self.bvs.append(record)

    def check_rest(self):
        header = self.header
        require(len(self.rest) == header["vertices"] and len(self.bvs) == header["bvs"], "vertices or BVs are missing")
        parents, triangles = [0] * len(self.bvs), 0
        held = [None] * len(self.bvs)  # per BV: low, high, {node: (least, greatest weight)}
        for i in range(len(self.bvs) - 1, -1, -1):  # children come after parents
            bv = self.bvs[i]
            if "children" in bv:
                a, b = bv["children"]
                require(i < a < len(self.bvs) and i < b < len(self.bvs) and a != b, "BV {}: bad children", i)
                parents[a] += 1
                parents[b] += 1
                held[i] = self.union(held[a], held[b])
                held[a] = held[b] = None
            else:
                triangles += len(bv["triangles"])
                corners = sorted({v for t in bv["triangles"] for v in t})
                require(corners and 0 <= corners[0] and corners[-1] < len(self.rest), "BV {}: bad vertices", i)
                bv["corners"] = corners
                held[i] = self.vertex_data(corners[0])
                for v in corners[1:]:
                    held[i] = self.union(held[i], self.vertex_data(v))
            self.check_bv(bv, *held[i])
        require(triangles == header["triangles"], "the leaves hold {} triangles, not {}", triangles, header["triangles"])
        require(all(n == (i > 0) for i, n in enumerate(parents)), "the BVs are no tree")

    def vertex_data(self, v):
        nodes, units, _ = self.rows[v]
        return self.rest[v], self.rest[v], {j: (w, w) for j, w in zip(nodes, units)}

    @staticmethod
    def union(a, b):
        low = [min(x, y) for x, y in zip(a[0], b[0])]
        high = [max(x, y) for x, y in zip(a[1], b[1])]
        nodes = {}
        for j in a[2].keys() | b[2].keys():  # a node that misses a vertex has weight 0 there
            l1, h1 = a[2].get(j, (0, 0))
            l2, h2 = b[2].get(j, (0, 0))
            nodes[j] = (min(l1, l2), max(h1, h2))
        return low, high, nodes

    def check_bv(self, bv, low, high, nodes):
        where = f"BV {bv['bv']}"
        for axis in range(3):
            centre, half = bv["centre"][axis], bv["half"][axis]
            require(half >= 0, where + ": negative half extent")
            if math.isfinite(half):
                c, e = Fraction(centre), Fraction(half)
                require(c - e <= Fraction(low[axis]) and Fraction(high[axis]) <= c + e, where + ": the rest box does not hold its vertices")
        listed = bv["nodes"]
        require(all(a < b for a, b in zip(listed, listed[1:])) and 0 <= listed[0] and listed[-1] < self.header["nodes"], where + ": bad simulation nodes")
        require(nodes.keys() <= set(listed), where + ": an influencing simulation node is not listed")
        for j, l, h in zip(listed, bv["l"], bv["h"]):
            least, greatest = nodes.get(j, (0, 0))
            require(l <= least and greatest <= h, where + ": a weight of simulation node {} lies outside its interval", j)

    # ---- frames ----------------------------------------------------------------------------------------------------

    def begin_frame(self, record):
        self.frame = record["frame"]
        self.maps = [[finite(x) for x in m] for m in record["maps"]]
        require(len(self.maps) == self.header["nodes"] and all(len(m) == 12 for m in self.maps), "frame {}: bad transforms", self.frame)
        places = [x for bv in self.bvs for x in bv["centre"] + bv["half"] if math.isfinite(x)]
        if self.frame == 0:
            self.rest_bits = max((bits_after_point(x) for x in places + [x for v in self.rest for x in v]), default=0)
            self.rest_units = [[scaled(x, self.rest_bits) for x in v] for v in self.rest]
            self.box_units = [
                ([scaled(x, self.rest_bits) for x in bv["centre"]],
                 [scaled(x, self.rest_bits) for x in bv["half"]] if all(map(math.isfinite, bv["half"])) else None) for bv in self.bvs]
        self.map_bits = max(bits_after_point(x) for m in self.maps for x in m)
        self.bits = self.map_bits + self.rest_bits  # of positions
        units = [[scaled(x, self.map_bits) for x in m] for m in self.maps]
        for m in units:
            for r in (3, 7, 11):
                m[r] <<= self.rest_bits
        self.map_units = units
        # Per axis and node: A^T axis, axis . t
        self.columns = [[[sum(a * m[4 * r + s] for r, a in enumerate(axis) if a) for s in range(4)] for m in units] for axis in self.axes]
        self.frame_bvs = 0
        self.deform()
        self.support = self.supports()

    def deform(self):
        self.exact, self.computed = [], []
        for x, f, (nodes, units, weights) in zip(self.rest_units, self.rest, self.rows):
            exact = [0, 0, 0]
            computed = [0.0, 0.0, 0.0]
            for j, u, w in zip(nodes, units, weights):
                m, d = self.map_units[j], self.maps[j]
                for r in range(3):
                    i = 4 * r
                    exact[r] += u * (m[i] * x[0] + m[i + 1] * x[1] + m[i + 2] * x[2] + m[i + 3])
                    computed[r] = computed[r] + w * (((d[i] * f[0] + d[i + 1] * f[1]) + d[i + 2] * f[2]) + d[i + 3])
            self.exact.append(exact)
            self.computed.append(computed)

    def supports(self):
        """Per BV and direction the exact support of its exact vertices (units of 2^-(bits + 53)) and of its computed ones (Fraction or float)."""
        out = [None] * len(self.bvs)
        faces_only = len(self.axes) == 3
        for i in range(len(self.bvs) - 1, -1, -1):
            bv = self.bvs[i]
            if "children" in bv:
                a, b = (out[c] for c in bv["children"])
                out[i] = [max(x, y) for x, y in zip(a[0], b[0])], [max(x, y) for x, y in zip(a[1], b[1])]
                continue
            exact, computed = [], []
            for axis in self.axes:
                along = [sum(a * self.exact[v][r] for r, a in enumerate(axis) if a) for v in bv["corners"]]
                if faces_only:
                    doubles = [self.computed[v][axis.index(1)] for v in bv["corners"]]
                else:
                    doubles = [sum(a * Fraction(self.computed[v][r]) if math.isfinite(self.computed[v][r]) else math.nan
                                   for r, a in enumerate(axis) if a) for v in bv["corners"]]
                if not all(x == x and abs(x) != math.inf for x in doubles):
                    doubles = [math.inf, -math.inf]  # contained in an infinite bound only, either way
                exact += [max(along), -min(along)]
                computed += [max(doubles), -min(doubles)]
            out[i] = exact, computed
        return out

    def check_bounds(self, record):
        i = record["bv"]
        require(record["frame"] == self.frame and i == self.frame_bvs, "frame {}, BV {}: out of order", record["frame"], i)
        self.frame_bvs += 1
        bounds = record["bounds"]
        require(len(bounds) == 2 * len(self.axes), "frame {}, BV {}: {} bounds", self.frame, i, len(bounds))
        exact, computed = self.support[i]
        extrema = None
        for d, text in enumerate(bounds):
            self.bounds_checked += 1
            bound = float.fromhex(text)
            if bound == math.inf:
                continue
            where = f"frame {self.frame}, BV {i}, direction {d}"
            require(math.isfinite(bound), where + ": the bound is not a number above minus infinity")
            p, q = bound.as_integer_ratio()
            require(p << (self.bits + WEIGHT_BITS) >= exact[d] * q, where + ": an exact vertex lies outside")
            require(bound >= computed[d], where + ": a computed vertex lies outside")
            if not self.weight_space:
                continue
            if extrema is None:
                extrema = self.extrema(i, where)
            dual = self.dual(self.bvs[i], extrema[d], record["lambda"][d])
            require(p * dual[1] >= dual[0] * q, where + ": the bound {} lies below D(lambda)", text)

    def extrema(self, i, where):
        """Exact extrema of the deformed rest box per direction and node, in units of 2^-bits."""
        c, e = self.box_units[i]
        require(e is not None, where + ": a finite bound on an infinite rest box")
        out = []
        for columns in self.columns:
            plus, minus = [], []
            for j in self.bvs[i]["nodes"]:
                g0, g1, g2, t = columns[j]
                p = g0 * c[0] + g1 * c[1] + g2 * c[2] + t
                r = abs(g0) * e[0] + abs(g1) * e[1] + abs(g2) * e[2]
                plus.append(p + r)
                minus.append(r - p)
            out += [plus, minus]
        return out

    def dual(self, bv, b, text):
        """D(lambda) as numerator and denominator > 0."""
        if "/" in text:
            ratio = Fraction(text)
            p, q = ratio.numerator, ratio.denominator
        else:
            p, q = finite(text).as_integer_ratio()
        lam = p << self.bits  # lambda = lam / (q 2^bits)
        one = 1 << WEIGHT_BITS
        total = lam * one
        for x, l, h in zip(b, bv["l"], bv["h"]):
            above = x * q - lam
            total += (h if above > 0 else l) * above
        return total, q << (self.bits + WEIGHT_BITS)

    def end_frame(self):
        require(self.frame_bvs == len(self.bvs), "frame {}: {} of {} BVs", self.frame, self.frame_bvs, len(self.bvs))


def check(lines, progress=lambda text: None):
    header = json.loads(next(lines, "null"))
    if not isinstance(header, dict) or header.get("certificate") != "cinch 1":
        raise ValueError("the first line is no header of a cinch certificate")
    checker, frames, rest_checked = Checker(header), 0, False
    for line in lines:
        record = json.loads(line)
        if "vertex" in record:
            checker.add_vertex(record)
        elif "maps" in record:
            if not rest_checked:
                progress("rest data")
                checker.check_rest()
                rest_checked = True
            if frames:
                checker.end_frame()
            require(record["frame"] == frames, "frame {} is out of order", record["frame"])
            progress(f"frame {frames + 1} of {header['frames']}")
            checker.begin_frame(record)
            frames += 1
        elif "bounds" in record:
            require(frames > 0, "bounds before any frame")
            checker.check_bounds(record)
        else:
            checker.add_bv(record)
    require(rest_checked and frames == header["frames"], "{} of {} frames", frames, header["frames"])
    checker.end_frame()
    return checker.bounds_checked


def main():
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        print(__doc__.strip())
        return 0 if sys.argv[1:] in (["-h"], ["--help"]) else 2
    name = sys.argv[1]

    def progress(text):
        if sys.stderr.isatty():
            print(f"\r\x1b[Kchecking {text}", end="", file=sys.stderr, flush=True)

    try:
        with (gzip.open(name, "rt") if name.endswith(".gz") else open(name, encoding="ascii")) as lines:
            bounds = check(lines, progress)
    except Rejected as reason:
        print(f"{name}: rejected: {reason}")
        return 1
    except (OSError, EOFError, ValueError, KeyError, TypeError, IndexError, AttributeError, OverflowError, StopIteration) as error:
        print(f"{name}: not readable as a certificate: {type(error).__name__}: {error}", file=sys.stderr)
        return 2
    finally:
        if sys.stderr.isatty():
            print("\r\x1b[K", end="", file=sys.stderr)
    print(f"{name}: accepted: {bounds} bounds proven")
    return 0


if __name__ == "__main__":
    sys.exit(main())
