# SPDX-License-Identifier: GPL-3.0-or-later
"""outside_method.py MARGIN|ball|short|odd: a method for `cinch audit --outside`, frames in, bounds out: the box of the
vertices in each frame with a margin, or a ball around it; a line too few; a line that is none."""
import json, math, sys

what = sys.argv[1]
surface = json.loads(sys.stdin.readline())
for number in range(surface["frames"]):
    frame = json.loads(sys.stdin.readline())
    rest = [list(v) for v in surface["vertices"]]
    for share, target in zip(frame["morphs"], surface["targets"]):
        for vertex, by in target:
            rest[vertex] = [a + share * b for a, b in zip(rest[vertex], by)]
    places = [[sum(w * (sum(m[4 * r + c] * p[c] for c in range(3)) + m[4 * r + 3])
                   for w, m in ((w, frame["maps"][j]) for j, w in weights)) for r in range(3)]
              for p, weights in zip(rest, surface["weights"])]
    low, high = [min(p[r] for p in places) for r in range(3)], [max(p[r] for p in places) for r in range(3)]
    if what == "short" and number + 1 == surface["frames"]:
        break
    if what == "odd":
        print("no bound")
    elif what == "ball":
        centre = [(a + b) / 2 for a, b in zip(low, high)]
        print(json.dumps({"centre": centre, "radius": 1e-9 + max(math.dist(p, centre) for p in places)}))
    else:
        margin = float(what)
        print(json.dumps({"low": [x - margin for x in low], "high": [x + margin for x in high]}))
