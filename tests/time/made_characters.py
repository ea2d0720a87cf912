# SPDX-License-Identifier: GPL-3.0-or-later
"""Characters in glTF that use what is rare in files: every interpolation, sparse targets, pointers, parts without a
skin."""
import base64, json, math, os, struct

FORMATS = {5120: ("b", 127), 5121: ("B", 255), 5122: ("h", 32767), 5123: ("H", 65535), 5125: ("I", 0), 5126: ("f", 0)}


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


def crowd(folder):
    """A mesh that a turning node draws at five places, with morph targets; and once more where it is given alone."""
    make = Maker()
    positions = make.add([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0.2, 0.2, 0.7)], "VEC3")
    indices = make.add([(i,) for i in (0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3)], "SCALAR", 5123)
    grow = make.add([(0, 0, 0), (0.4, 0, 0), (0, -0.3, 0), (0, 0, 0.5)], "VEC3")
    places = make.add([(2 * i, i % 2, 0.3 * i) for i in range(5)], "VEC3")
    turns = make.add([turn(0.7 * i) for i in range(5)], "VEC4")
    sizes = make.add([(1 + 0.2 * i, 1, 0.5) for i in range(5)], "VEC3")
    times = make.add([(0.0,), (1.0,)], "SCALAR")
    samplers = [{"input": times, "output": make.add([turn(0), turn(2.5)], "VEC4")},
                {"input": times, "output": make.add([(0.0,), (1.0,)], "SCALAR")}]
    instanced = {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": places, "ROTATION": turns,
                                                            "SCALE": sizes}}}
    return make.write(folder, "crowd.gltf", {
        "extensionsUsed": list(instanced), "extensionsRequired": list(instanced),
        "scenes": [{"nodes": [0, 2]}],
        "nodes": [{"children": [1], "rotation": [0, 0.6, 0, 0.8]}, {"mesh": 0, "extensions": instanced},
                  {"mesh": 0, "translation": [-3, 0, 0]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": positions}, "indices": indices,
                                    "targets": [{"POSITION": grow}]}]}],
        "animations": [{"name": "turn", "samplers": samplers, "channels": [
            {"sampler": 0, "target": {"node": 0, "path": "rotation"}},
            {"sampler": 1, "target": {"node": 1, "path": "weights"}}]}]})


def many_clips(folder, clips):
    """A bent strip on one joint with clips of their own lengths."""
    make = Maker()
    position = make.add([(4 + i % 2, i * 0.05, math.sin(i)) for i in range(300)], "VEC3")
    animations = []
    for i in range(clips):
        times = make.add([(0.1 * i,), (0.5 + 0.2 * i,), (2.0 + 0.3 * i,)], "SCALAR")
        keys = make.add([turn(0), turn(0.3 + i), turn(-0.2 * i)], "VEC4")
        animations.append({"name": "turn %d" % i, "samplers": [{"input": times, "output": keys}],
                           "channels": [{"sampler": 0, "target": {"node": 0, "path": "rotation"}}]})
    return make.write(folder, "clips.gltf", {
        "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": position}}]}], "animations": animations})


def through_zero(folder):
    """A spline of rotations that passes 0, where no rotation is: nothing bounds it."""
    make, zero = Maker(), (0, 0, 0, 0)
    position = make.add([(5, 0, 0), (5, 1, 0), (5, 0, 1)], "VEC3")
    times = make.add([(0.0,), (1.0,)], "SCALAR")
    keys = make.add([zero, (0, 0, 0, 1), zero, zero, (0, 0, 0, -1), zero], "VEC4")
    return make.write(folder, "zero.gltf", {
        "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": position}}]}],
        "animations": [{"name": "turn", "samplers": [{"input": times, "output": keys,
                                                      "interpolation": "CUBICSPLINE"}],
                        "channels": [{"sampler": 0, "target": {"node": 0, "path": "rotation"}}]}]})


