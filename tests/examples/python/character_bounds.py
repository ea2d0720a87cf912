#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Proven boxes of a character's clips, each for all times: character_bounds.py FILE.glb"""
import sys

import cinch

character = cinch.read_character(sys.argv[1] if len(sys.argv) > 1 else "character.glb")
bvh = cinch.build_bvh(character.surface)  # at most 4 triangles per leaf
for clip in character.clips:
    bound = cinch.ClipBounder(character, clip, bvh)
    boxes = bound(clip.first_s, clip.last_s)  # of all BVs, at every real time between: (BVs, 2, 3)
    print(f"{clip.name}: {boxes[0, 0]} to {boxes[0, 1]}")  # of the root
