# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene with gravity and elasticity only costs what a program costs that has no other effects: within 5 %.

usage: step_cost_test.py ALONE EVERYTHING NM"""
import os, re, statistics, subprocess, sys

alone, everything, nm = sys.argv[1:]
names = subprocess.run([nm, "-C", alone], capture_output=True, text=True, check=True).stdout
if found := set(re.findall(r"cinch::effects::(\w+)$", names, re.M)) - {"gravity"}:
    sys.exit(f"effects in the program that should be without them: {', '.join(sorted(found))}")
names = subprocess.run([nm, "-C", everything], capture_output=True, text=True, check=True).stdout
if len(set(re.findall(r"cinch::effects::(\w+)$", names, re.M))) < 10:
    sys.exit("the program that should have every effect has not")
os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})  # and what it starts
for attempt in range(5):  # the machine is shared: a disturbed round says nothing
    times = {alone: [], everything: []}
    for _ in range(9):
        for program in times:
            times[program].append(float(subprocess.run([program], capture_output=True, text=True, check=True).stdout))
    ratio = statistics.median(times[everything]) / statistics.median(times[alone])
    print(f"with every effect in the program {statistics.median(times[everything]):.0f} ns a step, "
          f"without {statistics.median(times[alone]):.0f}: {ratio:.3f}")
    if ratio <= 1.05:
        sys.exit(0)
sys.exit(1)
