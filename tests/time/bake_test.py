# SPDX-License-Identifier: GPL-3.0-or-later
"""bake_test.py CINCH [SHARED]: the boxes of `cinch bake` against a reader and sampler of glTF of its own, written from
the specification: dense samples of every clip must lie inside, and reach nearly as far."""
import ast, json, math, os, pathlib, random, re, struct, subprocess, sys, tempfile, zipfile

from made_characters import crowd, face, wave
from sampled_character import Character

program, shared = sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else ""


def check(name, samples, *options, amount_of=None):
    character = Character(name)
    made = subprocess.run([program, "bake", name, "--json", *options], capture_output=True, text=True)
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
            for v in character.vertices(channels, t, amount_of):
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
                        (crowd(folder), ("no-remainder", "half-bump", "first-half", "still-morphs")),
                        (wave(folder), ("no-remainder", "half-bump", "first-half"))):
        check(made, 100)
        if "still-morphs" in kinds:
            chance = random.Random(3)
            check(made, 100, "--morphs", "any", amount_of=lambda: chance.choice((0, 1, chance.random())))
            check(made, 100, "--morphs", "-0.5..1.5", amount_of=lambda: chance.choice((-0.5, 1.5)))
        prove = ["bake", made, "--whole", "--level", "-1", "--leaf", "2", "--prove"]
        if "still-morphs" in kinds:
            any_weights = subprocess.run([program, *prove, "--morphs", "any"], capture_output=True, text=True)
            assert any_weights.returncode == 0 and "undecided" not in any_weights.stdout, any_weights.stdout
            for words, status in ((["0..1", "--engine", "float32"], 0), (["0.5..1", "--engine", "float32"], 2),
                                  (["1..0"], 2), (["0..1", "--certificate", made + ".any"], 0)):
                run = subprocess.run([program, "bake", made, "--morphs", *words], capture_output=True, text=True)
                assert run.returncode == status, (words, run.stderr)
        for kdop in ("6", "18"):
            right = subprocess.run([program, *prove, "--kdop", kdop], capture_output=True, text=True)
            assert right.returncode == 0 and ", 0 violated\n" in right.stdout and "undecided" not in right.stdout, \
                right.stdout + right.stderr
        for kind in kinds:
            wrong = subprocess.run([program, *prove, "--sabotage", kind], capture_output=True, text=True)
            assert wrong.returncode == 1, "%s is not found: %s" % (kind, wrong.stdout)
    # Instances that are none are named.
    good = json.load(open(os.path.join(folder, "crowd.gltf")))
    for change, said in ((lambda at: at.clear(), "has none of TRANSLATION, ROTATION and SCALE"),
                         (lambda at: at.update(SCALE=0), "another number of SCALE than of the others"),
                         (lambda at: at.update(TRANSLATION=999), "999")):
        bad = json.loads(json.dumps(good))
        change(bad["nodes"][1]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"])
        with open(os.path.join(folder, "bad.gltf"), "w") as file:
            json.dump(bad, file)
        run = subprocess.run([program, "bake", file.name], capture_output=True, text=True)
        assert run.returncode == 2 and said in run.stderr and run.stderr.count("\n") == 1, run.stderr
    # A page of a character with morph targets has bounds for all times first, and by methods, over all of its frames.
    shown = json.loads(subprocess.run([program, "view", os.path.join(folder, "face.gltf"), "--swept", "--json"],
                                      capture_output=True, text=True).stdout.splitlines()[0])["view"]
    assert list(shown["bounds"])[0] == "all times" and "best" in shown["bounds"], shown["bounds"].keys()
    assert len(shown["time_s"]) == 60, shown["time_s"]
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


def within_tolerance(name):
    """A clip as one interval exceeds the bounds at its instants by the tolerance at most, 1 %, at every BV."""
    made = subprocess.run([program, "bake", name, "--whole", "--report", "--json"], capture_output=True, text=True)
    added = [row["max_time_ratio"] for row in map(json.loads, made.stdout.splitlines()) if "max_time_ratio" in row]
    assert added and max(added) <= 1.01 * (1 + 1e-4), (name, added, made.stderr)  # its instants are some of all


within_tolerance(str(pathlib.Path(__file__).resolve().parents[2] / "data" / "scenes" / "tube.glb"))
skins = os.path.join(shared, "meshes", "skin")
if os.path.isdir(skins):
    for name in sorted(os.listdir(skins)):
        if name.endswith(".glb") and name != "robot.glb":  # which takes this reader minutes
            check(os.path.join(skins, name), 3)
            within_tolerance(os.path.join(skins, name))
else:
    print("the shared characters are missing; they were left out")
