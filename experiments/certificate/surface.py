# SPDX-License-Identifier: GPL-3.0-or-later
"""The surface of a certificate, and the tree of BVs over it."""
import array
import hashlib
import struct

from certificate.values import ONE, double, in_order, listed, require, weight_units, whole


class Surface:
    """Rest positions, weights and triangles, and the tree of BVs over them."""

    def __init__(self, header, records):
        self.positions, self.rows, self.triangles = [], [], []
        positions, weights, triangles = hashlib.sha256(), hashlib.sha256(), hashlib.sha256()
        for k in range(header.vertices):
            record = records.expect(f"vertex {k}", {"vertex", "rest", "nodes", "weights"})
            in_order("vertex", record["vertex"], k)
            rest = [double(x) for x in listed(record["rest"], 3, "rest")]
            nodes = [whole(j, 0, header.nodes - 1, "a simulation node") for j in listed(record["nodes"], None, "nodes")]
            require(all(a < b for a, b in zip(nodes, nodes[1:])), "the simulation nodes do not ascend")
            row = [weight_units(w) for w in listed(record["weights"], len(nodes), "weights")]
            require(sum(u for u, _ in row) == ONE, "the weights do not sum to 1")
            self.positions.append(rest)
            self.rows.append([(j, u, w) for j, (u, w) in zip(nodes, row)])
            positions.update(struct.pack("<3d", *rest))
            n = len(nodes)
            weights.update(struct.pack(f"<I{n}I{n}d", n, *nodes, *(w for _, w in row)))
        for t in range(header.triangles):
            record = records.expect(f"triangle {t}", {"triangle", "vertices"})
            in_order("triangle", record["triangle"], t)
            corners = [whole(v, 0, header.vertices - 1, "a vertex") for v in listed(record["vertices"], 3, "vertices")]
            self.triangles.append(tuple(corners))
            triangles.update(struct.pack("<3I", *corners))
        for what, found in (("positions", positions), ("weights", weights), ("triangles", triangles)):
            header.agree(what, found)
        self.read_bvs(header, records)

    def read_bvs(self, header, records):
        """Per BV the pair of its children, or the ascending vertices of a leaf."""
        self.children, self.corners = [], []
        require(header.bvs < 2 * header.triangles, "{} BVs over {} triangles", header.bvs, header.triangles)
        seen, parents, count = bytearray(header.triangles), bytearray(header.bvs), 0
        for i in range(header.bvs):
            record = records.expect(f"BV {i}", {"bv", "triangles"}, {"bv", "children"})
            in_order("BV", record["bv"], i)
            if "children" in record:
                pair = [whole(c, i + 1, header.bvs - 1, "a child") for c in listed(record["children"], 2, "children")]
                for c in pair:
                    require(not parents[c], "BV {} has two parents", c)
                    parents[c] = 1
                self.children.append(pair)
                self.corners.append(None)
                continue
            held = listed(record["triangles"], None, "triangles")
            require(held, "a leaf without triangles")
            for t in held:
                whole(t, 0, header.triangles - 1, "a triangle")
                require(not seen[t], "triangle {} stands in two leaves or twice in one", t)
                seen[t] = 1
            count += len(held)
            self.children.append(None)
            self.corners.append(sorted({v for t in held for v in self.triangles[t]}))
        require(count == header.triangles, "the leaves hold {} of {} triangles", count, header.triangles)
        require(all(parents[1:]), "BV {} has no parent", parents.find(0, 1))

    def vertices_of(self, bv):
        """The vertices of a BV, some of them several times."""
        below = [bv]
        while below:
            i = below.pop()
            if self.children[i]:
                below += self.children[i]
            else:
                yield from self.corners[i]

    def merged(self, of_leaf, of_pair):
        """Per BV: of_leaf(vertices) of leaves, of_pair(child, child) of the others."""
        out = [None] * len(self.children)
        for i in range(len(out) - 1, -1, -1):  # children come after their parents
            pair = self.children[i]
            out[i] = of_pair(out[pair[0]], out[pair[1]]) if pair else of_leaf(self.corners[i])
        return out


class Target:
    """A morph target: ascending vertices, and by how much it displaces each at weight 1."""

    def __init__(self, record, vertices):
        self.vertices = [whole(v, 0, vertices - 1, "a vertex") for v in listed(record["vertices"], None, "vertices")]
        require(all(a < b for a, b in zip(self.vertices, self.vertices[1:])),
                "the vertices of a target do not ascend")
        self.by = [[double(x) for x in listed(d, 3, "a displacement")]
                   for d in listed(record["displacements"], len(self.vertices), "displacements")]

    @staticmethod
    def read(header, records):
        """All of a certificate of frames."""
        targets, hashed = [], hashlib.sha256()
        for i in range(header.targets):
            record = records.expect(f"target {i}", {"target", "vertices", "displacements"})
            in_order("target", record["target"], i)
            targets.append(target := Target(record, header.vertices))
            n = len(target.vertices)
            hashed.update(struct.pack(f"<I{n}I", n, *target.vertices))
            for d in target.by:
                hashed.update(struct.pack("<3d", *d))
        if header.targets:
            header.agree("targets", hashed)
        return targets


class RestBounds:
    """The least rest box and weight intervals of every BV: the weight space and the extrema of weak duality."""

    def __init__(self, surface, units):
        """units: rest positions as whole numbers."""
        self.low, self.high = (surface.merged(lambda vs: [end(units[v][s] for v in vs) for s in range(3)],
                                              lambda a, b: list(map(end, a, b))) for end in (min, max))
        self.intervals = [None] * len(surface.children)  # per BV: nodes ascending, l, h in units of 2^-53
        held = [None] * len(surface.children)
        for i in range(len(held) - 1, -1, -1):
            if surface.children[i]:
                a, b = surface.children[i]
                held[i], held[a], held[b] = self.union(held[a], held[b]), None, None
            else:
                first, *others = ({j: (u, u) for j, u, _ in surface.rows[v]} for v in surface.corners[i])
                for other in others:
                    first = self.union(first, other)
                held[i] = first
            nodes = sorted(held[i])
            low, high = (array.array("q", (held[i][j][end] for j in nodes)) for end in (0, 1))
            self.intervals[i] = array.array("L", nodes), low, high

    @staticmethod
    def union(a, b):
        """Of weight intervals; a simulation node that misses a vertex has weight 0 there."""
        out = {}
        for j, (l, h) in a.items():
            other = b.get(j)
            out[j] = (min(l, other[0]), max(h, other[1])) if other else (0, h)
        for j, (_, h) in b.items():
            if j not in a:
                out[j] = (0, h)
        return out
