#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""test_tie.py COQC BUILT TIE: what extraction cannot prove is compared: zarith's whole numbers with Coq's, the proven
rounding with this machine's; and proofs notice when the checker is changed."""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

COQC, BUILT, TIE = sys.argv[1:4]

# A theory, what stands in it, what is put there, and the proof that fails
CHANGES = (
    ("numbers", "if Z.even q then Z.shiftl q s", "if Z.even q then Z.shiftl (q + 1) s", "numbers_proof"),
    ("numbers", "Definition subnormal_bits : Z := 1074.", "Definition subnormal_bits : Z := 1075.", "numbers_proof"),
    ("numbers", "n <=? Z.shiftl (man d) e", "n - 1 <=? Z.shiftl (man d) e", "numbers_proof"),
    ("evaluation", "option_map (Z.max (unit_along g x y z))", "option_map (fun s => Z.min s (unit_along g x y z))",
     "evaluation_proof"),
    ("tree", "is_tree (bv_count triangle_count : Z) (bs : list bv) : bool :=\n  each_once 1 (bv_count - 1)",
     "is_tree (bv_count triangle_count : Z) (bs : list bv) : bool :=\n  each_once 0 bv_count", "surface_proof"),
    ("duality", "if 0 <? x then most e else least e", "if x <? 0 then most e else least e", "duality_proof"),
    ("duality", "Some (l, h), None => Some (Z.min l 0, Z.max h 0)", "Some (l, h), None => Some (l, h)",
     "duality_proof"),
    ("checker", "(violated_said e =? 0)", "true", "run_proof"),
)


def compiled(folder, name):
    return subprocess.run([COQC, "-q", "-noglob", "-Q", folder, "CinchChecker", os.path.join(folder, name + ".v")],
                          capture_output=True, text=True, timeout=300, check=False)


def order():
    """The theories in the order in which they were compiled."""
    names = [name[:-2] for name in os.listdir(BUILT) if name.endswith(".v")]
    return sorted(names, key=lambda name: os.stat(os.path.join(BUILT, name + ".vo")).st_mtime_ns)


class TieTest(unittest.TestCase):
    def test_rounding_is_that_of_this_machine(self):
        done = subprocess.run([TIE, "rounding", "200000"], capture_output=True, text=True, check=False)
        self.assertEqual((done.returncode, done.stdout), (0, "200000 products and sums agree\n"))

    def test_whole_numbers_are_those_of_coq(self):
        claims = subprocess.run([TIE, "whole"], capture_output=True, text=True, check=True).stdout
        self.assertGreater(claims.count(";"), 1000)
        goals = claims.count("Goal ")
        self.assertGreaterEqual(goals, 18)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "Claims.v")

            def coq(text):
                with open(path, "w", encoding="ascii") as file:
                    file.write(text)
                return subprocess.run([COQC, "-q", "-noglob", path], capture_output=True, check=False).returncode

            self.assertEqual(coq(claims), 0)
            first, *rest = re.split(r"(?=Goal )", claims)
            wrong = re.sub(r"(-?\d+)\)\);", lambda m: f"{int(m[1]) + 1}));", rest[0], count=1)
            self.assertNotEqual(wrong, rest[0])  # one sum that is not so
            self.assertEqual(coq(first + rest[0]), 0)
            self.assertNotEqual(coq(first + wrong), 0)

    def test_proofs_notice_changes_of_the_checker(self):
        theories = order()
        share = min(1.0, float(os.environ.get("CINCH_TEST_SHARE", "1")))
        for theory, before, after, fails in CHANGES[::max(1, round(1 / share))]:
            with self.subTest(f"{theory}: {after}"), tempfile.TemporaryDirectory() as folder:
                for name in theories:
                    for ending in (".v", ".vo"):
                        shutil.copy2(os.path.join(BUILT, name + ending), folder)
                path = os.path.join(folder, theory + ".v")
                with open(path, encoding="utf-8") as file:
                    text = file.read()
                self.assertEqual(text.count(before), 1, before)
                with open(path, "w", encoding="utf-8") as file:
                    file.write(text.replace(before, after))
                for name in theories[theories.index(theory):]:
                    if compiled(folder, name).returncode:
                        self.assertEqual(name, fails)
                        break
                else:
                    self.fail("all proofs hold")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[4:])
