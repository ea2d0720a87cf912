#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Bounds of a character, proven in exact arithmetic; and one that is too small, refuted: prove_bounds.py FILE.glb"""
import sys

import cinch
import numpy as np

try:
    from cinch import exact
except ImportError as error:
    sys.exit(f"SKIPPED: cinch.exact: {error}")

character = cinch.read_character(sys.argv[1] if len(sys.argv) > 1 else "character.glb")
bvh = cinch.build_bvh(character.surface, 64)
baked = cinch.bake(character, bvh=bvh)  # for all real times of the first clip
verdict = exact.verify_times(baked)
print(f"{verdict.bounds} bounds for all times, {verdict.proven} proven, {verdict.violated} violated")
assert verdict.proven == verdict.bounds

frame = character.sample(fps=10)[1]
boxes = np.array(cinch.refit(bvh, frame))  # (BVs, 2, 3)
assert exact.verify(bvh, frame, boxes).proven == 6 * len(bvh)
boxes[0, 1, 0] -= 0.1 * (boxes[0, 1, 0] - boxes[0, 0, 0])  # the root's greatest x
refuted = exact.verify(bvh, frame, boxes)
print(f"{refuted.violated} violated: {refuted.examples[0]}")
assert refuted.violated == 1