def nothing_to_turn_to(folder):
    """A bone whose rotation has a key of 0, which is the identity that no curve turns to, under one that slides; and
    one of keys that differ by far less than a rounding. The slide is half turned by a quaternion whose square is 0 in
    doubles."""
    make = Maker()
    position = make.add([(5, 0, 0), (5, 1, 0), (5, 0, 1)], "VEC3")
    times = make.add([(0.0,), (1.0,), (2.0,)], "SCALAR")
    zero = make.add([turn(math.pi), (0, 0, 0, 0), (0, 0, 0, 1)], "VEC4")
    slide = make.add([(0, 0, 0), (-10, 0, 0), (-10, 3, 0)], "VEC3")
    nearly = make.add([(0, 0, 0, 1), (1e-30, 1e-25, 0, 1), (0, 0, 1e-40, 1)], "VEC4")
    samplers = [{"input": times, "output": output} for output in (zero, slide, nearly)]
    return make.write(folder, "nothing.gltf", {
        "scenes": [{"nodes": [0]}],
        "nodes": [{"children": [1], "rotation": [0, 1e-200, 0, 0]}, {"children": [2]}, {"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": position}}]}],
        "animations": [{"name": "turn", "samplers": samplers, "channels": [
            {"sampler": 0, "target": {"node": 1, "path": "rotation"}},
            {"sampler": 1, "target": {"node": 0, "path": "translation"}},
            {"sampler": 2, "target": {"node": 2, "path": "rotation"}}]}]})


def spin(folder):
    """A tetrahedron that turns and grows at once, about axes of its own, far between keys and under a bone that sways:
    along every direction it is farthest at no key."""
    make = Maker()
    position = make.add([(1, 0.2, 0.1), (-0.7, 0.8, 0), (-0.2, -0.9, 0.6), (0.1, 0.3, -1)], "VEC3")
    index = make.add([(i,) for i in (0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2)], "SCALAR", 5123)
    times = make.add([(0.0,), (0.7,), (1.6,), (2.2,)], "SCALAR")
    about = lambda a, n: (*(math.sin(a / 2) * x / math.hypot(*n) for x in n), math.cos(a / 2))
    turns = make.add([about(0, (1, 0, 0)), about(2.3, (1, 2, -1)), about(3, (-1, 0.5, 2)), about(2.8, (0.2, -1, 1))],
                     "VEC4")
    grows = make.add([(1, 1, 1), (0.6, 1.5, 1.1), (1.6, 0.7, 1), (1, 1.3, 0.5)], "VEC3")
    sways = make.add([about(0.3, (0, 1, 1)), about(1.6, (1, 1, 0)), about(2.4, (-1, 1, 1)), about(0.2, (0, 0, 1))],
                     "VEC4")
    samplers = [{"input": times, "output": output} for output in (turns, grows, sways)]
    return make.write(folder, "spin.gltf", {
        "scenes": [{"nodes": [0]}], "nodes": [{"children": [1]}, {"mesh": 0, "translation": [0.4, 0.1, 0.2]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": position}, "indices": index}]}],
        "animations": [{"name": "spin", "samplers": samplers, "channels": [
            {"sampler": 0, "target": {"node": 1, "path": "rotation"}},
            {"sampler": 1, "target": {"node": 1, "path": "scale"}},
            {"sampler": 2, "target": {"node": 0, "path": "rotation"}}]}]})


def breath(folder):
    """A plate whose two morph targets swell past all keys of theirs, on a bone that turns."""
    make = Maker()
    position = make.add([(1, 0, 0), (0, 1, 0.2), (-1, -0.3, 0)], "VEC3")
    targets = [make.add(rows, "VEC3") for rows in ([(0.5, 0, 1), (0, 0.7, 0), (-0.4, 0, 0.3)],
                                                   [(0, 1, 0), (0.3, 0, -1), (0, -0.5, 0)])]
    times = make.add([(0.0,), (1.0,), (1.9,)], "SCALAR")
    weights = make.add([(w,) for w in (0, 0, 0.1, 0, 5, -3, -4, 2, 0.3, 0.6, -5, 4, 0, 0, 0, 0.2, 0, 0)], "SCALAR")
    turns = make.add([turn(0), turn(1.1), turn(0.4)], "VEC4")
    return make.write(folder, "breath.gltf", {
        "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": position}, "targets": [
            {"POSITION": t} for t in targets]}]}],
        "animations": [{"name": "swell", "samplers": [
            {"input": times, "output": weights, "interpolation": "CUBICSPLINE"}, {"input": times, "output": turns}],
            "channels": [{"sampler": 0, "target": {"node": 0, "path": "weights"}},
                         {"sampler": 1, "target": {"node": 0, "path": "rotation"}}]}]})
