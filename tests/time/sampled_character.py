# SPDX-License-Identifier: GPL-3.0-or-later
"""A reader and sampler of glTF of its own, written from the specification: where vertices are at a time."""
import base64, json, math, os, struct

from made_characters import FORMATS

COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}


class File:
    def __init__(self, name):
        data = open(name, "rb").read()
        self.chunk = b""
        if data[:4] == b"glTF":
            length = struct.unpack_from("<I", data, 12)[0]
            self.json, at = json.loads(data[20:20 + length]), 20 + length
            if at < len(data):
                self.chunk = data[at + 8:at + 8 + struct.unpack_from("<I", data, at)[0]]
        else:
            self.json = json.loads(data)
        self.buffers = [
            base64.b64decode(b["uri"].split(",", 1)[1]) if b.get("uri", "").startswith("data:") else
            open(os.path.join(os.path.dirname(name), b["uri"]), "rb").read() if "uri" in b else self.chunk
            for b in self.json["buffers"]]

    def elements(self, holder, component, n, count, normalized=False):
        view = self.json["bufferViews"][holder["bufferView"]]
        letter, scale = FORMATS[component]
        stride = view.get("byteStride") or n * struct.calcsize(letter)
        start = view.get("byteOffset", 0) + holder.get("byteOffset", 0)
        rows = [struct.unpack_from("<%d%s" % (n, letter), self.buffers[view["buffer"]], start + i * stride)
                for i in range(count)]
        return [tuple(max(x / scale, -1.0) for x in row) for row in rows] if normalized else rows

    def accessor(self, index):
        a = self.json["accessors"][index]
        n, normalized = COMPONENTS[a["type"]], a.get("normalized", False)
        rows = (self.elements(a, a["componentType"], n, a["count"], normalized) if "bufferView" in a else
                [(0.0,) * n] * a["count"])
        if "sparse" in a:
            sparse, rows = a["sparse"], list(rows)
            places = self.elements(sparse["indices"], sparse["indices"]["componentType"], 1, sparse["count"])
            values = self.elements(sparse["values"], a["componentType"], n, sparse["count"], normalized)
            for (i,), value in zip(places, values):
                rows[i] = value
        return rows


def matrix_of(t, q, s):
    x, y, z, w = q
    n = x * x + y * y + z * z + w * w
    f = 2 / n if n else 0
    r = [[1 - f * (y * y + z * z), f * (x * y - z * w), f * (x * z + y * w)],
         [f * (x * y + z * w), 1 - f * (x * x + z * z), f * (y * z - x * w)],
         [f * (x * z - y * w), f * (y * z + x * w), 1 - f * (x * x + y * y)]]
    return [[r[i][j] * s[j] for j in range(3)] + [t[i]] for i in range(3)] + [[0, 0, 0, 1]]


def product(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(4)) for j in range(4)] for i in range(4)]


def slerp(a, b, s):
    la, lb = math.sqrt(sum(x * x for x in a)), math.sqrt(sum(x * x for x in b))
    a, b = [x / la for x in a], [x / lb for x in b]
    d = sum(x * y for x, y in zip(a, b))
    if d < 0:
        b, d = [-x for x in b], -d
    angle = math.acos(min(d, 1.0))
    if angle < 1e-6:
        return [(1 - s) * x + s * y for x, y in zip(a, b)]
    return [(math.sin((1 - s) * angle) * x + math.sin(s * angle) * y) / math.sin(angle) for x, y in zip(a, b)]


def value_at(times, values, mode, path, t, turn=slerp):
    cubic = mode == "CUBICSPLINE"
    key = lambda i: values[3 * i + 1] if cubic else values[i]
    if t <= times[0]:
        return key(0)
    if t >= times[-1]:
        return key(len(times) - 1)
    i = max(n for n in range(len(times)) if times[n] <= t)
    if mode == "STEP":
        return key(i)
    d = times[i + 1] - times[i]
    s = (t - times[i]) / d
    if cubic:
        out, into = values[3 * i + 2], values[3 * i + 3]
        return [(2 * s**3 - 3 * s**2 + 1) * p + d * (s**3 - 2 * s**2 + s) * m + (3 * s**2 - 2 * s**3) * q
                + d * (s**3 - s**2) * n for p, m, q, n in zip(key(i), out, key(i + 1), into)]
    if path == "rotation":
        return turn(key(i), key(i + 1), s)
    return [(1 - s) * p + s * q for p, q in zip(key(i), key(i + 1))]


