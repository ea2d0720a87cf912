#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""test_assumptions.py COQC BUILT: the theorems rest on the axioms of assumptions.txt and on nothing else, and the
sources admit nothing. BUILT: the folder of the compiled theories. What would be wrong is tried, and found."""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

COQC, BUILT = sys.argv[1:3]
HERE = os.path.dirname(os.path.abspath(__file__))
THEOREMS = ("accepted_certificates_are_true", "accepted_certificates_hold_in_ieee_arithmetic")
UNPROVEN = re.compile(r"\b(Admitted|admit|Axioms?|Parameters?|Conjectures?|Hypothes[ie]s|Variables?|Abort|give_up|"
                      r"bypass_check|Unset\s+(Guard|Universe|Positivity)\s+Checking)\b")


def without_comments(text):
    return re.sub(r"\(\*.*?\*\)", " ", text, flags=re.DOTALL)


def unproven_in(folder):
    found = []
    for name in sorted(os.listdir(folder)):
        if name.endswith(".v"):
            with open(os.path.join(folder, name), encoding="utf-8") as file:
                found += [f"{name}: {m[0]}" for m in UNPROVEN.finditer(without_comments(file.read()))]
    return found


def compiled(folder, path):
    return subprocess.run([COQC, "-q", "-noglob", "-Q", folder, "CinchChecker", path], capture_output=True, text=True,
                          timeout=300, check=False)


def assumptions(folder, *theorems):
    """Names of the axioms that Coq prints."""
    with tempfile.TemporaryDirectory() as scratch:
        path = os.path.join(scratch, "Asked.v")
        with open(path, "w", encoding="ascii") as file:
            file.write("From CinchChecker Require Import soundness.\n")
            file.writelines(f"Print Assumptions {t}.\n" for t in theorems)
        done = compiled(folder, path)
    assert done.returncode == 0, done.stderr
    return set(re.findall(r"^([A-Za-z_][\w.]*)\s*:", done.stdout, re.MULTILINE)) - {"Axioms"}


class AssumptionsTest(unittest.TestCase):
    def test_assumptions_are_those_of_the_standard_real_numbers(self):
        with open(os.path.join(HERE, "assumptions.txt"), encoding="ascii") as file:
            allowed = set(file.read().split())
        for theorem in THEOREMS:
            self.assertEqual(assumptions(BUILT, theorem), allowed, theorem)

    def test_sources_admit_nothing(self):
        self.assertEqual(unproven_in(HERE), [])

    def test_an_admitted_lemma_is_found_in_both_ways(self):
        with tempfile.TemporaryDirectory() as folder:
            for name in os.listdir(BUILT):
                if name.endswith((".v", ".vo")):
                    shutil.copy2(os.path.join(BUILT, name), folder)
            path = os.path.join(folder, "run_proof.v")
            with open(path, encoding="utf-8") as file:
                text = file.read()
            first = text.index("Theorem accepted_is_checked")
            with open(path, "w", encoding="utf-8") as file:
                file.write(text[:first] + text[first:].partition("Proof.")[0] + "Admitted.\n")
            self.assertEqual(unproven_in(folder), ["run_proof.v: Admitted"])
            for name in ("run_proof", "surface_proof", "frame_proof", "soundness"):
                self.assertEqual(compiled(folder, os.path.join(folder, name + ".v")).returncode, 0, name)
            self.assertIn("accepted_is_checked", {n.split(".")[-1] for n in assumptions(folder, THEOREMS[0])})


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
