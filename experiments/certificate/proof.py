# SPDX-License-Identifier: GPL-3.0-or-later
"""The proof itself: bounds against vertices, and against the dual function."""
import hashlib
import math
import struct
import sys

from certificate.records import DISPLACED_HEADER, HEADER, DisplacedHeader, Header, check_end, partial
from certificate.surface import RestBounds, Surface, Target
from certificate.timed import HEADER as TIMED_HEADER, TimedChecker, TimedHeader
from certificate.values import (WEIGHT_BITS, Rejected, bits_after_point, double, double_or_ratio, in_order,
                                least_doubles, listed, require, scaled, whole)


class FrameProof:
    """Everything about one frame that the bounds of its BVs are held against."""

    def __init__(self, checker, maps, morphs):
        self.checker, self.maps = checker, maps
        self.rest(morphs)
        map_bits = max(bits_after_point(x) for m in maps for x in m)
        self.bits = map_bits + self.rest_bits  # of positions
        self.units = [[scaled(x, map_bits) for x in m] for m in maps]
        for m in self.units:
            for r in (3, 7, 11):
                m[r] <<= self.rest_bits
        if checker.rest_bounds:  # per axis and simulation node: A^T axis, 2 axis . t
            def column(axis, m, s):
                return sum(a * m[4 * r + s] for r, a in enumerate(axis) if a)
            self.columns = [[(*(column(axis, m, s) for s in range(3)), 2 * column(axis, m, 3)) for m in self.units]
                            for axis in checker.header.axes]
        surface = checker.surface
        of_vertex = [list(map(max, self.exact(v), self.computed(v))) if used else None
                     for v, used in enumerate(checker.used)]
        self.supports = surface.merged(lambda vs: [max(all_of) for all_of in zip(*(of_vertex[v] for v in vs))],
                                       lambda a, b: list(map(max, a, b)))

    def rest(self, morphs):
        """Rest positions with displacements of these weights: in units, and in doubles as cinch adds them up."""
        checker = self.checker
        self.rest_bits, self.rest_units = checker.rest_bits, checker.rest_units
        self.positions = checker.surface.positions
        if not morphs:
            return
        weight_bits = max(map(bits_after_point, morphs))
        by_bits = max((bits_after_point(x) for target in checker.targets for d in target.by for x in d), default=0)
        self.rest_bits = max(checker.rest_bits, weight_bits + by_bits)
        self.rest_units = [[x << (self.rest_bits - checker.rest_bits) for x in p] for p in checker.rest_units]
        self.positions = [list(p) for p in checker.surface.positions]
        for weight, target in zip(morphs, checker.targets):
            units = scaled(weight, weight_bits) << (self.rest_bits - weight_bits - by_bits)
            for v, d in zip(target.vertices, target.by):
                exact, computed = self.rest_units[v], self.positions[v]
                for r in range(3):
                    exact[r] += units * scaled(d[r], by_bits)
                    computed[r] = computed[r] + weight * d[r]

    def exact(self, v):
        """Per direction the least double that holds vertex v in real arithmetic."""
        x, y, z = self.rest_units[v]
        p = q = r = 0
        for j, u, _ in self.checker.surface.rows[v]:
            a, b, c, d, e, f, g, h, i, k, l, m = self.units[j]
            p += u * (a * x + b * y + c * z + d)
            q += u * (e * x + f * y + g * z + h)
            r += u * (i * x + k * y + l * z + m)
        return self.along((p, q, r), self.bits + WEIGHT_BITS)

    def computed(self, v):
        """Per direction the least double that holds vertex v as cinch computes it; infinite where a coordinate is."""
        x, y, z = self.positions[v]
        p = q = r = 0.0
        for j, _, w in self.checker.surface.rows[v]:
            a, b, c, d, e, f, g, h, i, k, l, m = self.maps[j]
            p = p + w * (((a * x + b * y) + c * z) + d)
            q = q + w * (((e * x + f * y) + g * z) + h)
            r = r + w * (((i * x + k * y) + l * z) + m)
        point = (p, q, r)
        if all(map(math.isfinite, point)):
            if len(self.checker.header.axes) == 3:
                return [p, -p, q, -q, r, -r]
            bits = max(map(bits_after_point, point))
            return self.along([scaled(c, bits) for c in point], bits)
        out = []
        for axis in self.checker.header.axes:
            involved = [a * c for a, c in zip(axis, point) if a]
            if all(map(math.isfinite, involved)):
                bits = max(map(bits_after_point, involved))
                out += least_doubles(sum(scaled(c, bits) for c in involved), bits)
            else:
                out += math.inf, math.inf
        return out

    def along(self, point, bits):
        out = []
        for a, b, c in self.checker.header.axes:
            out += least_doubles(a * point[0] + b * point[1] + c * point[2], bits)
        return out

    def check(self, i, bounds, lambdas):
        """Proves the bounds of BV i, of which None is infinity."""
        support = self.supports[i]
        for d, bound in enumerate(bounds):
            if bound is not None and not bound >= support[d]:
                self.explain(i, d, bound)
        if lambdas is not None and any(bound is not None for bound in bounds):
            intervals = self.checker.rest_bounds.intervals[i]
            for a in range(len(self.columns)):
                b = self.extrema(i, intervals[0], self.columns[a])
                for d in (2 * a, 2 * a + 1):
                    if bounds[d] is not None:
                        p, q = bounds[d].as_integer_ratio()
                        above, below = self.dual(b[d % 2], intervals, lambdas[d])
                        require(p * below >= above * q,
                                "direction {}: the bound {} lies below D(lambda)", d, bounds[d].hex())

    def explain(self, i, d, bound):
        for v in self.checker.surface.vertices_of(i):
            for kind, support in (("in real arithmetic", self.exact), ("as computed", self.computed)):
                require(bound >= support(v)[d],
                        "direction {}: vertex {} {} lies beyond the bound {}", d, v, kind, bound.hex())
        raise Rejected(f"direction {d}: a vertex lies beyond the bound {bound.hex()}")

    def extrema(self, i, nodes, columns):
        """Exact extrema of the moved rest box along the axis and against it, per node, in units of 2^-(bits + 1)."""
        low, high = self.checker.rest_bounds.low[i], self.checker.rest_bounds.high[i]
        c0, c1, c2 = (h + l for l, h in zip(low, high))
        e0, e1, e2 = (h - l for l, h in zip(low, high))
        plus, minus = [], []
        for j in nodes:
            g0, g1, g2, t = columns[j]
            p = g0 * c0 + g1 * c1 + g2 * c2 + t
            r = abs(g0) * e0 + abs(g1) * e1 + abs(g2) * e2
            plus.append(p + r)
            minus.append(r - p)
        return plus, minus

    def dual(self, b, intervals, ratio):
        """D(lambda) as numerator and denominator > 0."""
        p, q = ratio
        bits = self.bits + 1
        shift = q.bit_length() - 1
        if q == 1 << shift and shift <= bits:  # lambda is a whole number of units too
            p, q = p << (bits - shift), 1
        else:
            p <<= bits
            b = [x * q for x in b]
        total = p << WEIGHT_BITS
        for x, l, h in zip(b, intervals[1], intervals[2]):
            x -= p
            total += (h if x > 0 else l) * x
        return total, q << (bits + WEIGHT_BITS)


