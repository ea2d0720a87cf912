# SPDX-License-Identifier: GPL-3.0-or-later
"""bake_test.py CINCH [SHARED]: the boxes of `cinch bake` against a reader and sampler of glTF of its own, written from
the specification: dense samples of every clip must lie inside, and reach nearly as far."""
import ast, base64, json, math, os, re, struct, subprocess, sys, tempfile, zipfile

program, shared = sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else ""
FORMATS = {5120: ("b", 127), 5121: ("B", 255), 5122: ("h", 32767), 5123: ("H", 65535), 5125: ("I", 0), 5126: ("f", 0)}
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


def value_at(times, values, mode, path, t):
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
        return slerp(key(i), key(i + 1), s)
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
                self.parts.append((skin["joints"], binds, positions, joints, weights, i, targets, still))

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

    def vertices(self, channels, t):
        local = {}
        moved = {}
        for node, path, times, values, mode in channels:
            moved.setdefault(node, {})[path] = value_at(times, values, mode, path, t)
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

        for joints, binds, positions, indices, weights, node, targets, still in self.parts:
            amount = moved.get(node, {}).get("weights", still)
            maps = [product(world_of(node), [[b[4 * c + r] for c in range(4)] for r in range(4)])
                    for node, b in zip(joints, binds)]
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


class Maker:
    """The buffer of a document, accessor by accessor."""

    def __init__(self):
        self.data, self.views, self.accessors = b"", [], []

    def view(self, rows, letter):
        raw = b"".join(struct.pack("<%d%s" % (len(r), letter), *r) for r in rows)
        self.views.append({"buffer": 0, "byteOffset": len(self.data), "byteLength": len(raw)})
        self.data += raw + b"\0" * (-len(raw) % 4)
        return len(self.views) - 1

    def add(self, rows, kind, component=5126):
        self.accessors.append({"bufferView": self.view(rows, FORMATS[component][0]), "componentType": component,
                               "count": len(rows), "type": kind})
        if kind == "VEC3" and component == 5126:
            self.accessors[-1].update(min=[min(c) for c in zip(*rows)], max=[max(c) for c in zip(*rows)])
        return len(self.accessors) - 1

    def sparse(self, count, places, rows):
        self.accessors.append({"componentType": 5126, "count": count, "type": "VEC3", "sparse": {
            "count": len(places), "indices": {"bufferView": self.view([(i,) for i in places], "H"),
                                              "componentType": 5123},
            "values": {"bufferView": self.view(rows, "f")}}})
        return len(self.accessors) - 1

    def write(self, folder, name, document):
        document = {"asset": {"version": "2.0"}, "scene": 0, **document,
                    "buffers": [{"byteLength": len(self.data), "uri": "data:application/octet-stream;base64," +
                                 base64.b64encode(self.data).decode()}],
                    "bufferViews": self.views, "accessors": self.accessors}
        name = os.path.join(folder, name)
        json.dump(document, open(name, "w"))
        return name


turn = lambda a: (0, 0, math.sin(a / 2), math.cos(a / 2))


