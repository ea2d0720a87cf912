# SPDX-License-Identifier: GPL-3.0-or-later
"""certificate_of_times_test.py CINCH CHECKER [SHARED]: certificates of `cinch bake` are accepted by the checker, and
rejected after changes that matter, sealed with fitting hashes or not; what the checker computes with encloses."""
import copy, gzip, hashlib, json, math, os, random, struct, subprocess, sys, tempfile
from fractions import Fraction

sys.dont_write_bytecode = True
program, checker = sys.argv[1:3]
shared = sys.argv[3] if len(sys.argv) > 3 else ""
sys.path.insert(0, os.path.dirname(os.path.abspath(checker)))
import check_certificate  # noqa: E402
from certificate.interval import (UNIT, Interval, arc_tangent_of_quarter, of_double, root,  # noqa: E402
                                  sine_and_cosine, sine_and_cosine_between)
from certificate.path import Piece  # noqa: E402
from certificate.records import AXES, Records  # noqa: E402
from certificate.timed import HEADER, TimedChecker, TimedHeader  # noqa: E402
from certificate.times import IntervalProof, floor_units, stays_below  # noqa: E402
from certificate.values import Rejected  # noqa: E402
from made_characters import breath, face, nothing_to_turn_to, spin, wave  # noqa: E402
from sampled_character import Character  # noqa: E402

draw = random.Random(1)


