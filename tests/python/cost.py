#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""cost.py LIBRARY [--check]: what calling from Python costs over C++, both sides in turn in one run, in medians: a
refit of about 619 BVs, 1,000 frames in one call, and importing the module. LIBRARY is that of reference.cpp. --check:
exit status 1 where a call costs more than twice as much."""
import os
import statistics
import subprocess
import sys
import time

os.environ["CINCH_REFERENCE"] = sys.argv[1]
import cinch  # noqa: E402
import numpy as np  # noqa: E402
import shapes  # noqa: E402
from reference import Reference  # noqa: E402


def ratio(python, cpp):
    """The median of the ratios of calls that followed each other, and both medians in microseconds."""
    return (statistics.median(p / c for p, c in zip(python, cpp)),
            *(statistics.median(x) / 1e3 for x in (python, cpp)))


def timed(call):
    begin = time.perf_counter_ns()
    call()
    return time.perf_counter_ns() - begin


nodes = 115
vertices, triangles = shapes.torus(135, 4)
dense = shapes.weights(vertices, nodes)
refit = cinch.Refitter(cinch.build_bvh(cinch.Surface(vertices, triangles, dense)))
same = Reference(vertices, triangles, dense)
bvs = len(refit.bvh)
maps = shapes.motion(nodes, 1000)
one = np.ascontiguousarray(maps[500])
assert np.array_equal(refit.supports(maps), same.refit(maps)[0]), "other bits than C++'s"


def measured():
    out, supports = np.empty((bvs, 2, 3)), np.empty((1, bvs, 6))
    python, cpp, new = [], [], []
    for _ in range(3000):
        python.append(timed(lambda: refit(one, out=out)))
        cpp.append(same.refit(one, supports)[1])
        new.append(timed(lambda: refit(one)))
    rows = [("a refit from Python / in C++", ratio(python, cpp), 1.1),
            ("the same, into a new array", ratio(new, cpp), 1.1)]
    out, supports = np.empty((1000, bvs, 2, 3)), np.empty((1000, bvs, 6))
    python, cpp = [], []
    for _ in range(15):
        python.append(timed(lambda: refit(maps, out=out)))
        cpp.append(same.refit(maps, supports)[1])
    return rows + [("1,000 frames in one call / in C++", ratio(python, cpp), 1.02)]


def imported(what):
    return timed(lambda: subprocess.run([sys.executable, "-c", what], check=True))


with_module, without = [], []
for _ in range(15):
    with_module.append(imported("import cinch; cinch.axes(6)"))  # and NumPy, which it takes when it is used
    without.append(imported("pass"))
seconds = (statistics.median(with_module) - statistics.median(without)) / 1e9

print(f"{bvs} BVs, {nodes} simulation nodes, method 'best' in float32, medians, both in turn\n")
rows = measured()
for name, (share, mine, theirs), target in rows:
    print(f"{name:36} {mine:10.1f} us / {theirs:10.1f} us = {share:5.3f}  target <= {target:4}  "
          f"{'reached' if share <= target else 'MISSED'}")
print(f"{'import cinch, with NumPy':36} {seconds * 1e3:10.1f} ms{'':21}target <= 0.2 s  "
      f"{'reached' if seconds <= 0.2 else 'MISSED'}")
# Machines are shared: a test can tell what is twice as slow as it should be, not whether a figure is reached.
sys.exit("--check" in sys.argv and any(share > 2 for _, (share, _, _), _ in rows))
