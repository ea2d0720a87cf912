#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A surface, weights and transforms of one's own: a flag of two simulation nodes, the right one swinging up."""
import cinch
import numpy as np

columns = 20
x = np.repeat(np.linspace(0, 1, columns + 1), 2)
vertices = np.stack([x, np.tile([0.0, 1.0], columns + 1), np.zeros_like(x)], axis=1)
first = 2 * np.arange(columns, dtype=np.uint32)[:, None]
triangles = np.concatenate([first + [0, 2, 1], first + [1, 2, 3]]).astype(np.uint32)

weights = np.stack([1 - x, x], axis=1)  # of each vertex a row that sums to 1; or SciPy's sparse rows
surface = cinch.Surface(vertices, triangles, weights, normalise=True)
refit = cinch.Refitter(cinch.build_bvh(surface), kdop=18)

maps = np.tile(np.eye(3, 4), (3, 2, 1, 1))  # (frames, simulation nodes, 3, 4), each (A | t)
maps[:, 1, 2, 3] = [0, 0.5, 1]  # z += height
boxes = refit(maps)[:, 0]  # supports of the root: (frames, 18)
for frame, box in enumerate(boxes):
    moved = cinch.evaluate(surface, maps[frame])
    assert (moved @ cinch.axes(18).T <= box[0::2]).all() and (-moved @ cinch.axes(18).T <= box[1::2]).all()
    print(f"z from {-box[5]} to {box[4]}")
