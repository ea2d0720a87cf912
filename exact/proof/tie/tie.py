#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The tie between the proofs and the C++ that they are about.

    tie.py compare COMPARE [--cases N] [--seed S] [--program CASES]
    tie.py mutations COMPARE

COMPARE is the extracted model with its reader (exact/proof/check builds it). `compare` prints inputs and results of the
compiled functions and has the model compute the same: exit status 0 if every bit agrees. `mutations` changes one
constant, one order of a sum, one succ at a time in copies of the sources: 0 if each such change is noticed.
The sources are compiled here by $CXX, as CMakeLists.txt does, unless CASES names a program that was.
"""

import argparse
import os
import pathlib
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[2]
SOURCES = ["toolkit/bounds/weight_space.cpp", "toolkit/bounds/bound_box.cpp", "toolkit/deform/evaluate.cpp",
           "toolkit/collide/orientation.cpp", "toolkit/bounds/bound_vertex.cpp", "toolkit/time/interval_refit.cpp",
           "exact/proof/tie/cases.cpp"]
ROUNDING, (WEIGHTS, BOX, EVALUATE, ORIENTATION, VERTEX, TIME, _) = "toolkit/bounds/rounding.hpp", SOURCES
MEAN = "toolkit/bounds/greatest_mean.hpp"

# File, what stands there exactly once, and what is put in its place. (Not here, as they change nothing: without
# "!(absolute < infinite)" in dual_bound an infinite sum makes the error term infinite, or no number, all the same; in
# greatest_between least + path is the less of two only where both are below the greatest end.)
MUTATIONS = [
    (ROUNDING, "succ(10 * unit_roundoff", "succ(9 * unit_roundoff"),
    (ROUNDING, "largest_magnitude + 16 *", "largest_magnitude + 15 *"),
    (ROUNDING, "succ(10 * unit_roundoff * largest_magnitude + 16 * smallest_subnormal)",
     "(10 * unit_roundoff * largest_magnitude + 16 * smallest_subnormal)"),
    (ROUNDING, "succ((influences + 8)", "succ((influences + 7)"),
    (ROUNDING, "smallest_times<double>(8 *", "smallest_times<double>(7 *"),
    (ROUNDING, "return succ((influences + 8)", "return ((influences + 8)"),
    (ROUNDING, "succ((nodes + 4)", "succ((nodes + 3)"),
    (ROUNDING, "absolute_sum + smallest_times<double>(static_cast<std::size_t>(nodes))",
     "absolute_sum + smallest_times<double>(static_cast<std::size_t>(nodes) / 2)"),
    (ROUNDING, "return succ((nodes + 4)", "return ((nodes + 4)"),
    (ROUNDING, "(1 + 2 * unit_roundoff_of<T>)", "1"),
    (ROUNDING, "(phi * std::abs(x) + smallest_subnormal_of<T>)", "(phi * std::abs(x))"),
    (ROUNDING, "return x + (phi * std::abs(x) + smallest_subnormal_of<T>);",
     "return (x + phi * std::abs(x)) + smallest_subnormal_of<T>;"),
    (ROUNDING, "unit_roundoff = 0x1p-53", "unit_roundoff = 0x1p-54"),
    (ROUNDING, "smallest_subnormal = 0x1p-1074", "smallest_subnormal = 0x1p-1075"),
    (ROUNDING, "T(0x1p-24)", "T(0x1p-25)"),
    (ROUNDING, "std::uint64_t>>(n));", "std::uint64_t>>(n - (n > 1)));"),
    (WEIGHTS, "? space.h[j] : space.l[j])", "? space.l[j] : space.h[j])"),
    (WEIGHTS, "for (std::size_t j = 0; j < b.size(); ++j) {\n        const double above",
     "for (std::size_t j = b.size(); j-- > 0;) {\n        const double above"),
    (WEIGHTS, "succ(lambda + succ(sum", "(lambda + succ(sum"),
    (WEIGHTS, "lambda + succ(sum + sum_error(static_cast<double>(b.size()), absolute))",
     "lambda + (sum + sum_error(static_cast<double>(b.size()), absolute))"),
    (WEIGHTS, "sum_error(static_cast<double>(b.size()),", "sum_error(static_cast<double>(b.size() - 1),"),
    (WEIGHTS, "absolute += std::abs(term)", "absolute += term"),
    (WEIGHTS, "            second = first;\n", ""),
    (BOX, "((g[0] * c[0] + g[1] * c[1]) + g[2] * c[2]) + g[3]", "(g[0] * c[0] + (g[1] * c[1] + g[2] * c[2])) + g[3]"),
    (BOX, "(std::abs(g[0]) * e[0] + std::abs(g[1]) * e[1]) + std::abs(g[2]) * e[2]",
     "std::abs(g[0]) * e[0] + (std::abs(g[1]) * e[1] + std::abs(g[2]) * e[2])"),
    (BOX, "a[1] * (std::abs(c[1]) + e[1])", "a[1] * std::abs(c[1])"),
    (BOX, "a[2] * (std::abs(c[2]) + e[2])) + a[3]", "a[2] * (std::abs(c[2]) + e[2]))"),
    (BOX, "out.minus[i] = radius - p", "out.minus[i] = radius + p"),
    (BOX, "finite &= magnitude < infinite;", "finite &= true;"),
    (BOX, "largest = std::max(largest, magnitude)", "largest = magnitude"),
    (BOX, "succ(extremum_error(magnitude) + evaluation_error(bv.vertex_influences, magnitude))",
     "extremum_error(magnitude) + evaluation_error(bv.vertex_influences, magnitude)"),
    (BOX, "extremum_error(magnitude) + evaluation_error(bv.vertex_influences, magnitude)", "extremum_error(magnitude)"),
    (BOX, "succ(bound + error)", "(bound + error)"),
    (BOX, "std::min(bound, dual_bound(space, b, best_lambda", "std::max(bound, dual_bound(space, b, best_lambda"),
    (BOX, "succ(4 * (n + 8)", "succ(4 * (n + 7)"),
    (BOX, "succ(4 * (n + 8)", "succ(3 * (n + 8)"),
    (BOX, "magnitude + 2 * n * smallest", "magnitude + 1 * n * smallest"),
    (BOX, "succ(best + succ(", "(best + succ("),
    (BOX, "raised + (slack - range) * b[j]", "(base + (slack - range) * b[j]) + range * b[i]"),
    (BOX, "most_safe = 0x1p1020", "most_safe = 0x1p1021"),
    (BOX, "if (!(magnitude < most_safe))", "if (!(magnitude <= most_safe))"),
    (MEAN, "+ 8) * 0x1p-51", "+ 7) * 0x1p-51"),
    (MEAN, "+ 8) * 0x1p-51", "+ 8) * 0x1p-52"),
    (MEAN, "smallest_times<double>(2 *", "smallest_times<double>(1 *"),
    (MEAN, "sum += bv.space.l[j] * above + (bv.space.h[j] - bv.space.l[j]) * std::max(above, 0.0);",
     "sum = (sum + bv.space.l[j] * above) + (bv.space.h[j] - bv.space.l[j]) * std::max(above, 0.0);"),
    (MEAN, "std::max(second, std::min(c, most))", "std::max(second, c < most ? c : 0)"),
    (MEAN, "return std::min(most, sum + rounding)", "return sum + rounding"),
    (TIME, "0x1p-49 * (std::abs(first) + std::abs(last) + bump)",
     "0x1p-50 * (std::abs(first) + std::abs(last) + bump)"),
    (TIME, "0x1p-49 * (std::abs(first) + std::abs(last) + path)",
     "0x1p-50 * (std::abs(first) + std::abs(last) + path)"),
    (TIME, "+ 4 * smallest_subnormal", "+ 3 * smallest_subnormal"),
    (TIME, "+ path) + smallest_subnormal)", "+ path))"),
    (TIME, "d * (d / bump / 16)", "d * d / bump / 16"),
    (TIME, "d * (d / bump / 16)", "d * (d / bump / 15)"),
    (TIME, "most_safe = 0x1p1020", "most_safe = 0x1p1021"),
    (TIME, "parabola = bump < most_safe ?", "parabola = bump < infinite ?"),
    (TIME, "return succ(std::min(parabola", "return (std::min(parabola"),
    (TIME, "return succ(most);", "return most;"),
    (TIME, "most - least >= 4 * bump", "most - least > 4 * bump"),
    (EVALUATE, "((m[r][0] * x + m[r][1] * y) + m[r][2] * z) + m[r][3]",
     "(m[r][0] * x + (m[r][1] * y + m[r][2] * z)) + m[r][3]"),
    (EVALUATE, "for (std::size_t i = 0; i < row.node.size(); ++i) {\n        const auto& m",
     "for (std::size_t i = row.node.size(); i-- > 0;) {\n        const auto& m"),
    (VERTEX, "succ(coordinate + error", "(coordinate + error"),
    (VERTEX, "succ(sum + upper)", "(sum + upper)"),
    (VERTEX, "(((std::abs(m[r][0] * rest[0]) + std::abs(m[r][1] * rest[1])) + std::abs(m[r][2] * rest[2])) +",
     "((std::abs(m[r][0] * rest[0]) + (std::abs(m[r][1] * rest[1]) + std::abs(m[r][2] * rest[2]))) +"),
    (VERTEX, "static_cast<double>(row.node.size())", "static_cast<double>(row.node.size() - 1)"),
    (ORIENTATION, "constant_3 = 49 *", "constant_3 = 48 *"),
    (ORIENTATION, "constant_2 = 9 *", "constant_2 = 8 *"),
    (ORIENTATION, "least_difference = 0x1p-320", "least_difference = 0x1p-321"),
    (ORIENTATION, "greatest_difference = 0x1p320", "greatest_difference = 0x1p321"),
    (ORIENTATION, "return (p[0] * (q[1] * r[2] - q[2] * r[1]) - q[0] * (p[1] * r[2] - p[2] * r[1])) +\n"
     "           r[0] * (p[1] * q[2] - p[2] * q[1]);",
     "return p[0] * (q[1] * r[2] - q[2] * r[1]) - (q[0] * (p[1] * r[2] - p[2] * r[1]) -\n"
     "           r[0] * (p[1] * q[2] - p[2] * q[1]));"),
    (ORIENTATION, "std::max({std::abs(p[i]), std::abs(q[i]), std::abs(r[i])})",
     "std::max(std::abs(p[i]), std::abs(q[i]))"),
    (ORIENTATION, "greatest{std::max(std::abs(p[0]), std::abs(q[0]))", "greatest{std::abs(p[0])"),
]

SHARE = min(1.0, float(os.environ.get("CINCH_TEST_SHARE", "1")))  # of the cases and of the mutations


class Compiler:
    """Compiles SOURCES into a folder, with an overlay of changed files before the tree."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        include = self.folder / "include/cinch"
        include.mkdir(parents=True, exist_ok=True)
        text = (ROOT / "toolkit/include/cinch/version.hpp.in").read_text()
        for name in ("PROJECT_VERSION", "PROJECT_VERSION_MAJOR", "PROJECT_VERSION_MINOR", "PROJECT_VERSION_PATCH"):
            text = text.replace(f"@{name}@", "0")
        (include / "version.hpp").write_text(text)
        self.objects = {}

    def compile(self, source, overlay=None):
        name = self.folder / ((overlay.name if overlay else "tree") + "-" + pathlib.Path(source).stem + ".o")
        file = overlay / source if overlay and (overlay / source).exists() else ROOT / source
        flags = ["-std=c++20", "-O1", "-ffp-contract=off", "-fno-fast-math", "-fno-tree-vectorize",
                 "-ffunction-sections"]
        where = ([f"-I{overlay}"] if overlay else []) + [
            f"-I{ROOT}", f"-I{ROOT / 'toolkit/include'}", f"-I{self.folder / 'include'}", "-I/usr/include/eigen3"]
        # An overlay's header must be found before the one beside the including file.
        subprocess.run([os.environ.get("CXX", "g++"), *flags, *where, "-c", str(file), "-o", str(name)], check=True)
        return name

    def program(self, overlay=None, changed=None):
        objects = []
        for source in SOURCES:
            if overlay and (source == changed or pathlib.Path(changed).name in (ROOT / source).read_text()):
                objects.append(self.compile(source, overlay))
            else:
                if source not in self.objects:
                    self.objects[source] = self.compile(source)
                objects.append(self.objects[source])
        out = self.folder / ((overlay.name if overlay else "tree") + "-cases")
        compiler = os.environ.get("CXX", "g++")
        subprocess.run([compiler, *map(str, objects), "-Wl,--gc-sections", "-o", str(out)], check=True)
        return out


