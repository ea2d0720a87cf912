# SPDX-License-Identifier: GPL-3.0-or-later
"""engine_test.py CINCH [SHARED]: what an engine in binary32 renders lies within the bounds of `cinch bake --engine
float32 --nlerp`, and not always within those that are not asked for that."""
import json, math, os, random, struct, subprocess, sys, tempfile

from made_characters import Maker, face, turn, wave
from sampled_character import Character, slerp

program, shared = sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else ""
draw = random.Random(7)
rounded = lambda x: struct.unpack("f", struct.pack("f", x))[0]


def nlerp(a, b, s):
    if sum(x * y for x, y in zip(a, b)) < 0:
        b = [-x for x in b]
    q = [(1 - s) * x + s * y for x, y in zip(a, b)]
    size = math.sqrt(sum(x * x for x in q))
    return [x / size for x in q]


def other_way(a, b, s):
    """Where rounding decides which way half a turn goes, either."""
    if abs(sum(x * y for x, y in zip(a, b))) < 1e-7 and draw.random() < 0.5:
        b = [-x for x in b]
        size, other = (math.sqrt(sum(x * x for x in q)) for q in (a, b))
        angle = math.acos(sum(x * y for x, y in zip(a, b)) / size / other)
        return [math.sin((1 - s) * angle) * x / size + math.sin(s * angle) * y / other for x, y in zip(a, b)]
    return slerp(a, b, s)


def sum_of(terms, fused):
    """Of products, in binary32, in the order in which they stand."""
    total = 0.0
    for a, b in terms:
        total = rounded(total + a * b) if fused else rounded(total + rounded(a * b))
    return total


def rendered(character, channels, t, interpolation):
    """Vertices as an engine may place them: joint matrices rounded once, weights as stored, sums in any order."""
    for (_, _, positions, indices, weights, _, targets, _), amount, maps in character.posed(channels, t, interpolation):
        maps = [[[rounded(x) for x in row] for row in m] for m in maps]
        amount = [rounded(a) for a in amount]
        for k, (p, index, weight) in enumerate(zip(positions, indices, weights)):
            fused, blends = draw.random() < 0.5, draw.random() < 0.5
            shuffled = lambda terms: draw.sample(terms, len(terms))
            p = [sum_of([(1.0, rounded(x))] + shuffled([(a, rounded(g[k][r])) for a, g in zip(amount, targets)]), fused)
                 for r, x in enumerate(p)]
            parts = shuffled([(rounded(w), maps[i]) for i, w in zip(index, weight) if w])
            if blends:
                m = [[sum_of([(w, one[r][c]) for w, one in parts], fused) for c in range(4)] for r in range(3)]
                yield [sum_of(shuffled(list(zip(m[r], p + [1.0]))), fused) for r in range(3)]
            else:
                places = [[sum_of(shuffled(list(zip(one[r], p + [1.0]))), fused) for r in range(3)] for _, one in parts]
                yield [sum_of([(w, place[r]) for (w, _), place in zip(parts, places)], fused) for r in range(3)]


def outside(name, options, interpolation, times):
    """How far rendered vertices leave the bounds, as a share of the greatest extent."""
    made = subprocess.run([program, "bake", name, "--json", *options], capture_output=True, text=True)
    assert made.returncode == 0, made.stderr
    boxes, character, worst = [json.loads(line) for line in made.stdout.splitlines()], Character(name), 0.0
    for clip, channels in character.clips():
        mine = [b for b in boxes if b["clip"] == clip]
        size = max(h - l for b in mine for l, h in zip(b["min"], b["max"]))
        for _ in range(times):
            t = draw.choice((draw.uniform(mine[0]["t0"], mine[-1]["t1"]), draw.choice(mine)["t0"]))
            for v in rendered(character, channels, t, interpolation):
                for b in mine:
                    if b["t0"] <= t <= b["t1"]:
                        for l, x, h in zip(b["min"], v, b["max"]):
                            worst = max(worst, (l - x) / size, (x - h) / size)
    return worst


