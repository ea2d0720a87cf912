#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""test_checker.py CINCH_CHECK [CINCH]: cinch-check gives the verdicts of check_certificate.py, on certificates and on
whatever is done to them. Certificates are made from the formulas alone; with the program CINCH, its own too."""
import contextlib
import copy
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

CHECK = sys.argv[1]
CINCH = sys.argv[2] if len(sys.argv) > 2 and not sys.argv[2].startswith("-") else None
HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.normpath(os.path.join(HERE, "..", "..", ".."))
sys.dont_write_bytecode = True
sys.path[:0] = [os.path.join(ROOT, "experiments"), os.path.join(ROOT, "tests", "experiments"), HERE]
import check_certificate  # noqa: E402
from certificate_forge import edited, in_utf8, of, sealed, written  # noqa: E402
import certificate_mutations_of_frames  # noqa: E402, F401
import certificate_mutations_of_surfaces  # noqa: E402, F401
import certificate_mutations_of_text  # noqa: E402, F401
from certificate_made import made  # noqa: E402
from certificate_mutations import HARMLESS, MUTATIONS  # noqa: E402
from reader_attacks import ATTACKS  # noqa: E402

ACCEPTED, REJECTED = 0, 1


def text_of(records):
    return in_utf8("".join(json.dumps(r) + "\n" for r in records))


def by_python(path):
    out = io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(out):
        status = check_certificate.main([path])
    return status, out.getvalue().strip()


def by_cinch_check(path):
    """Status and line; a file that gzip finds damaged is rejected by who unpacks it."""
    with open(path, "rb") as file:
        packed = file.read(2) == b"\x1f\x8b"
    if packed:
        unpacked = subprocess.run(["gzip", "-dc", path], capture_output=True, check=False)
        if unpacked.returncode:
            return REJECTED, "rejected: " + unpacked.stderr.decode(errors="replace").strip()
        done = subprocess.run([CHECK], input=unpacked.stdout, capture_output=True, check=False)
    else:
        done = subprocess.run([CHECK, path], capture_output=True, check=False)
    return done.returncode, (done.stdout + done.stderr).decode(errors="replace").strip()


class CheckerTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.limited, cls.best = made(), made(method="best", kdop=14, frames=2)
        cls.rejected = 0
        if CINCH:
            path = os.path.join(cls.folder.name, "cinch.obj")
            with open(path, "w", encoding="ascii") as file:
                file.write(grid())
            cls.mesh = path

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def verdicts(self, lines, what, name="changed.jsonl"):
        """The verdict of both, which must be one."""
        path = written(self.folder.name, lines, name)
        (python, reason), (coq, line) = by_python(path), by_cinch_check(path)
        self.assertEqual(python, coq, f"{what}: {reason} | {line}")
        self.assertIn(": accepted: " if coq == ACCEPTED else "rejected: ", line, what)
        self.assertEqual(line.count("\n"), 0, f"{what}: {line}")
        self.assertNotIn("not understood", line, what)
        return coq

    def assert_rejected(self, lines, what, **more):
        self.assertEqual(self.verdicts(lines, what, **more), REJECTED, what)

    def assert_accepted(self, lines, what, **more):
        self.assertEqual(self.verdicts(lines, what, **more), ACCEPTED, what)

    def originals(self):
        return (("limited", self.limited), ("best", self.best))

    def test_certificates_are_accepted_with_the_same_counts(self):
        for method, kdop in (("limited", 6), ("limited", 18), ("best", 14), ("vertices", 26), ("best", 6)):
            records = made(seed=kdop, method=method, kdop=kdop, frames=2)
            self.assert_accepted(records, f"{method} {kdop}")
            path = written(self.folder.name, records)
            self.assertEqual(by_python(path)[1].partition(": ")[2], by_cinch_check(path)[1].partition(": ")[2])

    def test_mutations_are_rejected_by_both(self):
        self.assertGreaterEqual(len(MUTATIONS), 190)
        for name, (change, _) in MUTATIONS.items():
            with self.subTest(name):
                records = copy.deepcopy(self.best if "of best" in name else self.limited)
                packed = "changed.jsonl.gz" if "gzip" in name else "changed.jsonl"
                self.assert_rejected(change(records), name, name=packed)

    def test_changes_of_nothing_and_wider_bounds_are_accepted_by_both(self):
        for name, change in HARMLESS.items():
            for method, records in self.originals():
                with self.subTest(f"{name}, {method}"):
                    self.assert_accepted(change(copy.deepcopy(records)), name, name="changed.jsonl")

    def test_attacks_on_the_reader_have_one_verdict(self):
        """What a reader might take for something else: numbers, texts, ends of lines and of the file."""
        accepted = 0
        for name, (attack, wanted) in ATTACKS.items():
            for method, records in self.originals():
                with self.subTest(f"{name}, {method}"):
                    verdict = self.verdicts(attack(text_of(records)), name)
                    self.assertEqual(verdict, wanted, name)
                    accepted += verdict == ACCEPTED
        self.assertGreater(accepted, 0)

    def test_every_bound_is_as_tight_as_it_says(self):
        """One double lower is rejected, one double higher accepted, both sealed or not."""
        rng = random.Random(2)
        for method, original in self.originals():
            for i in rng.sample(of(original, "bounds"), 25):
                for towards, wanted in ((-math.inf, REJECTED), (math.inf, ACCEPTED)):
                    records = copy.deepcopy(original)
                    d = rng.randrange(len(records[i]["bounds"]))
                    bound = float.fromhex(records[i]["bounds"][d])
                    records[i]["bounds"][d] = math.nextafter(bound, towards).hex()
                    self.assertEqual(self.verdicts(records, f"{method}: bound {i} {d}"), wanted)

    def test_random_edits_have_one_verdict(self):
        """Of values anywhere and of the list of records, sealed with hashes and counts that fit, and not."""
        counts = {ACCEPTED: 0, REJECTED: 0}
        for seed in range(600):
            rng = random.Random(seed)
            records = copy.deepcopy(self.limited if seed % 3 else self.best)
            for _ in range(rng.randrange(1, 3)):
                edited(records, rng)
            if seed % 2:
                try:
                    records = sealed(records)
                except (KeyError, TypeError, ValueError, IndexError, struct.error, OverflowError):
                    pass
            counts[self.verdicts(records, f"seed {seed}")] += 1
        self.assertGreater(counts[ACCEPTED], 15)
        self.assertGreater(counts[REJECTED], 200)

    def test_damaged_bytes_have_one_verdict(self):
        rng = random.Random(3)
        for method, records in self.originals():
            data = "".join(json.dumps(r, separators=(",", ":")) + "\n" for r in records).encode()
            for n in range(150):
                i = rng.randrange(len(data))
                damaged = rng.choice((data[:i], data[:i] + bytes([data[i] ^ 1 << rng.randrange(8)]) + data[i + 1:],
                                      data[:i] + data[i + rng.randrange(1, 300):],
                                      data[:i] + data[i:i + 1] + data[i:]))
                self.verdicts(damaged, f"{method}: damage {n}")

    def test_overflow_on_the_way_is_no_finite_bound(self):
        """A vertex of doubles that is not finite proves no bound, one that is near the greatest double does."""
        for scale, wanted in (("0x1p+1020", ACCEPTED), ("0x1.fffffffffffffp+1023", REJECTED)):
            records = made(method="best", frames=1, nodes=1)
            for i in of(records, "maps"):
                records[i]["maps"] = [[scale, *["0x0p+0"] * 3] * 3]
            for i in of(records, "rest"):
                records[i]["rest"] = ["0x1.8p+0"] * 3
            for i in of(records, "bounds"):
                records[i]["bounds"] = [(1.5 * float.fromhex("0x1p+1020")).hex(), "0x0p+0"] * 3 \
                    if wanted == ACCEPTED else ["0x1.fffffffffffffp+1023"] * 6
            self.assertEqual(self.verdicts(sealed(records), scale), wanted)
            for i in of(records, "bounds"):
                records[i]["bounds"] = ["inf"] * 6
            self.assert_accepted(sealed(records), "infinite")

    def test_what_is_of_others_is_refused_by_name(self):
        for header, what in (('{"certificate": "cinch times 2"}', "bounds over time"),
                             ('{"certificate": "cinch 2", "targets": 1}', "morph targets")):
            status, line = by_cinch_check(written(self.folder.name, [header]))
            self.assertEqual(status, REJECTED)
            self.assertIn("not of this checker: " + what, line)

    def test_usage(self):
        for arguments, status in ((["--help"], 0), (["--nothing"], 2), (["a", "b"], 2), (["/no/such/file"], 1)):
            self.assertEqual(subprocess.run([CHECK, *arguments], capture_output=True, check=False).returncode, status)

    @unittest.skipUnless(CINCH, "the program cinch is not given")
    def test_certificates_of_cinch(self):
        for i, options in enumerate(("--method limited", "--kdop 14", "--method eq12 --kdop 26", "--method convex",
                                     "--method limited --rest obb", "--method vertices --kdop 18",
                                     "--method support+limited", "--method limited+eq12")):
            path = os.path.join(self.folder.name, f"{i}.jsonl")
            done = subprocess.run([CINCH, "verify", self.mesh, "--nodes", "6", "--frames", "2", "--leaf", "4",
                                   *options.split(), "--certificate", path],
                                  capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            with open(path, encoding="ascii") as file:
                records = [json.loads(line) for line in file]
            self.assert_accepted(records, options)
            for seed in range(40):
                changed = copy.deepcopy(records)
                edited(changed, random.Random(seed))
                self.verdicts(changed, f"{options}, seed {seed}")


def grid():
    """A bumpy sheet as an OBJ."""
    rng, rows = random.Random(5), 6
    text = "".join(f"v {c + rng.uniform(-.2, .2):.6f} {r + rng.uniform(-.2, .2):.6f} {rng.uniform(-1, 1):.6f}\n"
                   for r in range(rows) for c in range(rows))
    for r in range(rows - 1):
        for c in range(rows - 1):
            a = r * rows + c + 1
            text += f"f {a} {a + 1} {a + rows + 1} {a + rows}\n"
    return text


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + [a for a in sys.argv[2:] if a != CINCH])