class Character:
    def __init__(self, name):
        self.file = File(name)
        j = self.file.json
        self.nodes, self.parent = j["nodes"], {}
        for i, node in enumerate(self.nodes):
            for child in node.get("children", []):
                self.parent[child] = i
        self.parts = []
        for i, node in enumerate(self.nodes):
            if "mesh" not in node:
                continue
            identity = (1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1)
            skin = j["skins"][node["skin"]] if "skin" in node else {"joints": [i]}  # a rigid part
            binds = (self.file.accessor(skin["inverseBindMatrices"]) if "inverseBindMatrices" in skin else
                     [identity] * len(skin["joints"]))
            places = node.get("extensions", {}).get("EXT_mesh_gpu_instancing", {}).get("attributes")
            places = [(skin["joints"], binds)] if places is None else [
                (skin["joints"], [[m[r][c] for c in range(4) for r in range(4)]]) for m in self.instances(places)]
            mesh = j["meshes"][node["mesh"]]
            for primitive in mesh["primitives"]:
                at = primitive["attributes"]
                positions = self.file.accessor(at["POSITION"])
                one = [(0, 0, 0, 0)] * len(positions), [(1, 0, 0, 0)] * len(positions)
                joints, weights = ((self.file.accessor(at["JOINTS_0"]), self.file.accessor(at["WEIGHTS_0"]))
                                   if "skin" in node else one)
                targets = [self.file.accessor(t["POSITION"]) if "POSITION" in t else [(0, 0, 0)] * len(positions)
                           for t in primitive.get("targets", [])]
                still = node.get("weights", mesh.get("weights", [0] * len(targets)))
                for nodes, binds in places:
                    self.parts.append((nodes, binds, positions, joints, weights, i, targets, still))

    def instances(self, attributes):
        """The matrices of the places at which a mesh is drawn, in the space of its node."""
        given = [(self.file.accessor(attributes[name]) if name in attributes else None, default) for name, default in
                 (("TRANSLATION", (0, 0, 0)), ("ROTATION", (0, 0, 0, 1)), ("SCALE", (1, 1, 1)))]
        count = max(len(rows) for rows, _ in given if rows)
        return [matrix_of(*(rows[i] if rows else default for rows, default in given)) for i in range(count)]

    def clips(self):
        out = []
        for i, animation in enumerate(self.file.json.get("animations", [])):
            channels = []
            for channel in animation["channels"]:
                sampler = animation["samplers"][channel["sampler"]]
                target = channel["target"]
                if target["path"] == "pointer":
                    node, path = target["extensions"]["KHR_animation_pointer"]["pointer"].split("/")[2:]
                else:
                    node, path = target["node"], target["path"]
                times = [t[0] for t in self.file.accessor(sampler["input"])]
                values, mode = self.file.accessor(sampler["output"]), sampler.get("interpolation", "LINEAR")
                if path == "weights":  # a scalar for each target, key after key
                    per = len(times) * (3 if mode == "CUBICSPLINE" else 1)
                    count = len(values) // per
                    values = [tuple(v[0] for v in values[k * count:(k + 1) * count]) for k in range(per)]
                channels.append((int(node), path, times, values, mode))
            out.append((animation.get("name") or "anim%d" % i, channels))
        return out

    def posed(self, channels, t, turn=slerp):
        """Parts with the weights of their targets and the matrices of their joints; `turn`: between rotations."""
        local = {}
        moved = {}
        for node, path, times, values, mode in channels:
            moved.setdefault(node, {})[path] = value_at(times, values, mode, path, t, turn)
        for i, node in enumerate(self.nodes):
            if "matrix" in node and not {"translation", "rotation", "scale"} & set(moved.get(i, {})):
                m = node["matrix"]
                local[i] = [[m[4 * c + r] for c in range(4)] for r in range(4)]
            else:
                now = {**node, **moved.get(i, {})}
                local[i] = matrix_of(now.get("translation", (0, 0, 0)), now.get("rotation", (0, 0, 0, 1)),
                                     now.get("scale", (1, 1, 1)))
        world = {}

        def world_of(i):
            if i not in world:
                world[i] = product(world_of(self.parent[i]), local[i]) if i in self.parent else local[i]
            return world[i]

        for part in self.parts:
            joints, binds, _, _, _, node, _, still = part
            yield part, moved.get(node, {}).get("weights", still), [
                product(world_of(node), [[b[4 * c + r] for c in range(4)] for r in range(4)])
                for node, b in zip(joints, binds)]

    def vertices(self, channels, t, amount_of=None):
        """`amount_of`: draws the weight of a morph target, whatever the clip says."""
        for (_, _, positions, indices, weights, _, targets, _), amount, maps in self.posed(channels, t):
            if amount_of:
                amount = [amount_of() for _ in targets]
            for k, (p, index, weight) in enumerate(zip(positions, indices, weights)):
                p = [x + sum(a * t[k][r] for a, t in zip(amount, targets)) for r, x in enumerate(p)]
                total = sum(weight)
                v = [0.0, 0.0, 0.0]
                for i, w in zip(index, weight):
                    if w:
                        m = maps[i]
                        for r in range(3):
                            v[r] += w / total * (m[r][0] * p[0] + m[r][1] * p[1] + m[r][2] * p[2] + m[r][3])
                yield v