def wave(folder):
    """Three bones in a chain, one of each interpolation, and a strip along them."""
    make = Maker()
    n = 30
    positions = make.add([(x % 2 * 0.2, x * 0.1, 0.1 * math.sin(x)) for x in range(n)], "VEC3")
    joints = make.add([(min(x // 10, 2), min(x // 10 + 1, 2), 0, 0) for x in range(n)], "VEC4", 5121)
    weights = make.add([(1 - x % 10 / 20, x % 10 / 20, 0, 0) for x in range(n)], "VEC4")
    indices = make.add([(i,) for x in range(n - 2) for i in (x, x + 1, x + 2)], "SCALAR", 5123)
    binds = make.add([(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -b, 0, 1) for b in range(3)], "MAT4")
    times = make.add([(0.0,), (0.4,), (1.0,)], "SCALAR")
    linear = make.add([turn(0), turn(2.5), turn(-1)], "VEC4")
    zero = (0, 0, 0, 0)
    cubic = make.add([zero, turn(0), (0, 0, 2, 0), zero, turn(1.5), zero, (0, 1, 0, 0), turn(0.5), zero], "VEC4")
    step = make.add([(0, 1, 0), (0.5, 1.2, 0), (0, 0.8, 0.3)], "VEC3")
    samplers = [{"input": times, "output": linear}, {"input": times, "output": cubic, "interpolation": "CUBICSPLINE"},
                {"input": times, "output": step, "interpolation": "STEP"}]
    return make.write(folder, "wave.gltf", {
        "scenes": [{"nodes": [0, 3]}],
        "nodes": [{"children": [1]}, {"children": [2], "translation": [0, 1, 0]}, {"translation": [0, 1, 0]},
                  {"mesh": 0, "skin": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": positions, "JOINTS_0": joints, "WEIGHTS_0": weights},
                                    "indices": indices}]}],
        "skins": [{"joints": [0, 1, 2], "inverseBindMatrices": binds}],
        "animations": [{"name": "wave", "samplers": samplers, "channels": [
            {"sampler": 0, "target": {"node": 0, "path": "rotation"}},
            {"sampler": 1, "target": {"node": 1, "path": "rotation"}},
            {"sampler": 2, "target": {"node": 2, "path": "translation"}}]}]})


def face(folder, name="face.gltf"):
    """A skinned sheet with three morph targets, one of them sparse, whose weights move in each way; the same mesh again
    with weights of its own; a mesh without a skin, twice, one of them shrinking to nothing; and one that morphs."""
    make = Maker()
    n = 6
    grid = [(x * 0.2, y * 0.2, 0.05 * math.sin(x * y)) for y in range(n) for x in range(n)]
    triangles = [(i,) for y in range(n - 1) for x in range(n - 1)
                 for i in (y * n + x, y * n + x + 1, y * n + n + x, y * n + x + 1, y * n + n + x + 1, y * n + n + x)]
    positions, indices = make.add(grid, "VEC3"), make.add(triangles, "SCALAR", 5123)
    joints = make.add([(0, 1, 0, 0)] * len(grid), "VEC4", 5121)
    weights = make.add([(1 - x / 1.0, x / 1.0, 0, 0) for x, _, _ in grid], "VEC4")
    binds = make.add([(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -b, 0, 0, 1) for b in range(2)], "MAT4")
    open_ = make.add([(0, -0.3 * y, 0.1) if y < 0.5 else (0, 0, 0) for _, y, _ in grid], "VEC3")
    smile = make.sparse(len(grid), [0, 5, 7, 30], [(-0.1, 0.2, 0), (0.1, 0.2, 0), (0.3, -0.3, 0.2), (0, 0, 1)])
    puff = make.add([(0, 0, 0.4 * math.exp(-4 * ((x - 0.5)**2 + (y - 0.5)**2))) for x, y, _ in grid], "VEC3")
    targets = [{"POSITION": open_}, {"POSITION": smile}, {"POSITION": puff}]
    times, later = make.add([(0.0,), (0.5,), (1.25,)], "SCALAR"), make.add([(0.2,), (0.9,)], "SCALAR")
    linear = make.add([(w,) for w in (0, 0, 0, 1, -0.5, 0.2, 0.3, 1, 2)], "SCALAR")
    cubic = make.add([(w,) for w in (0, 0, 0, 0, 0.5, 0, 3, -2, 1, -4, 0, 2, 1, 0, 0.7, 0, 0, 0)], "SCALAR")
    step = make.add([(w,) for w in (0.1, 0, 1, 0.9, 1, -1)], "SCALAR")
    nod = make.add([turn(0), turn(1.2), turn(-0.7)], "VEC4")
    shrink = make.add([(1, 1, 1), (2, 0.5, 1), (0, 0, 0)], "VEC3")
    spin = make.add([(0, 0, 0, 1), (0.9, 0.1, 0, 0.2)], "VEC4")
    samplers = [{"input": times, "output": linear}, {"input": later, "output": cubic, "interpolation": "CUBICSPLINE"},
                {"input": later, "output": step, "interpolation": "STEP"}, {"input": times, "output": nod},
                {"input": times, "output": shrink}, {"input": later, "output": spin}]
    skinned = {"attributes": {"POSITION": positions, "JOINTS_0": joints, "WEIGHTS_0": weights}, "indices": indices}
    plain = {"attributes": {"POSITION": positions}, "indices": indices}
    pointer = lambda p: {"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": p}}}
    return make.write(folder, name, {
        "extensionsUsed": ["KHR_animation_pointer"],
        "scenes": [{"nodes": [0, 2, 3, 4, 7]}],
        "nodes": [{"children": [1]}, {"translation": [1, 0, 0]}, {"mesh": 0, "skin": 0},
                  {"mesh": 0, "skin": 0, "weights": [0, 0.25, 0.5]},
                  {"children": [5, 6], "translation": [0, 2, 0]}, {"mesh": 1, "scale": [0.5, 1, 2]},
                  {"mesh": 1, "translation": [0, 1, 1], "rotation": [0.5, 0.5, 0.5, 0.5]},
                  {"mesh": 2, "matrix": [0, 2, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 3, 0, 0, 1]}],
        "meshes": [{"primitives": [{**skinned, "targets": targets}]}, {"primitives": [plain]},
                   {"primitives": [{**plain, "targets": [{"NORMAL": open_}, {"POSITION": puff}]}],
                    "weights": [1, 0.5]}],
        "skins": [{"joints": [0, 1], "inverseBindMatrices": binds}],
        "animations": [{"name": "talk", "samplers": samplers, "channels": [
            {"sampler": 0, "target": {"node": 2, "path": "weights"}},
            {"sampler": 3, "target": {"node": 1, "path": "rotation"}},
            {"sampler": 4, "target": {"node": 5, "path": "scale"}},
            {"sampler": 5, "target": pointer("/nodes/4/rotation")}]},
            {"name": "shout", "samplers": samplers, "channels": [
                {"sampler": 1, "target": {"node": 2, "path": "weights"}},
                {"sampler": 2, "target": pointer("/nodes/3/weights")},
                {"sampler": 3, "target": {"node": 0, "path": "rotation"}}]}]})


