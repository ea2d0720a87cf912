# SPDX-License-Identifier: GPL-3.0-or-later
"""poses_test.py CINCH [SHARED]: `cinch bake --poses` against a reader of glTF of its own: poses drawn within the limits
of bones, at their ends most of all, lie in the boxes; and boxes of limits that are too small do not hold them."""
import json, math, os, pathlib, random, subprocess, sys, tempfile

sys.path.append(str(pathlib.Path(__file__).resolve().parent))
from made_characters import crowd, face
from sampled_character import Character

checker = pathlib.Path(__file__).resolve().parents[2] / "experiments" / "check_certificate.py"
sys.dont_write_bytecode = True
sys.path.insert(0, str(checker.parent))
from certificate.interval import BITS  # noqa: E402
from certificate.motion import Bone, Character as Posed  # noqa: E402
from certificate.path import Piece  # noqa: E402
from certificate.poses import PoseProof  # noqa: E402
from certificate.records import AXES  # noqa: E402
from certificate.times import IntervalProof, Vertices  # noqa: E402

program, shared = sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else ""
chance = random.Random(7)


def product(a, b):
    (x, y, z, w), (p, q, r, s) = a, b
    return (w * p + x * s + y * r - z * q, w * q - x * r + y * s + z * p, w * r + x * q - y * p + z * s,
            w * s - x * p - y * q - z * r)


def about(axis, degrees):
    n = math.hypot(*axis)
    return (*(math.sin(math.radians(degrees) / 2) * x / n for x in axis), math.cos(math.radians(degrees) / 2))


def direction():
    while True:
        d = [chance.uniform(-1, 1) for _ in range(3)]
        if 0.1 < math.hypot(*d) < 1:
            return [x / math.hypot(*d) for x in d]


def drawn(character, limits):
    """Channels of a pose within the limits."""
    channels = []
    for i, node in enumerate(character.nodes):
        name = node.get("name") or "nodes[%d]" % i
        limit = limits["bones"].get(name, limits.get("others", {}))
        degrees, rest = limit.get("degrees", 0), node.get("rotation", (0, 0, 0, 1))
        if "matrix" in node:
            continue
        end = chance.random() < 0.7
        if isinstance(degrees, list):
            to = product(rest, about(limit["axis"], chance.choice(degrees) if end else chance.uniform(*degrees)))
        else:
            to = product(rest, about(direction(), degrees if end else chance.uniform(0, degrees)))
        far = limit.get("move", 0) * (1 if end else chance.random())
        moved = [x + far * d for x, d in zip(node.get("translation", (0, 0, 0)), direction())]
        channels += [(i, "rotation", [0.0], [to], "STEP"), (i, "translation", [0.0], [moved], "STEP")]
    return channels


def baked(name, limits, folder, *options, status=0):
    file = os.path.join(folder, "limits.json")
    with open(file, "w") as out:
        out.write(limits if isinstance(limits, str) else json.dumps(limits))
    run = subprocess.run([program, "bake", name, "--poses", file, "--json", *options], capture_output=True, text=True)
    assert run.returncode == status, (name, limits, run.returncode, run.stderr)
    if status:
        return run.stderr
    rows = [json.loads(line) for line in run.stdout.splitlines()]
    assert all(row["clip"] == "poses" and "every pose" in row["statement"] for row in rows)
    return rows[0]


def proven(name, limits, folder, *options):
    """By the program's exact side and by the checker of its certificate; damaged bounds by neither."""
    file, certificate = os.path.join(folder, "limits.json"), os.path.join(folder, "poses.jsonl.gz")
    with open(file, "w") as out:
        json.dump(limits, out)
    for damage, status in ([], 0), (["--sabotage", "no-remainder"], 1):
        words = [program, "bake", name, "--poses", file, "--prove", "--certificate", certificate, *map(str, options)]
        run = subprocess.run([*words, *damage], capture_output=True, text=True)
        said = run.stdout.splitlines()[-1]
        assert run.returncode == status and "bounds for all poses" in said, (name, limits, run)
        assert (", 0 violated" in said and "undecided" not in said) == (not damage), said
        assert not damage or "in a pose within the limits is" in run.stdout, run.stdout
        checked = subprocess.run([sys.executable, checker, certificate], capture_output=True, text=True)
        assert checked.returncode == status, (name, limits, options, damage, checked)
        assert ("every pose within limits proven" if not damage else "in every pose") in checked.stdout, checked.stdout
    print("%s: %s" % (os.path.basename(name), said))


def turned_by(m, x):
    return [sum(a * b for a, b in zip(row, x)) for row in m]


def row_norm(m):
    """The root of the greatest sum of a row of M^T M, at least the 2-norm."""
    columns = list(zip(*m))
    return math.sqrt(max(sum(abs(sum(x * y for x, y in zip(a, b))) for b in columns) for a in columns))