def checker_of(records, tie=None, progress=lambda text: None):
    """Of a whole certificate, proven; raises Rejected."""
    require(1e16 + 2.9999 == 10000000000000002.0 and sys.float_info.mant_dig == 53,
            "this machine's floats are no IEEE doubles")
    record = records.expect("a header", HEADER, TIMED_HEADER, DISPLACED_HEADER)
    if record.keys() == TIMED_HEADER:
        return TimedChecker(records, TimedHeader(record), tie, progress)
    if record.keys() == DISPLACED_HEADER:
        require(not tie, "it has morph targets, which no file of --input has")
        return Checker(records, DisplacedHeader(record), tie, progress)
    return Checker(records, Header(record), tie, progress)


class Checker:
    """Reads and proves a whole certificate. `tie` compares with files of --input; see files.py."""

    def __init__(self, records, header, tie=None, progress=lambda text: None):
        self.records, self.header, self.tie = records, header, tie
        progress("surface")
        self.surface = surface = Surface(header, records)
        self.targets = Target.read(header, records)
        if tie:
            tie.surface(surface)
        self.used = bytearray(header.vertices)
        for triangle in surface.triangles:
            for v in triangle:
                self.used[v] = 1
        self.rest_bits = max(bits_after_point(x) for position in surface.positions for x in position)
        self.rest_units = [[scaled(x, self.rest_bits) for x in position] for position in surface.positions]
        self.rest_bounds = RestBounds(surface, self.rest_units) if header.duality else None
        self.proven = self.infinite = 0
        transforms = hashlib.sha256()
        for f in range(header.frames):
            progress(f"frame {f + 1} of {header.frames}")
            self.check_frame(f, transforms)
        check_end(records, header, "frames", {"proven": self.proven, "infinite": self.infinite},
                  ("transforms", transforms))

    def check_frame(self, f, transforms):
        keys = {"frame", "time", "maps", "morphs"} if self.targets else {"frame", "time", "maps"}
        record = self.records.expect(f"frame {f}", keys)
        in_order("frame", record["frame"], f)
        time = double(record["time"])
        maps = listed(record["maps"], self.header.nodes, "maps")
        maps = [[double(x) for x in listed(m, 12, "a transform")] for m in maps]
        transforms.update(struct.pack("<d", time))
        for m in maps:
            transforms.update(struct.pack("<12d", *m))
        morphs = [double(x) for x in listed(record["morphs"], len(self.targets), "morphs")] if self.targets else []
        transforms.update(struct.pack(f"<{len(morphs)}d", *morphs))
        if self.tie:
            self.tie.frame(self.header.clip, time, maps)
        proof = FrameProof(self, maps, morphs)
        k, duality = self.header.directions, self.header.duality
        keys = {"frame", "bv", "bounds", "lambda"} if duality else {"frame", "bv", "bounds"}
        for i in range(self.header.bvs):
            record = self.records.expect(f"BV {i} of frame {f}", keys)
            in_order("frame", record["frame"], f)
            in_order("BV", record["bv"], i)
            bounds = [None if x == "inf" else double(x) for x in listed(record["bounds"], k, "bounds")]
            infinite = bounds.count(None)
            self.infinite += infinite
            self.proven += k - infinite
            lambdas = [double_or_ratio(x) for x in listed(record["lambda"], k, "lambda")] if duality else None
            proof.check(i, bounds, lambdas)

    def verdict(self):
        return f"{partial(self.header)}{self.proven} bounds proven, {self.infinite} infinite"
