#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""certificate_test.py CINCH CHECKER: certificates are accepted, and rejected after any change that matters."""
import json
import os
import random
import subprocess
import sys
import tempfile
import unittest
from fractions import Fraction

CINCH, CHECKER = sys.argv[1:3]
sys.path.insert(0, os.path.dirname(CHECKER))
import check_certificate  # noqa: E402


def certificate(folder, arguments, name="c.jsonl"):
    path = os.path.join(folder, name)
    subprocess.run([CINCH, "verify", *(() if "--method" in arguments else ("--method", "limited")), *arguments.split(), "--certificate", path], check=True, stdout=subprocess.DEVNULL)
    return path


def verdict(lines):
    """None if accepted, else why not."""
    try:
        check_certificate.check(iter(lines))
        return None
    except check_certificate.Rejected as reason:
        return str(reason)


def extrema(bv, maps, axis, sign):
    """Exact extrema of the rest box, by its corners."""
    out = []
    for j in bv["nodes"]:
        m = [Fraction(float.fromhex(x)) for x in maps[j]]
        q = [sign * sum(a * m[4 * r + s] for r, a in enumerate(axis)) for s in range(4)]
        value = q[3]
        for s in range(3):
            c, e = (Fraction(float.fromhex(bv[field][s])) for field in ("centre", "half"))
            value += max(q[s] * (c - e), q[s] * (c + e))
        out.append(value)
    return out


def optimum(bv, b):
    """max sum w b over l <= w <= h, sum w = 1, by filling greedily."""
    l, h = ([Fraction(float.fromhex(x)) for x in bv[field]] for field in ("l", "h"))
    slack, value = 1 - sum(l), sum(x * y for x, y in zip(l, b))
    for j in sorted(range(len(b)), key=lambda j: -b[j]):
        step = min(slack, h[j] - l[j])
        value, slack = value + step * b[j], slack - step
    assert slack == 0
    return value


def dual(bv, b, lam):
    l, h = ([Fraction(float.fromhex(x)) for x in bv[field]] for field in ("l", "h"))
    return lam + sum((hj if bj > lam else lj) * (bj - lam) for lj, hj, bj in zip(l, h, b))


def digits(text):
    """Positions of the digits of a hexadecimal float's mantissa and exponent."""
    return [i for i in range(text.index("x") + 1, len(text)) if text[i] in "0123456789abcdef"]


def one_digit_changed(text, rng):
    i = rng.choice(digits(text))
    decimal = i > text.index("p") if "p" in text else False
    choice = rng.choice([d for d in ("0123456789" if decimal else "0123456789abcdef") if d != text[i]])
    return text[:i] + choice + text[i + 1:]


class CertificateTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        path = certificate(cls.folder.name, "santa --leaf 400 --frames 2")
        with open(path, encoding="ascii") as file:
            cls.lines = file.read().splitlines()
        cls.records = [json.loads(line) for line in cls.lines]
        cls.bvs = {r["bv"]: r for r in cls.records if "centre" in r}
        cls.maps = {r["frame"]: r["maps"] for r in cls.records if "maps" in r}
        cls.places = [i for i, r in enumerate(cls.records) if "bounds" in r]

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def changed(self, i, record):
        return self.lines[:i] + [json.dumps(record)] + self.lines[i + 1:]

    def b_of(self, record, d):
        axis = check_certificate.AXES[6][d // 2]
        return extrema(self.bvs[record["bv"]], self.maps[record["frame"]], axis, -1 if d % 2 else 1)

    def test_accepted(self):
        self.assertIsNone(verdict(self.lines))

    def test_every_method_and_compression(self):
        for i, arguments in enumerate(("--method eq12 --kdop 14", "--method convex --kdop 18", "--method vertices --kdop 26", "--kdop 6",
                                       "--method best --leaf 2000", "--method corners --leaf 2000")):
            path = certificate(self.folder.name, "santa --frames 1 " + arguments + ("" if "--leaf" in arguments else " --leaf 500"), f"{i}.jsonl.gz")
            done = subprocess.run([sys.executable, CHECKER, path], stdout=subprocess.PIPE, text=True)
            self.assertEqual(done.returncode, 0, done.stdout)
            self.assertIn("accepted", done.stdout)

    def test_100_bounds_lowered_below_the_optimum_are_caught(self):
        rng, caught = random.Random(1), 0
        while caught < 100:
            i = rng.choice(self.places)
            record = json.loads(self.lines[i])
            d = rng.randrange(6)
            lowered = one_digit_changed(record["bounds"][d], rng)
            if abs(float.fromhex(lowered)) == float("inf"):
                continue
            if Fraction(float.fromhex(lowered)) >= optimum(self.bvs[record["bv"]], self.b_of(record, d)):
                continue  # still a bound
            record["bounds"][d] = lowered
            self.assertIsNotNone(verdict(self.changed(i, record)), f"{record} direction {d}")
            caught += 1

    def test_bounds_one_step_below_D_of_lambda_are_caught(self):
        i = self.places[3]
        record = json.loads(self.lines[i])
        value = dual(self.bvs[record["bv"]], self.b_of(record, 2), Fraction(float.fromhex(record["lambda"][2])))
        below = float(value)
        while Fraction(below) >= value:
            below = check_certificate.math.nextafter(below, -1e300)
        record["bounds"][2] = below.hex()
        self.assertIn("lies below D(lambda)", verdict(self.changed(i, record)))

    def test_lambdas_that_matter_are_caught_and_others_accepted(self):
        rng, mattered = random.Random(2), 0
        while mattered < 20:
            i = rng.choice(self.places)
            record = json.loads(self.lines[i])
            d = rng.randrange(6)
            record["lambda"][d] = one_digit_changed(record["lambda"][d], rng)
            lam = float.fromhex(record["lambda"][d])
            bound = Fraction(float.fromhex(record["bounds"][d]))
            matters = abs(lam) == float("inf") or dual(self.bvs[record["bv"]], self.b_of(record, d), Fraction(lam)) > bound
            self.assertEqual(verdict(self.changed(i, record)) is not None, matters)
            mattered += matters

    def test_weights_and_intervals_are_caught(self):
        rng = random.Random(3)
        vertices = [i for i, r in enumerate(self.records) if "vertex" in r]
        for _ in range(20):
            i = rng.choice(vertices)
            record = json.loads(self.lines[i])
            j = rng.randrange(len(record["weights"]))
            record["weights"][j] = one_digit_changed(record["weights"][j], rng)
            self.assertIsNotNone(verdict(self.changed(i, record)))
        boxes = [i for i, r in enumerate(self.records) if "centre" in r]
        for field, change in (("h", lambda x: x - 2.0**-53), ("half", lambda x: x * (1 - 2.0**-40))):
            for _ in range(5):
                i = rng.choice(boxes)
                record = json.loads(self.lines[i])
                record[field][0] = change(float.fromhex(record[field][0])).hex()
                self.assertIsNotNone(verdict(self.changed(i, record)), field)

    def test_missing_or_repeated_lines_are_caught(self):
        rng = random.Random(4)
        for _ in range(20):
            i = rng.randrange(1, len(self.lines))
            try:
                self.assertIsNotNone(verdict(self.lines[:i] + self.lines[i + 1:]))
            except (KeyError, IndexError, TypeError, AttributeError):
                pass  # not readable: refused as well
        self.assertIsNotNone(verdict(self.lines[:-1]))
        self.assertIsNotNone(verdict(self.lines + [self.lines[-1]]))
        with self.assertRaises(ValueError):
            verdict(["{}"])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