def check(name, samples):
    character = Character(name)
    made = subprocess.run([program, "bake", name, "--json"], capture_output=True, text=True)
    assert made.returncode == 0, made.stderr
    boxes = [json.loads(line) for line in made.stdout.splitlines()]
    worst, looseness = 0.0, 0.0
    for clip, channels in character.clips():
        mine = [b for b in boxes if b["clip"] == clip and b["bv"] == 0]
        assert mine, "no box of clip '%s'" % clip
        for a, b in zip(mine, mine[1:]):
            assert a["t1"] == b["t0"], "clip '%s' has a gap at %r" % (clip, a["t1"])
        keys = sorted({t for c in channels for t in c[2]})
        assert mine[0]["t0"] <= keys[0] and mine[-1]["t1"] >= keys[-1], "clip '%s' is not covered" % clip
        times = [a + (b - a) * i / samples for a, b in zip(keys, keys[1:]) for i in range(samples)] + [keys[-1]]
        truth = [[math.inf] * 3, [-math.inf] * 3]
        for t in times:
            for v in character.vertices(channels, t):
                for box in mine:
                    if box["t0"] <= t <= box["t1"]:
                        size = max(h - l for l, h in zip(box["min"], box["max"]))
                        for l, x, h in zip(box["min"], v, box["max"]):
                            worst = max(worst, (l - x) / size, (x - h) / size)
                truth = [list(map(min, truth[0], v)), list(map(max, truth[1], v))]
        whole = [min(b["min"][i] for b in mine) for i in range(3)], [max(b["max"][i] for b in mine) for i in range(3)]
        looseness = max(looseness, math.dist(*whole) / math.dist(*truth))
    print("%s: %d boxes, %.3g outside at most, %.3f of the truth" % (os.path.basename(name), len(boxes), worst,
                                                                     looseness))
    assert worst <= 1e-12, "%s: a sample is %g of the box outside" % (name, worst)
    assert looseness < 1.5, "%s: the boxes are %.3f times as large as the truth" % (name, looseness)