def arithmetic():
    """Against doubles, which are right to 2^-50 here, and with radii far below that."""
    def near(x, value):
        assert abs(x.mid / UNIT - value) <= 2**-50 * max(1, abs(value)) and x.rad < UNIT >> 110, (x.mid / UNIT, value)
    for _ in range(3000):
        a = draw.choice([draw.uniform(0, math.pi), 10**draw.uniform(-30, 0), 0.0, math.pi, math.pi / 2])
        sine, cosine = sine_and_cosine(of_double(a))
        near(sine, math.sin(a))
        near(cosine, math.cos(a))
        one = sine.square() + cosine.square()
        assert one.low() <= UNIT <= one.high(), a
        y, x = draw.choice([(math.sin(a / 2), math.cos(a / 2)), (a, 1.0), (1.0, a)])
        near(arc_tangent_of_quarter(of_double(y), of_double(max(x, 0))), math.atan2(y, max(x, 0)))
        p, q = draw.uniform(-9, 9), draw.uniform(-9, 9)
        u, v = of_double(p), of_double(q)
        near(u * v, p * q)
        near(root(u.square()), abs(p))
        near(u / of_double(abs(q) + 0.1), p / (abs(q) + 0.1))
        # Of wide intervals every pair of members lies inside.
        wide, other = Interval(u.mid, draw.randrange(UNIT)), Interval(v.mid, draw.randrange(UNIT))
        for result, f in ((wide * other, lambda s, t: s * t // UNIT), (wide.square(), lambda s, t: s * s // UNIT),
                          (wide - other, lambda s, t: s - t)):
            for s in (wide.low(), wide.mid, wide.high()):
                for t in (other.low(), other.mid, other.high()):
                    assert result.low() - 1 <= f(s, t) <= result.high() + 1
        if other.low() > 0:
            ratio = wide / other
            assert all(ratio.low() <= (s * UNIT) // t <= ratio.high()
                       for s in (wide.low(), wide.high()) for t in (other.low(), other.high()))
        first, last = sorted((draw.uniform(0, math.pi), draw.uniform(0, math.pi)))
        ends = [of_double(x) for x in (first, last)]
        sine, cosine = sine_and_cosine_between(*ends, [sine_and_cosine(x) for x in ends])
        for i in range(9):
            t = first + (last - first) * i / 8
            assert sine.low() / UNIT - 1e-15 <= math.sin(t) <= sine.high() / UNIT + 1e-15
            assert cosine.low() / UNIT - 1e-15 <= math.cos(t) <= cosine.high() / UNIT + 1e-15
        x = draw.uniform(0.1, 3)  # of all of a wide angle
        sine, cosine = sine_and_cosine(Interval(of_double(x).mid, UNIT >> 7))
        for t in (x - 2**-7, x, x + 2**-7):
            assert sine.low() / UNIT - 1e-15 <= math.sin(t) <= sine.high() / UNIT + 1e-15
            assert cosine.low() / UNIT - 1e-15 <= math.cos(t) <= cosine.high() / UNIT + 1e-15
        # The parabola's top, against samples of it.
        f, l, b = draw.randrange(-100, 100), draw.randrange(-100, 100), draw.randrange(-50, 100)
        most = max((1 - t / 400) * f + t / 400 * l + 4 * t / 400 * (1 - t / 400) * max(b, 0) for t in range(401))
        assert not stays_below(f, l, b, math.ceil(most - 0.01) - 1) and stays_below(f, l, b, math.ceil(most + 0.01))


def motion(name, proof):
    """What the checker encloses, against a sampler of glTF of its own: boxes at instants, and differences of places."""
    records = Records(open(proof, "rb"))
    checked = TimedChecker(records, TimedHeader(records.expect("a header", HEADER)))
    sampled = dict(Character(name).clips())
    for clip, moved in checked.clips:
        for a, b in zip(moved.keys, moved.keys[1:]):
            t, h = a + (b - a) * Fraction(draw.randrange(1, 100), 100), (b - a) / 1024
            places = []
            for first, last in ((t, t), (t - h, t + h)):
                enclosed = moved.on(Piece(first, last, (a + b) / 2), range(len(checked.character.joints)))
                places.append([[checked.vertices.place(v, enclosed.first, enclosed.weights, 0),
                                checked.vertices.place(v, enclosed.last, enclosed.weights, 1),
                                checked.vertices.bend(v, enclosed)] for v in checked.vertices.used])
            unit = 1 << checked.vertices.unit_bits
            own = [[x / unit for x in at[0][0]] for at in places[0]]
            true = list(Character(name).vertices(sampled[clip], float(t)))
            for box in (min, max):
                for x, y in zip(map(box, zip(*own)), map(box, zip(*true))):
                    assert abs(x - y) <= 1e-9 * max(map(abs, true[0])) + 1e-12, (clip, float(t), x, y)
            for at, (begin, end, (bend, rad)) in zip(places[0], places[1]):
                for r in range(3):  # x(t-h) - 2 x(t) + x(t+h) is a mean of x'' over the piece, times h^2; time is 0..1
                    second = begin[0][r] - 2 * at[0][0][r] + end[0][r]
                    slack = (begin[1][r] + 2 * at[0][1][r] + end[1][r]) * 4
                    assert 4 * second - slack <= bend[r] + rad[r] and 4 * second + slack >= bend[r] - rad[r], (clip, r)


def reached(folder, name, proof, kdop):
    """Of one BV alone, and along each direction alone: a bound a little above what vertices reach is accepted, one
    below is rejected, wherever between two keys they do."""
    run("bake", name, "--whole", "--leaf", "100000", "--kdop", kdop, "--certificate", proof)
    records, character = read(proof), Character(name)
    axes = AXES[int(kdop)]
    starts = [i for i, r in enumerate(records) if "clip" in r]
    for at, (clip, channels) in zip(starts, character.clips()):
        box = next(i for i in range(at, len(records)) if "bounds" in records[i])
        keys = sorted({t for c in channels for t in c[2]})
        places = [v for a, b in zip(keys, keys[1:]) for i in range(301)
                  for v in character.vertices(channels, a + (b - a) * i / 300)]
        size = max(max(map(abs, v)) for v in places)
        for d in range(int(kdop)):
            most = max((1 - 2 * (d % 2)) * sum(a * x for a, x in zip(axes[d // 2], v)) for v in places)
            for by in (-1e-2, -1e-3, -1e-4, 1e-3):
                changed = copy.deepcopy(records)
                for r in changed:
                    if "bounds" in r:
                        r["bounds"] = ["inf"] * int(kdop)
                changed[box]["bounds"][d] = (most + by * size).hex()
                assert (reason(folder, sealed(changed)) is None) == (by > 0), (clip, d, by)


def read(name):
    with (gzip.open if name.endswith(".gz") else open)(name, "rt") as file:
        return [json.loads(line) for line in file]


def sealed(records):
    """With counts and hashes that fit, as who changes it on purpose would write them."""
    records = copy.deepcopy(records)
    doubles = lambda texts: struct.pack("<%dd" % len(texts), *map(float.fromhex, texts))
    sha = {name: hashlib.sha256() for name in ("positions", "weights", "triangles", "motion")}
    count = {"vertex": 0, "triangle": 0, "bv": 0, "clip": 0}
    bounds = []
    for r in records[1:-1]:
        if "rest" in r:
            sha["positions"].update(doubles(r["rest"]))
            n = len(r["nodes"])
            sha["weights"].update(struct.pack("<I%dI" % n, n, *r["nodes"]) + doubles(r["weights"]))
            count["vertex"] += 1
        elif "triangle" in r:
            sha["triangles"].update(struct.pack("<3I", *r["vertices"]))
            count["triangle"] += 1
        elif "bv" in r and "bounds" not in r:
            count["bv"] += 1
        elif "bounds" in r:
            bounds += r["bounds"]
        elif "interval" not in r:
            sha["motion"].update(json.dumps(r, separators=(",", ":")).encode() + b"\n")
            count["clip"] += "clip" in r
    first, last = records[0], records[-1]
    first.update(vertices=count["vertex"], triangles=count["triangle"], bvs=count["bv"], clips=count["clip"])
    first["sha256"].update((name, sha[name].hexdigest()) for name in ("positions", "triangles", "weights"))
    method = hashlib.sha256()
    for part in (first["certificate"], first["method"], str(first["kdop"]), *first["weights"], *first["missing"]):
        method.update(b"%d:%b" % (len(part.encode()), part.encode()))
    first["sha256"]["method"] = method.hexdigest()
    last.update(clips=count["clip"], infinite=bounds.count("inf"), proven=len(bounds) - bounds.count("inf"))
    last["sha256"] = {"motion": sha["motion"].hexdigest()}
    return records


def reason(folder, records):
    """Why it is rejected; None where it is not."""
    name = os.path.join(folder, "changed.jsonl")
    with open(name, "w") as file:
        file.writelines(json.dumps(r, separators=(",", ":")) + "\n" for r in records)
    try:
        check_certificate.check(name)
    except Rejected as error:
        assert "not understood" not in str(error), error
        return str(error)
    return None


def moved(text, by):
    return (float.fromhex(text) + by).hex()


def changes(records):
    """Descriptions with functions that change records in place, of which every one makes it say what is not true."""
    def places(*keys):
        return [i for i, r in enumerate(records) if all(k in r for k in keys)]
    bounds, intervals, clips = places("bounds"), places("interval", "first"), places("clip", "first")
    size = max(abs(float.fromhex(x)) for i in bounds for x in records[i]["bounds"])
    last_bv = max(records[i]["bv"] for i in bounds)
    for bv in (0, last_bv):
        at = draw.choice([i for i in bounds if records[i]["bv"] == bv])
        for d in range(len(records[at]["bounds"])):
            extent = sum(float.fromhex(x) for x in records[at]["bounds"][d & ~1:(d & ~1) + 2])
            def narrower(r, at=at, d=d, by=0.6 * extent):
                r[at]["bounds"][d] = moved(r[at]["bounds"][d], -by)
            yield "bound %d of BV %d far inside" % (d, bv), narrower
    def no_number(r): r[bounds[0]]["bounds"][0] = "nan"
    def minus(r): r[bounds[0]]["bounds"][0] = "-inf"
    def no_interval(r): del r[intervals[-1]:intervals[-1] + last_bv + 2]
    def gap(r): r[intervals[-1]]["first"] = moved(r[intervals[-1]]["first"], 1e-9)
    def early(r): r[clips[-1]]["last"] = moved(r[clips[-1]]["last"], 1.0)
    def late(r): r[clips[-1]]["first"] = moved(r[clips[-1]]["first"], 0.01)
    def shorter(r):
        for i in (intervals[-1], clips[-1]):
            r[i]["last"] = moved(r[i]["last"], -1e-3)
    def later(r):
        for i in (intervals[0], clips[0]):
            r[i]["first"] = moved(r[i]["first"], 1e-3)
    def doubled(r): r.insert(bounds[0], copy.deepcopy(r[bounds[0]]))
    def lost(r): del r[bounds[-1]]
    def exchanged(r): r[bounds[0]], r[bounds[1]] = r[bounds[1]], r[bounds[0]]
    def no_end(r): r.pop()
    def more(r): r.append(copy.deepcopy(r[-1]))
    def triangle(r):
        at = next(i for i, x in enumerate(r) if "bv" in x and "triangles" in x)
        r[at]["triangles"].pop()
    def far(r): r[places("rest")[7]]["rest"][2] = moved(r[places("rest")[7]]["rest"][2], 3 * size)
    def heavier(r):
        at = next(i for i in places("rest") if len(r[i]["weights"]) > 1)
        r[at]["weights"][0] = moved(r[at]["weights"][0], 2**-52)
    made = (no_number, minus, no_interval, gap, early, late, shorter, later, doubled, lost, exchanged, no_end, more,
            triangle, far, heavier)
    yield from ((f.__name__, f) for f in made)
    for i in places("curve"):
        def key(r, i=i): r[i]["values"][-1] = [moved(x, 40 * size * (-1)**n) for n, x in enumerate(r[i]["values"][-1])]
        def order(r, i=i): r[i]["times"].reverse()
        def fewer(r, i=i): r[i]["times"].pop()
        if records[i]["moves"] != "rotation":
            yield "a key of the %s far away" % records[i]["moves"], key
        yield "times in another order", order
        yield "a time less", fewer
    for i in places("morph"):
        def weight(r, i=i): r[i]["values"] = [moved(x, 50 * size) for x in r[i]["values"]]
        yield "weights of a target", weight
    for i in places("displacements"):
        def by(r, i=i): r[i]["displacements"] = [[moved(x, 9 * size) for x in d] for d in r[i]["displacements"]]
        if records[i]["vertices"] and (not places("limit") or float.fromhex(records[i]["weight"])):
            yield "displacements", by
    for i in places("bind"):
        def bind(r, i=i): r[i]["bind"][7] = moved(r[i]["bind"][7], 9 * size)
        yield "a bind", bind
    if places("limit"):
        limit = places("limit")[records[places("bind")[0]]["bone"]]
        yield "a limit", lambda r: r[limit].update(move=moved(r[limit]["move"], 9 * size))
    for i in places("parent"):
        def parent(r, i=i): r[i]["parent"] = r[i]["bone"]
        yield "a bone above itself", parent
    for i in places("frame", "maps"):
        def frame(r, i=i): r[i]["maps"] = [[moved(x, 9 * size) for x in m] for m in r[i]["maps"]]
        yield "a frame", frame
        break


def mutated(folder, name):
    records = read(name)
    assert reason(folder, records) is None and reason(folder, sealed(records)) is None
    wider = copy.deepcopy(records)
    for r in wider:
        if "bounds" in r:
            r["bounds"] = [moved(x, 0.5) if x != "inf" else x for x in r["bounds"]]
    assert reason(folder, wider) is None, "wider bounds are rejected"
    for what, change in changes(records):
        for seal in (True, False):
            changed = copy.deepcopy(records)
            change(changed)
            try:
                changed = sealed(changed) if seal else changed
            except (ValueError, KeyError, OverflowError):
                continue
            assert reason(folder, changed), "%s%s is accepted" % (what, ", sealed," if seal else "")
    return len(list(changes(records)))


def strip(folder):
    """A skin as text: two simulation nodes and three frames, two of them at one time."""
    n, files = 20, [os.path.join(folder, "strip" + end) for end in (".off", ".weights.txt", ".frames.txt")]
    with open(files[0], "w") as mesh, open(files[1], "w") as weights, open(files[2], "w") as frames:
        mesh.write("OFF\n%d %d 0\n" % (n, n - 2) + "".join("%d %g 0\n" % (i % 2, i / 3) for i in range(n)) +
                   "".join("3 %d %d %d\n" % (i, i + 1, i + 2) for i in range(n - 2)))
        weights.write("%d 2\n" % n + "".join("2 0 %d 1 %d\n" % (n - i, i) for i in range(n)))
        frames.write("1\nsway 4 2\n")
        for t, x in ((0, 0), (0.5, 3), (0.5, -2), (1.25, 1)):
            frames.write("%g  1 0 0 %g 0 1 0 0 0 0 1 0  0 -1 0 0 1 0 0 %g 0 0 1 %g\n" % (t, x, x, -x))
    return files[0], "--weights", files[1], "--transforms", files[2]


def run(*arguments):
    made = subprocess.run([program, *arguments], capture_output=True, text=True)
    assert made.returncode in (0, 1), made.stderr
    return made


def limits():
    """A vertex of two leaves stays below the least bound of both and of what is above them, rounded down."""
    class Of:
        unit_bits, children, corners = 200, [(1, 2), None, None], [None, [0, 1], [1, 2]]
    proof = IntervalProof(Of, Of, None, AXES[6])
    for top, a, b in ((9, 3, 5), (9, 5, 3), (4, 7, 3)):
        bounds = [[float(x)] * 6 for x in (top, a, b)]
        found = proof.limits(bounds)
        assert [found[v][0] >> 200 for v in range(3)] == [min(top, a), min(top, a, b), min(top, b)], bounds
    assert proof.limits([[None] * 6] * 3)[1] == [proof.endless] * 6
    for x in (0.1, -0.1, 1e-70, -1e-70, -3.0, 2**60):
        assert Fraction(floor_units(x, 200), 1 << 200) <= Fraction(x) < Fraction(floor_units(x, 200) + 1, 1 << 200)


def poses(folder, name, proof):
    """Every pose within limits: nothing wider, and nothing nearer, is proven."""
    with open(os.path.join(folder, "limits.json"), "w") as out:
        out.write('{"bones": {}, "others": {"degrees": 10, "move": 0.01}}')
    assert run("bake", name, "--leaf", "4", "--poses", out.name, "--certificate", proof).returncode == 0
    return mutated(folder, proof)


def any_weights(folder, name, proof):
    """Morph targets with any weights of a range: no wider range is proven by the same bounds, nor nearer bounds."""
    for limits in ("any", "-0.5..1.5"):
        made = run("bake", name, "--morphs", limits, "--leaf", "8", "--whole", "--prove", "--certificate", proof)
        assert made.returncode == 0, made.stdout
        records = read(proof)
        assert reason(folder, records) is None, reason(folder, records)
        low, high = (float.fromhex(x) for x in records[0]["weights"])
        assert (low, high) == ((0, 1) if limits == "any" else (-0.5, 1.5))
        for wider in ((low - 2, high), (low, high + 2)):
            changed = json.loads(json.dumps(records))
            changed[0]["weights"] = [x.hex() for x in wider]
            assert "SHA-256 of the method" in reason(folder, changed)
            assert "is not shown to stay" in reason(folder, sealed(changed)), wider
        for weights in ([], [(1.0).hex(), (0.0).hex()], [(0.0).hex()], ["nan"] * 2):
            changed = json.loads(json.dumps(records))
            changed[0]["weights"] = weights
            assert reason(folder, sealed(changed)) if weights else "SHA-256 of the method" in reason(folder, changed)
        size = max(abs(float.fromhex(x)) for r in records if "bounds" in r for x in r["bounds"])
        for d in range(6):
            changed = json.loads(json.dumps(records))
            most = max((r for r in changed if "bounds" in r), key=lambda r: float.fromhex(r["bounds"][d]))
            most["bounds"][d] = (float.fromhex(most["bounds"][d]) - 0.25 * size).hex()
            assert reason(folder, sealed(changed)), "bound %d far inside the surface is accepted" % d


arithmetic()
limits()
with tempfile.TemporaryDirectory() as folder:
    proof, count = os.path.join(folder, "proof.jsonl.gz"), 0
    for name, kinds in ((face(folder), ("no-remainder", "half-bump", "first-half", "still-morphs")),
                        (wave(folder), ("no-remainder", "half-bump", "first-half"))):
        for more in (["--whole"], ["--kdop", "14", "--leaf", "8"], ["--method", "eq12", "--precision", "float"]):
            made = run("bake", name, *more, "--certificate", proof)
            assert made.returncode == 0, made.stderr
            assert subprocess.run([sys.executable, checker, proof], capture_output=True).returncode == 0, more
        count += mutated(folder, proof)
        plain = os.path.join(folder, "plain.jsonl")
        run("bake", name, "--leaf", "100000", "--certificate", plain)
        motion(name, plain)
        for kind in kinds:
            run("bake", name, "--whole", "--leaf", "2", "--sabotage", kind, "--certificate", proof)
            wrong = subprocess.run([sys.executable, checker, proof], capture_output=True, text=True)
            assert wrong.returncode == 1 and "beyond the bound" in wrong.stdout, (kind, wrong.stdout, wrong.stderr)
    any_weights(folder, face(folder), proof)
    count += poses(folder, face(folder), proof)
    run("verify", name, "--times", "all", "--certificate", proof)
    assert reason(folder, read(proof)) is None
    for name, kdop in ((spin(folder), "14"), (wave(folder), "6"), (breath(folder), "6")):
        reached(folder, name, proof, kdop)
    named = read(proof)
    for r in named:
        if "clip" in r:
            r["clip"] += " again"
    assert reason(folder, sealed(named)) is None and "SHA-256 of the motion" in reason(folder, named)
    plain = os.path.join(folder, "plain.jsonl")
    run("bake", spin(folder), "--certificate", plain)
    motion(spin(folder), plain)
    for more in ([], ["--whole"], ["--interval", "1"], ["--interval", "0.5"]):
        made = run("bake", nothing_to_turn_to(folder), *more, "--prove", "--certificate", proof)
        assert made.returncode == 0, made.stdout
        assert reason(folder, read(proof)) is None, more
        for d in range(6):  # every bound is reached, some of them at a jump alone
            records = read(proof)
            most = max(float.fromhex(r["bounds"][d]) for r in records if "bounds" in r)
            for r in records:
                if "bounds" in r and float.fromhex(r["bounds"][d]) == most:
                    r["bounds"][d] = moved(r["bounds"][d], -1e-3)
            assert reason(folder, sealed(records)), "bound %d inside the surface is accepted" % d
    files = strip(folder)
    made = run("bake", *files, "--certificate", proof)  # frames, interpolated
    assert made.returncode == 0, made.stderr
    count += mutated(folder, proof)
    tied = subprocess.run([sys.executable, checker, proof, "--input", *files], capture_output=True, text=True)
    assert tied.returncode == 0 and 'those of 4 of 4 frames of clip "sway"' in tied.stdout, tied.stdout + tied.stderr
    with open(files[4]) as file:
        other = file.read().replace("1.25", "1.5")
    with open(files[4], "w") as file:
        file.write(other)
    tied = subprocess.run([sys.executable, checker, proof, "--input", *files], capture_output=True, text=True)
    assert tied.returncode == 1 and "none of those of clip" in tied.stdout, tied.stdout + tied.stderr
    skins = os.path.join(shared, "meshes", "skin")
    for name in ("RiggedFigure.glb", "Fox.glb"):
        if os.path.isfile(os.path.join(skins, name)):
            run("bake", os.path.join(skins, name), "--certificate", proof)
            assert reason(folder, read(proof)) is None, name
        else:
            print("%s is missing; it was left out" % name)
print("%d changes, each rejected" % count)