def agree(program, compare, seed, cases, quiet=False):
    """Whether the model computes the bits that the program prints."""
    printing = subprocess.Popen([str(program), str(seed), str(cases)], stdout=subprocess.PIPE)
    model = subprocess.run([compare, "20", str(cases)], stdin=printing.stdout, capture_output=quiet, check=False)
    printing.stdout.close()
    printing.wait()
    return printing.returncode in (0, -13) and model.returncode == 0


def mutations(compare):
    missed = 0
    with tempfile.TemporaryDirectory() as folder:
        compiler = Compiler(folder)
        if not agree(compiler.program(), compare, 1, 4000, quiet=True):
            print("the sources as they are do not agree with the model")
            return 1
        tried = MUTATIONS[::max(1, round(1 / SHARE))]
        for i, (file, old, new) in enumerate(tried):
            start = time.time()
            text = (ROOT / file).read_text()
            if text.count(old) != 1:
                print(f"{file}: {text.count(old)} places for: {old}")
                missed += 1
                continue
            overlay = pathlib.Path(folder) / f"m{i}"
            (overlay / file).parent.mkdir(parents=True)
            (overlay / file).write_text(text.replace(old, new))
            cases = 20000 if file == ORIENTATION else 4000 # it shows signs alone, and few of them are doubtful
            noticed = not agree(compiler.program(overlay, file), compare, 1, cases, quiet=True)
            missed += not noticed
            took = f"{time.time() - start:5.1f} s"
            print(f"{'noticed' if noticed else 'MISSED '} {took}  {file}: {old!r} -> {new!r}", flush=True)
    print(f"{len(tried) - missed} of {len(tried)} noticed")
    return 1 if missed else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=["compare", "mutations"])
    parser.add_argument("compare")
    parser.add_argument("--cases", type=int, default=round(100000 * SHARE))
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--program")
    options = parser.parse_args()
    if options.what == "mutations":
        return mutations(options.compare)
    with tempfile.TemporaryDirectory() as folder:
        program = options.program or Compiler(folder).program()
        return 0 if agree(program, options.compare, options.seed, options.cases) else 1


if __name__ == "__main__":
    sys.exit(main())
