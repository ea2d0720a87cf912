#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""certificate_test.py CINCH CHECKER: certificates are accepted; after any change that matters, rejected in one line."""
import contextlib
import copy
import gzip
import io
import json
import math
import os
import random
import struct
import subprocess
import sys
import tempfile
import unittest
from fractions import Fraction

CINCH, CHECKER = sys.argv[1:3]
sys.dont_write_bytecode = True
sys.path[:0] = [os.path.dirname(CHECKER), os.path.dirname(os.path.abspath(__file__))]
import check_certificate  # noqa: E402
from certificate_forge import edited, of, sealed, written  # noqa: E402
import certificate_mutations_of_frames  # noqa: E402, F401
import certificate_mutations_of_surfaces  # noqa: E402, F401
import certificate_mutations_of_text  # noqa: E402, F401
from certificate_mutations import HARMLESS, MUTATIONS  # noqa: E402
from certificate_oracle import Oracle, double_or_ratio  # noqa: E402

ROWS = 6
ACCEPTED, REJECTED = 0, 1
CAPTURED = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}


def grid():
    """A bumpy sheet as an OBJ, with quads."""
    rng = random.Random(5)
    text = "".join(f"v {c + rng.uniform(-.2, .2):.6f} {r + rng.uniform(-.2, .2):.6f} {rng.uniform(-1, 1):.6f}\n"
                   for r in range(ROWS) for c in range(ROWS))
    for r in range(ROWS - 1):
        for c in range(ROWS - 1):
            a = r * ROWS + c + 1
            text += f"f {a} {a + 1} {a + ROWS + 1} {a + ROWS}\n"
    return text


def skin():
    """Weights that do not sum to 1, one vertex without any, and two clips of three frames."""
    rng = random.Random(6)
    weights = f"{ROWS * ROWS} 3\n"
    for k in range(ROWS * ROWS):
        weights += "2 2 0 1 0\n" if k == 7 else f"3 0 {rng.random():.9f} 2 {rng.random():.9f} 1 {rng.random():.9f}\n"
    frames = "2\n"
    for name in ("still", "wild"):
        frames += f"{name} 4 3\n"
        for t in range(4):
            frames += f"{t / 10} " + " ".join(f"{rng.uniform(-1, 1):.9f}" for _ in range(36)) + "\n"
    return weights, frames


def file_for(name):
    return "changed.jsonl.gz" if "gzip" in name else "changed.jsonl"


def run(*arguments):
    """Status and lines of the checker."""
    out = io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(out):
        status = check_certificate.main(list(arguments))
    return status, out.getvalue().splitlines()


class CertificateTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.mesh = written(cls.folder.name, grid().encode(), "grid.obj")
        cls.weights, cls.clips = (written(cls.folder.name, text.encode(), name)
                                  for text, name in zip(skin(), ("grid.weights.txt", "grid.frames.txt")))
        cls.skinned = "--weights", cls.weights, "--transforms", cls.clips
        cls.limited = cls.certificate(cls.mesh, "--nodes", "6", "--frames", "3", "--leaf", "4", "--method", "limited")
        cls.best = cls.certificate(cls.mesh, "--nodes", "6", "--frames", "2", "--leaf", "4", "--kdop", "14")

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    @classmethod
    def written_by_cinch(cls, *arguments, name="c.jsonl", status=0):
        path = os.path.join(cls.folder.name, name)
        done = subprocess.run([CINCH, "verify", *arguments, "--certificate", path], **CAPTURED)
        assert done.returncode == status, done.stdout
        return path

    @classmethod
    def certificate(cls, *arguments, **more):
        with open(cls.written_by_cinch(*arguments, **more), encoding="ascii") as file:
            return [json.loads(line) for line in file]

    def check(self, lines, *options, name="changed.jsonl"):
        return run(written(self.folder.name, lines, name), *options)

    def assert_rejected(self, verdict, reason, what):
        status, lines = verdict
        self.assertEqual((status, len(lines)), (REJECTED, 1), f"{what}: {status}, {lines}")
        self.assertIn("rejected: ", lines[0], what)
        self.assertIn(reason, lines[0], what)
        self.assertNotIn("not understood", lines[0], what)
        self.assertTrue(lines[0].isascii() and lines[0].isprintable(), what)

    def assert_accepted(self, verdict, what, text="accepted: "):
        status, lines = verdict
        self.assertEqual(status, ACCEPTED, f"{what}: {lines}")
        self.assertIn(text, lines[0], what)

    def test_mutations_are_rejected_in_one_line_each(self):
        self.assertGreaterEqual(len(MUTATIONS), 60)
        for name, (change, reason) in MUTATIONS.items():
            records = copy.deepcopy(self.best if "of best" in name else self.limited)
            changed = change(records)
            with self.subTest(name):
                if isinstance(changed, list) and isinstance(changed[0], dict):
                    self.assertTrue(json.dumps(changed) != json.dumps(self.best if "of best" in name else self.limited))
                self.assert_rejected(self.check(changed, name=file_for(name)), reason, name)

    def test_changes_of_nothing_are_accepted(self):
        for name, change in HARMLESS.items():
            for records in (self.limited, self.best):
                with self.subTest(name):
                    self.assert_accepted(self.check(change(copy.deepcopy(records)), name=file_for(name)), name)

    def test_files_that_are_none_are_rejected_in_one_line(self):
        path = os.path.join(self.folder.name, "none.jsonl")
        self.assert_rejected(run(path), "not readable", "missing")
        self.assert_rejected(run(self.folder.name), "not readable", "a folder")
        self.assert_rejected(run(self.mesh), "not JSON", "a mesh")
        done = subprocess.run([sys.executable, CHECKER, path + "\nx"], **CAPTURED)
        self.assertEqual((done.returncode, done.stdout.count("\n")), (REJECTED, 1), done.stdout)

    def test_every_byte_damaged_is_rejected_or_changes_nothing(self):
        data = "".join(json.dumps(r, separators=(",", ":")) + "\n" for r in self.limited).encode()
        rng, oracle = random.Random(7), Oracle(self.limited)
        for packed in (False, True):
            whole = gzip.compress(data, 1) if packed else data
            for _ in range(150):
                i = rng.randrange(len(whole))
                damaged = rng.choice((whole[:i], whole[:i] + bytes([whole[i] ^ 1 << rng.randrange(8)]) + whole[i + 1:],
                                      whole[:i] + whole[i + rng.randrange(1, 300):]))
                status, lines = self.check(damaged)
                self.assertEqual(len(lines), 1, lines)
                self.assertNotIn("not understood", lines[0])
                if status == ACCEPTED:  # another lambda, or another bound that is true
                    changed = (gzip.decompress(damaged) if packed else damaged).decode().splitlines()
                    for before, after in zip(self.limited, map(json.loads, changed), strict=True):
                        self.assertEqual(*({k: v for k, v in r.items() if k not in ("bounds", "lambda")}
                                           for r in (before, after)))
                        for d, bound in enumerate(after.get("bounds", ())):
                            if bound != before["bounds"][d]:
                                support = oracle.support(after["frame"], after["bv"], d)
                                self.assertGreaterEqual(Fraction(float.fromhex(bound)), support)

    def test_every_method_and_its_argument(self):
        duality = ("--method eq12 --kdop 14", "--method convex --kdop 18", "--method corners", "--method limited+eq12")
        vertices = ("--method limited --rest obb", "--method vertices --kdop 26", "--method support+limited",
                    "--method sphere", "--method local", "--method linear")
        for i, arguments in enumerate(duality + vertices):
            records = self.certificate(self.mesh, "--nodes", "5", "--frames", "2", *arguments.split(),
                                       name=f"{i}.jsonl")
            self.assertEqual("lambda" in records[-2], arguments in duality, arguments)
            self.assert_accepted(self.check(records), arguments)
            bound = records[-2]["bounds"]
            bound[0] = (float.fromhex(bound[0]) - 1e3).hex()  # below a vertex
            self.assert_rejected(self.check(sealed(records)), "beyond the bound", arguments)

    def test_compressed_by_cinch(self):
        self.assert_accepted(run(self.written_by_cinch(self.mesh, "--frames", "1", name="c.jsonl.gz")), "gz")

    def test_bounds_are_tight_to_the_last_bit(self):
        """Of `vertices` and of D(lambda): one double lower is refused."""
        records = self.certificate(self.mesh, "--nodes", "6", "--frames", "2", "--method", "vertices")
        refused = 0
        for i in of(records, "bounds")[:10]:
            for d in range(6):
                changed = copy.deepcopy(records)
                x = float.fromhex(changed[i]["bounds"][d])
                for _ in range(64):
                    x = math.nextafter(x, -math.inf)
                changed[i]["bounds"][d] = x.hex()
                refused += self.check(changed)[0] == REJECTED
        self.assertEqual(refused, 60)

    def test_100_bounds_lowered_are_refused_exactly_when_below_the_optimum_or_a_vertex(self):
        rng, refused = random.Random(1), 0
        surface = Oracle(self.limited)
        for _ in range(100):
            changed = copy.deepcopy(self.limited)
            record = changed[rng.choice(of(changed, "bounds"))]
            d = rng.randrange(6)
            bound, lam = float.fromhex(record["bounds"][d]), double_or_ratio(record["lambda"][d])
            lowest = max(surface.dual(record["frame"], record["bv"], d, lam),
                         surface.support(record["frame"], record["bv"], d))
            lowered = bound - abs(bound) * 2.0 ** rng.randrange(-20, 0)
            record["bounds"][d] = lowered.hex()
            verdict = self.check(changed)
            if Fraction(lowered) < lowest:
                self.assert_rejected(verdict, "bound", record)
                refused += 1
            elif verdict[0] == REJECTED:  # only the computed vertex is left; it is within rounding of the exact one
                self.assertIn("as computed", verdict[1][0])
                self.assertLess(Fraction(lowered) - lowest, Fraction(1, 10**12))
        self.assertGreater(refused, 50)

    def test_whatever_an_attacker_seals_and_gets_accepted_is_true(self):
        """Random edits with hashes that fit; what is accepted is checked against supports in fractions."""
        rng, accepted = random.Random(8), 0
        for _ in range(400):
            records = copy.deepcopy(self.limited)
            for _ in range(rng.randrange(1, 3)):
                edited(records, rng)
            try:
                records = sealed(records)
            except (KeyError, TypeError, ValueError, IndexError, struct.error, OverflowError):
                continue
            status, lines = self.check(records)
            self.assertEqual(len(lines), 1, lines)
            self.assertNotIn("not understood", lines[0])
            if status == ACCEPTED:
                accepted += 1
                oracle = Oracle(records)
                leaves = [t for r in oracle.bvs for t in r.get("triangles", ())]
                self.assertEqual(sorted(leaves), list(range(len(oracle.triangles))))
                self.assertEqual(oracle.vertices(0), {v for t in oracle.triangles for v in t})
                for r in (records[i] for i in of(records, "bounds")):
                    for d, bound in enumerate(r["bounds"]):
                        if bound != "inf":
                            self.assertGreaterEqual(Fraction(float.fromhex(bound)),
                                                    oracle.support(r["frame"], r["bv"], d))
        self.assertGreater(accepted, 20)

    def test_infinite_bounds_are_counted_apart(self):
        text = skin()[1].replace("wild", "far").split("\n")
        text[-2] = text[-2].replace(text[-2].split()[4], "1e200", 1)
        clips = written(self.folder.name, "\n".join(text).encode(), "far.frames.txt")
        path = self.written_by_cinch(self.mesh, "--weights", self.weights, "--transforms", clips, "--clip", "far",
                                     "--leaf", "4")
        status, lines = run(path)
        self.assertEqual(status, ACCEPTED, lines)
        proven, infinite = int(lines[0].split()[2]), int(lines[0].split()[5])
        with open(path, encoding="ascii") as file:
            bounds = [x for line in file for x in json.loads(line).get("bounds", ())]
        self.assertGreater(infinite, 0)
        self.assertEqual((proven, infinite), (len(bounds) - bounds.count("inf"), bounds.count("inf")))

    def test_a_run_that_found_violations_is_no_certificate(self):
        records = self.certificate(self.mesh, "--sabotage", "lower-h", "--frames", "1", status=1)
        self.assert_rejected(self.check(records), "bounds violated", "sabotage")

    def test_partial_certificates_say_so(self):
        records = copy.deepcopy(self.limited)
        records[0].update(partial=True, missing=["morph targets", "wheel\n\ud800"])
        status, lines = self.check(sealed(records))
        self.assertEqual((status, len(lines)), (ACCEPTED, 1), lines)
        self.assertIn(r"accepted: partial (missing: morph targets, wheel\n\ud800): ", lines[0])

    def test_a_mesh_with_a_scripted_motion_is_tied(self):
        self.assert_accepted(self.check(self.best, "--input", self.mesh), "OBJ")
        self.assertIn("centred and scaled", self.check(self.best, "--input", self.mesh)[1][1])
        lines = grid().splitlines()
        faces = [line.split()[1:] for line in lines if line[0] == "f"]
        points = [line[2:] for line in lines if line[0] == "v"]
        off = f"OFF\n{len(points)} {len(faces)} 0\n" + "\n".join(points) + "\n"
        off += "".join(f"4 {' '.join(str(int(v) - 1) for v in f)}\n" for f in faces)
        self.assert_accepted(self.check(self.best, "--input", written(self.folder.name, off.encode(), "grid.OFF")),
                             "OFF")
        relative = [" ".join(["f", *(f"{int(v) - 1 - ROWS * ROWS}/1/-1" for v in line.split()[1:])])
                    if line[0] == "f" else line for line in lines]
        whole = "\n".join(lines)
        for name, text, wanted in (
            ("relative indices", "\r".join(relative), True),
            ("continued lines", whole.replace(" 8 ", " \\\n8 "), True),
            ("comments, lines and points", "# x\n" + "\r\n".join(lines) + "\nl 1 2\np 1\nf 1 2 # 3\ng a", True),
            ("a vertex moved", whole.replace("5.", "6.", 1), False),
            ("a face turned", whole.replace("f 1 2 8 7", "f 1 7 8 2"), False),
            ("a face less", "\n".join(lines[:-1]), False),
            ("a face more", "\n".join(lines + lines[-1:]), False),
            ("a vertex more", "v 0 0 0\n" + whole, False),
        ):
            with self.subTest(name):
                verdict = self.check(self.best, "--input", written(self.folder.name, text.encode(), "other.obj"))
                if wanted:
                    self.assert_accepted(verdict, name)
                else:
                    self.assert_rejected(verdict, "are not those of", name)

    def test_a_skin_is_tied_with_weights_and_frames(self):
        for frames in ("4", "2", "1"):
            records = self.certificate(self.mesh, *self.skinned, "--clip", "wild", "--frames", frames)
            verdict = self.check(records, "--input", self.mesh, *self.skinned)
            self.assert_accepted(verdict, frames)
            self.assertIn(f"{frames} of 4 frames of clip \"wild\"", verdict[1][2])
        records = self.certificate(self.mesh, *self.skinned, "--clip", "wild")
        other = copy.deepcopy(records)
        other[0]["clip"] = "still"
        self.assert_rejected(self.check(sealed(other), "--input", self.mesh, *self.skinned), "none of those of clip",
                             "another clip")
        swapped = copy.deepcopy(records)
        first, second = of(swapped, "maps")[:2]
        for field in ("time", "maps"):
            swapped[first][field], swapped[second][field] = swapped[second][field], swapped[first][field]
        for i in of(swapped, "bounds"):
            swapped[i]["bounds"] = [(1e3).hex()] * 6
        self.assert_accepted(self.check(sealed(swapped)), "frames swapped, bounds true")
        self.assert_rejected(self.check(sealed(swapped), "--input", self.mesh, *self.skinned), "not in their order",
                             "frames swapped")
        weights, clips = skin()
        lines = weights.splitlines()
        lines[3] = lines[3].replace(lines[3].split()[2], f"{float(lines[3].split()[2]) + 1e-9:.9f}")
        path = written(self.folder.name, "\n".join(lines).encode(), "other.weights.txt")
        verdict = self.check(records, "--input", self.mesh, "--weights", path, "--transforms", self.clips)
        self.assert_rejected(verdict, "weights of vertex 2", "a weight moved")
        verdict = self.check(self.best, "--input", self.mesh, *self.skinned)
        self.assert_rejected(verdict, "positions are not those", "scripted, but a skin is given")

    def test_files_that_cannot_be_tied_are_errors_of_usage(self):
        for name, data in (
            ("x.obj", b"v 1 2\nf 1 1 1\n"), ("x.obj", b"v 0 0 0\nf 1 1 2\n"), ("x.obj", b"\xff\x00"),
            ("x.obj", b"v nan 0 0\nf 1 1 1\n"), ("x.obj", b"v 1e999 0 0\nf 1 1 1\n"), ("x.ply", b"ply\n"),
            ("x.off", b""),
            ("x.off", b"OFF\n3 1 0\n0 0 0\n"), ("x.off", b"OFF\n1 1 0\n0 0 0\n3 0 0 1\n"),
        ):
            status, lines = self.check(self.best, "--input", written(self.folder.name, data, name))
            self.assertEqual((status, len(lines)), (2, 1), f"{data}: {lines}")
        for options in (("--weights", self.weights), ("--input", self.mesh, "--weights", self.weights), ("--nothing",)):
            done = subprocess.run([sys.executable, CHECKER, self.mesh, *options], **CAPTURED)
            self.assertEqual(done.returncode, 2)
            self.assertNotIn("Traceback", done.stdout)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
