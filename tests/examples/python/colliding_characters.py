#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Two characters that play the same clip side by side: which of their triangles intersect, and when.
colliding_characters.py FILE.glb DISTANCE"""
import sys

import cinch
import numpy as np

character = cinch.read_character(sys.argv[1] if len(sys.argv) > 1 else "character.glb")
distance = float(sys.argv[2]) if len(sys.argv) > 2 else 0.1
collider = cinch.Collider()
left, right = collider.add(character.surface), collider.add(character.surface)

clip = character.sample(fps=10)
for frame, time in enumerate(clip.times):
    here = clip[frame]  # (simulation nodes, 3, 4)
    beside = np.array(here)
    beside[:, 0, 3] += distance
    collider.update([here, beside])
    pairs = collider.pairs()  # exact, (n, 4): body, triangle, body, triangle
    print(f"{time:g} s: {len(pairs)} pairs of bodies {left} and {right}")