def chain(folder):
    """A plate far out on two bones that turn, its weights stored so that they sum to 0.9."""
    make = Maker()
    position = make.add([(40, 0, 0), (41, 0, 0), (40, 1, 0.5)], "VEC3")
    joints, weights = make.add([(1, 0, 0, 0)] * 3, "VEC4", 5121), make.add([(0.5, 0.4, 0, 0)] * 3, "VEC4")
    times = make.add([(0.0,), (1.0,), (2.0,)], "SCALAR")
    first = make.add([turn(0), turn(2.2), turn(0.3)], "VEC4")
    second = make.add([turn(1), turn(-1.4), turn(1.2)], "VEC4")
    return make.write(folder, "chain.gltf", {
        "scenes": [{"nodes": [0, 2]}],
        "nodes": [{"children": [1]}, {"translation": [30, 0, 0]}, {"mesh": 0, "skin": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": position, "JOINTS_0": joints, "WEIGHTS_0": weights}}]}],
        "skins": [{"joints": [0, 1]}],
        "animations": [{"name": "turn", "samplers": [{"input": times, "output": first},
                                                     {"input": times, "output": second}],
                        "channels": [{"sampler": 0, "target": {"node": 0, "path": "rotation"}},
                                     {"sampler": 1, "target": {"node": 1, "path": "rotation"}}]}]})


def plate(folder, name="plate.gltf", second=(turn(0.4), turn(-1.7)), link=30):
    """The corners of a box, without a skin: bounds by its joint are as tight as can be."""
    make = Maker()
    corners = [(40 + i % 2, i // 2 % 2, i // 4 / 2) for i in range(8)]
    position = make.add([corners[i % 8] for i in range(9)], "VEC3")
    times, key = make.add([(0.0,), (1.0,)], "SCALAR"), make.add([turn(0), turn(2.2)], "VEC4")
    other = make.add(second, "VEC4")
    return make.write(folder, name, {
        "scenes": [{"nodes": [0]}], "nodes": [{"children": [1]}, {"mesh": 0, "translation": [link, 0, 0]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": position}}]}],
        "animations": [{"name": "turn", "samplers": [{"input": times, "output": key},
                                                     {"input": times, "output": other}],
                        "channels": [{"sampler": 0, "target": {"node": 0, "path": "rotation"}},
                                     {"sampler": 1, "target": {"node": 1, "path": "rotation"}}]}]})


# The constant of EngineError::of_turn.
greatest = max(abs(math.atan2(s * math.sin(p), 1 - s + s * math.cos(p)) - s * p) / p**3
               for p in (math.pi / 2 * i / 400 for i in range(1, 401)) for s in (j / 400 for j in range(401)))
assert 0.0183 < greatest <= 0.0185, greatest

with tempfile.TemporaryDirectory() as folder:
    short = ["--interval", "0.04", "--precision", "double"]
    flat, skinned = plate(folder), chain(folder)
    assert outside(flat, short, slerp, 300) > 1e-9, "rounding to binary32 is not felt"
    assert outside(flat, [*short, "--engine", "float32"], slerp, 300) <= 0
    assert outside(flat, [*short, "--engine", "float32"], nlerp, 300) > 1e-4, "nlerp is not felt"
    assert outside(flat, [*short, "--engine", "float32", "--nlerp"], nlerp, 300) <= 0
    assert outside(flat, [*short, "--engine", "float32", "--nlerp"], slerp, 300) <= 0
    half = plate(folder, "half.gltf", [turn(0.4), turn(0.4 + math.pi - 1e-8)])
    assert outside(half, short, other_way, 100) > 0.01, "the other way is not felt"
    assert outside(half, [*short, "--engine", "float32"], other_way, 100) <= 0
    long = plate(folder, "long.gltf", [[3 * x for x in turn(0.4)], turn(-1.7)])  # their lengths count in a sum
    assert outside(long, [*short, "--engine", "float32", "--nlerp"], nlerp, 300) <= 0
    assert outside(skinned, short, slerp, 100) > 0.01, "weights as stored are not felt"
    for name in (skinned, wave(folder), face(folder)):
        assert outside(name, ["--engine", "float32", "--nlerp"], nlerp, 60) <= 0, name
        assert outside(name, ["--engine", "float32"], slerp, 60) <= 0, name
    for options in (["--engine", "half"], ["--joint-error", "-1"]):
        assert subprocess.run([program, "bake", flat, *options], capture_output=True).returncode == 2, options
    assert subprocess.run([program, "bake", "fish", "--nlerp"], capture_output=True).returncode == 2
    # A joint error widens by as much as is said of the lengths of a chain, and a box by less than four times that.
    fine = ["--whole", "--tolerance", "1e-5", "--precision", "double", "--json"]
    for link in (30, 500):
        name = plate(folder, "link.gltf", link=link)
        boxes = [json.loads(subprocess.run([program, "bake", name, *fine, *more], capture_output=True,
                                           text=True).stdout.splitlines()[0])
                 for more in ([], ["--joint-error", "1e-3"])]
        wider, chain_of = [b - a for a, b in zip(*(box["max"] for box in boxes))], 1e-3 * (link + 41)
        assert all(0.98 * chain_of <= x <= 4 * chain_of for x in wider), (link, wider)
for name in ("CesiumMan.glb", "Fox.glb"):
    path = os.path.join(shared, "meshes", "skin", name)
    if os.path.isfile(path):
        assert outside(path, ["--whole", "--engine", "float32", "--nlerp"], nlerp, 4) <= 0, name
    else:
        print("%s is missing; it was left out" % name)
