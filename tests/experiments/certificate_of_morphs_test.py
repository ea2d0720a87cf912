#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""certificate_of_morphs_test.py CINCH CHECKER: certificates of frames in which morph targets displace the surface are
accepted, and rejected after any change that matters; supports of displaced vertices in fractions besides."""
import contextlib
import copy
import io
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile
from fractions import Fraction

CINCH, CHECKER = sys.argv[1:3]
sys.dont_write_bytecode = True
tests = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [os.path.dirname(CHECKER), str(tests), str(tests.parent / "time")]
import check_certificate  # noqa: E402
from certificate_forge import of, sealed, written  # noqa: E402
from certificate_oracle import Oracle  # noqa: E402
from made_characters import face  # noqa: E402


def run(path, *options):
    out = io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(out):
        status = check_certificate.main([path, *options])
    return status, out.getvalue().strip()


class Displaced(Oracle):
    """The same of displaced vertices."""

    def __init__(self, records):
        super().__init__(records)
        number = lambda x: Fraction(float.fromhex(x))  # noqa: E731
        self.targets = [(r["vertices"], [[number(x) for x in d] for d in r["displacements"]])
                        for r in records if "target" in r]
        self.morphs = [[number(x) for x in r["morphs"]] for r in records if "morphs" in r]
        self.triangles = [r["vertices"] for r in records if "triangle" in r]

    def support(self, frame, bv, d):
        rest = [list(x) for x in self.rest]
        for a, (vertices, by) in zip(self.morphs[frame], self.targets):
            for v, delta in zip(vertices, by):
                rest[v] = [x + a * y for x, y in zip(rest[v], delta)]
        return max(sum(w * self.image(frame, j, rest[v], d) for j, w in self.weights[v].items())
                   for v in self.vertices(bv))


def hexed(x, up):
    """The double next to a fraction, above or below."""
    y = float(x)
    if up and Fraction(y) < x:
        y = math.nextafter(y, math.inf)
    if not up and Fraction(y) >= x:
        y = math.nextafter(y, -math.inf)
    return y.hex()


def change(records, key, which, path, value):
    records = copy.deepcopy(records)
    at = records[of(records, key)[which]]
    for step in path[:-1]:
        at = at[step]
    at[path[-1]] = value(at[path[-1]]) if callable(value) else value
    return records


def add(by):
    return lambda x: (float.fromhex(x) + by).hex()


with tempfile.TemporaryDirectory() as folder:
    character, rejected = face(folder), 0
    for words in (["--method", "best"], ["--method", "limited", "--kdop", "14"], ["--method", "vertices"]):
        path = os.path.join(folder, "c.jsonl")
        done = subprocess.run([CINCH, "verify", character, *words, "--frames", "3", "--leaf", "4", "--certificate",
                               path], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        records = [json.loads(line) for line in open(path, encoding="ascii")]
        status, said = run(path)
        assert status == 0 and "accepted" in said and "0 infinite" in said, said
        assert records[0]["targets"] == len(of(records, "target")) > 2
        assert not any("lambda" in r for r in records)
        assert sealed(records) == records
        mesh = written(folder, b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "mesh.obj")
        assert "no file of --input has" in run(path, "--input", mesh)[1]

        oracle = Displaced(records)
        frames, bvs = len(oracle.maps), len(oracle.bvs)
        moved = max(range(frames), key=lambda f: max(map(abs, oracle.morphs[f])))
        leaf = next(i for i in range(bvs) if "triangles" in oracle.bvs[i]
                    and set(oracle.targets[0][0]) & oracle.vertices(i))
        place = moved * bvs + leaf
        for d in range(6):
            least = oracle.support(moved, leaf, d)
            assert float.fromhex(records[of(records, "bounds")[place]]["bounds"][d]) >= least
            tight = sealed(change(records, "bounds", place, ["bounds", d], hexed(least, False)))
            assert run(written(folder, tight))[0] == 1, (words, d)
            wide = sealed(change(records, "bounds", place, ["bounds", d], add(1)))
            assert run(written(folder, wide))[0] == 0, (words, d)
            rejected += 1
        # What an accident, or who means it, changes.
        n = of(records, "target")[0]
        half = copy.deepcopy(records)
        for f in of(half, "morphs"):
            half[f]["morphs"] = ["0x0p+0"] * len(half[f]["morphs"])
        without = copy.deepcopy([r for i, r in enumerate(records) if i != n])
        for i, r in enumerate(r for r in without if "target" in r):
            r["target"] = i
        for what, changed, reason in (
                ("a weight", change(records, "morphs", moved, ["morphs", 0], add(2.0**-50)), ""),
                ("a displacement", change(records, "target", 0, ["displacements", 2, 1], add(9.0)),
                 "SHA-256 of the targets"),
                ("the same, sealed", sealed(change(records, "target", 0, ["displacements", 2, 1], add(9.0))),
                 "beyond the bound"),
                ("vertices that do not ascend", sealed(change(records, "target", 0, ["vertices"], lambda v: v[::-1])),
                 "do not ascend"),
                ("a vertex that is none", sealed(change(records, "target", 0, ["vertices", -1], 10**6)), "a vertex"),
                ("a displacement less", sealed(change(records, "target", 0, ["displacements"], lambda d: d[:-1])),
                 "no list of"),
                ("a weight less", sealed(change(records, "morphs", 0, ["morphs"], lambda w: w[:-1])), "no list of"),
                ("a weight that is no number", change(records, "morphs", 0, ["morphs", 0], "nan"),
                 "no hexadecimal float"),
                ("a target left out", without, ""),
                ("no weights", [{k: v for k, v in r.items() if k != "morphs"} for r in records], "is missing"),
                ("weights of 0, sealed", sealed(half), "beyond the bound"),
                ("a count", change(records, "maps", 0, ["frame"], 1), "")):
            status, said = run(written(folder, changed))
            assert status == 1 and "rejected: " in said and "not understood" not in said, (what, said)
            assert reason in said, (what, said)
            rejected += 1
    print(f"{rejected} changes rejected")

    folder_of_parts = os.path.join(folder, "parts")
    for shard in ("0/2", "1/2"):
        done = subprocess.run([CINCH, "verify", character, "--frames", "3", "--leaf", "4", "--certificate", "c.cert",
                               "--out", folder_of_parts, "--shard", shard], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
    done = subprocess.run([CINCH, "merge", folder_of_parts], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    status, said = run(os.path.join(folder_of_parts, "c.cert"))
    assert status == 0, said