with tempfile.TemporaryDirectory() as folder:
    for made, kinds in ((face(folder), ("no-remainder", "half-bump", "first-half", "still-morphs")),
                        (wave(folder), ("no-remainder", "half-bump", "first-half"))):
        check(made, 100)
        prove = ["bake", made, "--whole", "--level", "-1", "--leaf", "2", "--prove"]
        for kdop in ("6", "18"):
            right = subprocess.run([program, *prove, "--kdop", kdop], capture_output=True, text=True)
            assert right.returncode == 0 and ", 0 violated\n" in right.stdout and "undecided" not in right.stdout, \
                right.stdout + right.stderr
        for kind in kinds:
            wrong = subprocess.run([program, *prove, "--sabotage", kind], capture_output=True, text=True)
            assert wrong.returncode == 1, "%s is not found: %s" % (kind, wrong.stdout)
    # A page of a character with morph targets has bounds for all times and no others, over all of its frames.
    shown = json.loads(subprocess.run([program, "view", os.path.join(folder, "face.gltf"), "--swept", "--json"],
                                      capture_output=True, text=True).stdout.splitlines()[0])["view"]
    assert list(shown["bounds"]) == ["all times"] and len(shown["time_s"]) == 60, shown.keys()
    npz = os.path.join(folder, "wave.npz")
    assert subprocess.run([program, "bake", made, "--level", "-1", "--npz", npz, "--usd", npz + ".usda"],
                          capture_output=True).returncode == 0
    def array(bytes_):
        assert bytes_[:8] == b"\x93NUMPY\x01\x00"
        length = struct.unpack_from("<H", bytes_, 8)[0]
        head = ast.literal_eval(bytes_[10:10 + length].decode())
        count = math.prod(head["shape"])
        return head["shape"], struct.unpack_from("<%d%s" % (count, {"<f8": "d", "<u4": "I"}[head["descr"]]), bytes_,
                                                 10 + length)
    rows = [json.loads(x) for x in subprocess.run([program, "bake", made, "--level", "-1", "--json"],
                                                  capture_output=True, text=True).stdout.splitlines()]
    with zipfile.ZipFile(npz) as archive:
        assert archive.testzip() is None
        (bvs,), levels = array(archive.read("level.npy"))
        _, times = array(archive.read("wave/times.npy"))
        shape, bounds = array(archive.read("wave/bounds.npy"))
    assert shape == (len(times) // 2, bvs, 2, 3) and len(rows) == shape[0] * bvs, shape
    for n, row in enumerate(rows):
        assert list(bounds[6 * n:6 * n + 6]) == row["min"] + row["max"], row
        assert levels[row["bv"]] == row["level"] and times[n // bvs * 2] == row["t0"], row
    text = open(npz + ".usda").read()
    samples = re.findall(r"([-0-9.e+]+): \[\(([^)]*)\), \(([^)]*)\)\]", text)
    assert text.startswith("#usda 1.0\n") and len(samples) == shape[0] + 1, text
    for row in rows:
        if row["bv"] == 0:  # both ends of an interval hold it, so every mixture of them does
            ends = [s for s in samples if float(s[0]) in (row["t0"], row["t1"])]
            assert len(ends) == 2, row
            for _, low, high in ends:
                assert all(float(x) < y for x, y in zip(low.split(","), row["min"])), row
                assert all(float(x) > y for x, y in zip(high.split(","), row["max"])), row
    shape_ = subprocess.run([program, "bake", "fish", "--whole"], capture_output=True, text=True, timeout=120)
    assert shape_.returncode == 0 and "(" in shape_.stdout, shape_.stderr
    # What is interpolated between frames is proven too.
    frames = ["bake", "fish", "--whole", "--leaf", "64", "--level", "-1", "--prove"]
    right = subprocess.run([program, *frames], capture_output=True, text=True)
    assert right.returncode == 0 and ", 0 violated\n" in right.stdout, right.stdout + right.stderr
skins = os.path.join(shared, "meshes", "skin")
if os.path.isdir(skins):
    for name in sorted(os.listdir(skins)):
        if name.endswith(".glb") and name != "robot.glb":  # which takes this reader minutes
            check(os.path.join(skins, name), 3)
else:
    print("the shared characters are missing; they were left out")
