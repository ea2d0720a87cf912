# SPDX-License-Identifier: GPL-3.0-or-later
"""audit_test.py CINCH [SHARED]: what `cinch audit` says of formulas of engines: every counterexample against a reader
and sampler of glTF of its own, written from the specification; and formulas on hand-made skins, of which it is known
what they do."""
import json, math, os, pathlib, signal, subprocess, sys, tempfile, time

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent / "time"))
from made_characters import Maker, crowd, face, many_clips, spin, wave
from sampled_character import Character

program, shared = sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else ""


def wait_for(what):
    for _ in range(600):
        if what():
            return
        time.sleep(0.1)
    raise AssertionError("waited in vain")


def audited(*words, status=0):
    run = subprocess.run([program, "audit", *map(str, words)], capture_output=True, text=True)
    assert run.returncode == status, (words, run.returncode, run.stderr)
    return run.stdout


def records(*words):
    return [json.loads(line) for line in audited(*words, "--seconds", "0.01", "--json").splitlines()]


def confirm(name, *options):
    """Each counterexample by the other sampler; and that nothing of ours fails."""
    character, rows = Character(name), records(name, *options)
    clips = dict(character.clips())
    refuted = 0
    for row in rows:
        what = (os.path.basename(name), row["clip"], row["formula"])
        assert row["violated"] == (row["verdict"] == "refuted"), what
        if row["formula"].startswith("cinch"):
            assert row["verdict"] == ("proven" if row["formula"] == "cinch bake" else "holds"), (what, row)
        if row["formula"] == "joint-boxes":
            assert row["verdict"] != "refuted" or "weights" in {c[1] for c in clips[row["clip"]]}, what
        assert row["mean_ratio"] <= row["max_ratio"] * (1 + 1e-12), what
        if not row["violated"]:
            assert row["worst_time"] is None, what
            continue
        refuted += 1
        places = list(character.vertices(clips[row["clip"]], row["worst_time"]))
        d = row["worst_direction"]
        if d < 0:
            reach, bound = max(math.dist(v, row["centre"]) for v in places), row["bound"]
        else:
            reach, bound = max((-v[d // 2] if d % 2 else v[d // 2]) for v in places), row["bound"]
        size = max(max(v[i] for v in places) - min(v[i] for v in places) for i in range(3))
        assert reach > bound - 1e-12 * size, (what, reach, bound)
        assert abs(reach - bound - row["worst_overflow"]) <= 1e-9 * size, (what, reach - bound, row["worst_overflow"])
    print("%s: %d formulas and clips, %d counterexamples confirmed" % (os.path.basename(name), len(rows), refuted))
    return {(row["clip"], row["formula"]): row for row in rows}


def arm(folder, name, animate):
    """Two bones along x, length 1 each, the second bends or grows; four vertices at each of three places. Or a morph
    target lifts it, by these weights."""
    m = Maker()
    places, joints, weights = [], [], []
    for x in (0.0, 1.0, 2.0):
        for y, z in ((-0.1, -0.1), (0.1, -0.1), (0.1, 0.1), (-0.1, 0.1)):
            places.append((x, y, z))
            joints.append((0, 1, 0, 0))
            weights.append((1.0, 0.0, 0, 0) if x < 1 else (0.5, 0.5, 0, 0) if x < 2 else (0.0, 1.0, 0, 0))
    indices = [(i,) for a in (0, 4) for q in range(4) for i in
               (a + q, a + (q + 1) % 4, a + 4 + q, a + (q + 1) % 4, a + 4 + (q + 1) % 4, a + 4 + q)]
    identity = (1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1)
    back = (1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1)
    position, index = m.add(places, "VEC3"), m.add(indices, "SCALAR", 5123)
    joint, weight = m.add(joints, "VEC4", 5121), m.add(weights, "VEC4")
    bind = m.add([identity, back], "MAT4")
    times = m.add([(0.0,), (1.0,), (2.0,)], "SCALAR")
    path, values = animate
    lift = m.add([(0, 0, x) for x, _, _ in places], "VEC3")
    values = m.add(values, {"rotation": "VEC4", "weights": "SCALAR"}.get(path, "VEC3"))
    targets = {"targets": [{"POSITION": lift}]} if path == "weights" else {}
    m.write(folder, name, {
        "scene": 0, "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"mesh": 0, "skin": 0}, {"children": [2]}, {"translation": [1, 0, 0]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": position, "JOINTS_0": joint, "WEIGHTS_0": weight},
                                    "indices": index, **targets}]}],
        "skins": [{"joints": [1, 2], "inverseBindMatrices": bind}],
        "animations": [{"name": "a", "samplers": [{"input": times, "output": values}],
                        "channels": [{"sampler": 0, "target": {"node": 0 if targets else 2, "path": path}}]}]})
    return os.path.join(folder, name)