def checker_alone():
    """How far the checker takes poses to put a vertex from its place, against the same sum in doubles: not less, and
    not more."""
    for _ in range(60):
        bones, links, limits = [], [], []
        for i in range(4):
            m = [[chance.uniform(-1, 1) for _ in range(3)] for _ in range(3)]
            scale, matrix = [chance.uniform(0.3, 3) * chance.choice((-1, 1)) for _ in range(3)], []
            stretch, t = row_norm(m), [chance.uniform(-1, 1) for _ in range(3)]
            if i % 2:
                matrix = [*(x for column in zip(*m) for x in (*column, 0.0)), *t, 1.0]
            else:
                m = [[s if r == c else 0.0 for c, s in enumerate(scale)] for r in range(3)]
                stretch = max(map(abs, scale))
            bones.append(Bone(i - 1, t, (0.0, 0.0, 0.0, 1.0), scale, matrix))
            limits.append((chance.choice((0.0, chance.uniform(0, 3), 3.5)), chance.uniform(0, 0.5)))
            links.append((m, t, stretch, 2 if limits[-1][0] > 3.2 else 2 * math.sin(limits[-1][0] / 2)))
        bind = [chance.uniform(-1, 1) for _ in range(12)]
        joints, share = [(3, bind), (1, bind)], chance.randrange(1, 1 << 53)
        y, d = ([chance.uniform(-1, 1) for _ in range(3)] for _ in range(2))
        for any_weights in ([], [-0.5, 1.0]):
            class Surface:
                positions, rows, children = [y], [[(0, share, 0), (1, (1 << 53) - share, 0)]], []
            character = Posed(bones, joints, [0.25], any_weights)
            still = IntervalProof(Vertices(Surface, [0], [([0], [d])]), Surface, character.clip({}, []), AXES[6])
            weights = still.motion.on(Piece(0, 0, 0), {0, 1}).weights
            proof, expected = PoseProof(still, character, limits), 0
            for j, (at, _) in enumerate(joints):
                rows = [bind[4 * r:4 * r + 3] for r in range(3)]
                x = y if any_weights else [a + 0.25 * b for a, b in zip(y, d)]
                x = [a + bind[4 * r + 3] for r, a in enumerate(turned_by(rows, x))]
                ball = row_norm(rows) * math.hypot(*d) if any_weights else 0
                for i in range(at, -1, -1):
                    m, t, stretch, chord = links[i]
                    x, ball = turned_by(m, x), ball * stretch
                    step = limits[i][1] + chord * (math.hypot(*x) + ball)
                    expected += Surface.rows[0][j][1] / 2**53 * step * math.prod(link[2] for link in links[:i])
                    x = [a + b for a, b in zip(x, t)]
            got = proof.off(0, weights) / 2**(BITS + 53)
            assert abs(got - expected) <= 1e-12 * expected, (any_weights, got, expected)


def outside(name, limits, box, poses):
    """How far of their size samples leave the box, and how much of it they fill."""
    character, worst = Character(name), -math.inf
    low, high = [math.inf] * 3, [-math.inf] * 3
    size = max(h - l for l, h in zip(box["min"], box["max"]))
    for _ in range(poses):
        for v in character.vertices(drawn(character, limits), 0.0):
            for l, x, h in zip(box["min"], v, box["max"]):
                worst = max(worst, (l - x) / size, (x - h) / size)
            low, high = list(map(min, low, v)), list(map(max, high, v))
    return worst, math.dist(box["min"], box["max"]) / math.dist(low, high)


def check(name, limits, folder, poses=300):
    box = baked(name, limits, folder)
    worst, looseness = outside(name, limits, box, poses)
    print("%s: %.3g outside at most, %.3f of what was drawn" % (os.path.basename(name), worst, looseness))
    assert worst <= 1e-12, (name, limits, worst)
    return looseness


checker_alone()
with tempfile.TemporaryDirectory() as folder:
    names = [node.get("name") or "nodes[%d]" % i for i, node in enumerate(Character(face(folder)).nodes)]
    for made in (face(folder), crowd(folder)):
        character = Character(made)
        names = [node.get("name") or "nodes[%d]" % i for i, node in enumerate(character.nodes)]
        check(made, {"bones": {}, "others": {"degrees": 15, "move": 0.1}}, folder)
        check(made, {"bones": {}, "others": {"degrees": 180, "move": 1}}, folder)
        some = {"bones": {n: {"axis": direction(), "degrees": [-20, 100]} for n in names[1:3]},
                "others": {"degrees": 2}}
        if not any("matrix" in node for node in character.nodes):
            check(made, some, folder)
        assert check(made, {"bones": {}}, folder, 1) < 1.5  # the pose of the file
        # Limits that are half of what is drawn.
        box = baked(made, {"bones": {}, "others": {"degrees": 20, "move": 0}}, folder)
        worst, _ = outside(made, {"bones": {}, "others": {"degrees": 40}}, box, 300)
        assert worst > 0.005, worst
        for wrong, what in (('{"bones": {"nobody": {}}}', "no bone 'nobody'"), ('{"bones": ', "is no JSON"),
                            ('{"others": {"degrees": -1}}', "degrees"), ('{"others": {"degrees": [0, 1]}}', "one bone"),
                            ('{"other": {}}', "other"), ('{"others": {"degrees": 3, "mov": 1}}', "mov")):
            said = baked(made, wrong, folder, status=2)
            assert what in said and said.count("\n") == 1, (wrong, said)
        for option in (["--report"], ["--clip", "x"]):
            baked(made, {"bones": {}}, folder, *option, status=2)
        for k, options in enumerate(([], ["--kdop", 14, "--precision", "double"], ["--morphs", "-0.5..1"])):
            if "--morphs" in options and made != face(folder):
                continue
            proven(made, {"bones": {}, "others": {"degrees": 5 + 60 * k, "move": 0.1 * k}}, folder, *options)
        if not any("matrix" in node for node in character.nodes):
            proven(made, some, folder)
    bad = baked(face(folder), '{"bones": {"%s": {"axis": [0, 0, 0], "degrees": [0, 1]}}}' % names[1], folder, status=2)
    assert "axis" in bad, bad
if shared and os.path.isdir(shared):
    with tempfile.TemporaryDirectory() as folder:
        for name in ("CesiumMan", "RiggedFigure"):
            file = os.path.join(shared, "meshes", "skin", name + ".glb")
            check(file, {"bones": {}, "others": {"degrees": 8}}, folder, 20)
else:
    print("the reference characters are not there: skipped")