half = math.sqrt(0.5)
with tempfile.TemporaryDirectory() as folder:
    still = confirm(arm(folder, "still.gltf", ("rotation", [(0, 0, 0, 1)] * 3)))
    for formula in ("rest-box", "rest-sphere", "root-box", "joint-pivots", "joint-spheres", "joint-boxes", "key-union",
                    "fps-union", "key-joint-boxes"):
        assert still["a", formula]["verdict"] in ("proven", "holds", "to rounding"), still["a", formula]
    assert still["a", "joint-boxes"]["verdict"] == "proven", still["a", "joint-boxes"]
    # Bent to a right angle and back: up where nothing was at rest; straight at the keys 0 and 2.
    bent = confirm(arm(folder, "bent.gltf", ("rotation", [(0, 0, 0, 1), (0, 0, half, half), (0, 0, 0, 1)])))
    for formula in ("rest-box", "root-box", "rest-sphere"):
        assert bent["a", formula]["verdict"] == "refuted", bent["a", formula]
    assert 0.9 <= bent["a", "rest-box"]["worst_overflow"] < 0.91, bent["a", "rest-box"]
    for formula in ("joint-spheres",):  # no scales
        assert bent["a", formula]["verdict"] == "holds", bent["a", formula]
    # Half a turn in one step: the union at key times never sees the arm upright.
    turned = confirm(arm(folder, "turned.gltf", ("rotation", [(0, 0, 0, 1), (0, 0, 1, 1e-3), (0, 0, 0, 1)])))
    for formula in ("key-union", "rest-box"):
        assert turned["a", formula]["verdict"] == "refuted", turned["a", formula]
    assert turned["a", "key-union"]["worst_overflow"] > 0.8, turned["a", "key-union"]
    assert turned["a", "joint-boxes"]["verdict"] == "proven"
    # A bone that grows leaves balls of its size at rest.
    grown = confirm(arm(folder, "grown.gltf", ("scale", [(1, 1, 1), (3, 3, 3), (1, 1, 1)])))
    for formula in ("joint-spheres", "rest-box", "joint-pivots"):
        assert grown["a", formula]["verdict"] == "refuted", grown["a", formula]
    assert grown["a", "joint-boxes"]["verdict"] == "proven"
    # Methods from outside: bounds of vertices as they are, and less than that.
    method = "python3 " + str(pathlib.Path(__file__).resolve().parent / "outside_method.py")
    outside = [word for name in ("1e-9", "-0.125", "ball") for word in ("--outside", f"own {name}={method} {name}")]
    for name in (os.path.join(folder, "bent.gltf"), face(folder)):
        rows = confirm(name, *outside)
        for clip in {clip for clip, _ in rows}:
            tight, less, ball = (rows[clip, "own " + name] for name in ("1e-9", "-0.125", "ball"))
            assert tight["verdict"] == "holds" and 1 < tight["mean_ratio"] < 1 + 1e-7, tight
            assert ball["verdict"] == "holds" and ball["ns_per_box"] is None, ball
            assert less["verdict"] == "refuted" and abs(less["worst_overflow"] - 0.125) < 1e-9, less
    for name, status in (("short", 2), ("odd", 2), ("1e-9; exit 3", 2)):
        audited(os.path.join(folder, "bent.gltf"), "--outside", f"own={method} {name}", status=status)
    # An interrupt ends what the method has started.
    here = subprocess.Popen([program, "audit", os.path.join(folder, "bent.gltf"), "--outside",
                             "own=cat > /dev/null; sleep 3333.25; true"], stdout=subprocess.DEVNULL,
                            stderr=subprocess.DEVNULL)
    def running():
        for path in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
            try:
                if path.read_bytes() == b"sleep\0003333.25\0":
                    return True
            except OSError:
                pass  # it has ended
        return False

    wait_for(running)
    here.send_signal(signal.SIGINT)
    assert here.wait(60) == 130
    wait_for(lambda: not running())
    for text in ("own", "=true", "own=", "cinch best=true", "joint-boxes=true"):
        audited(os.path.join(folder, "bent.gltf"), "--outside", text, status=2)
    # The most that a morph target does alone holds until its weight is above 1.
    for weights, verdicts in (((0, 0, 0), ("holds", "to rounding")), ((0, 1, 0), ("holds", "to rounding")),
                              ((0, 2, 0), ("refuted",))):
        lifted = confirm(arm(folder, "lifted.gltf", ("weights", [(w,) for w in weights])))
        assert lifted["a", "morph-average"]["verdict"] in verdicts, (weights, lifted["a", "morph-average"])
    faces = confirm(face(folder))
    assert {f for _, f in faces} >= {"morph-average", "rest-box"}
    confirm(crowd(folder))
    confirm(wave(folder))
    confirm(spin(folder))
    # Counterexamples one by one, as many as the table numbers.
    table = audited(os.path.join(folder, "bent.gltf"), "--seconds", "0.01")
    count = sum(row["violated"] for row in bent.values())
    for k in range(1, count + 1):
        shown = audited(os.path.join(folder, "bent.gltf"), "--seconds", "0.01", "--show", k)
        assert "in real arithmetic" in shown and "outside the b" in shown, shown
    audited(os.path.join(folder, "bent.gltf"), "--seconds", "0.01", "--show", count + 1, status=2)
    assert " refuted " in table and "cinch best" in table, table
    audited(os.path.join(folder, "none.glb"), status=2)
    assert "cinch bake" in audited("santa-ring-1", "--seconds", "0.01")  # no joints, no file

if shared and os.path.isdir(shared):
    whole = float(os.environ.get("CINCH_TEST_SHARE", 1)) >= 1
    if not whole:
        print("robot: left out of a share of the cases")
    for name in ("CesiumMan", "Fox", "RiggedFigure") + ("robot",) * whole:
        confirm(os.path.join(shared, "meshes", "skin", name + ".glb"))
else:
    print("the reference characters are not there: skipped")
