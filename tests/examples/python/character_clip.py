#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""character_clip.py FILE.glb [--clip NAME] [--out character_clip.png]: the bounds of a character over a clip. Left, the
character at five times with the boxes of its root; right, how far along one axis it reaches, frame by frame, and the
intervals of `bake`, each of which holds at all real times between its ends."""
import argparse

import cinch
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.collections import PolyCollection  # noqa: E402
from matplotlib.patches import Rectangle  # noqa: E402

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("file")
parser.add_argument("--clip")
parser.add_argument("--out", default="character_clip.png")
options = parser.parse_args()

character = cinch.read_character(options.file)
clip = character.sample(options.clip, fps=60)
bvh = cinch.build_bvh(character.surface)
boxes = cinch.Refitter(bvh, targets=character.targets)(clip)[:, 0]  # of the root: (frames, 2, 3)
baked = cinch.bake(character, options.clip, bvh, interval=(clip.times[-1] - clip.times[0]) / 8 or None)
swept = baked.bounds[:, 0]


def vertices_at(frame):
    rest = character.surface.vertices
    if clip.displaces:
        rest = cinch.displace(character.targets, clip.weights[frame], rest)
    return cinch.evaluate(character.surface, clip[frame], rest=rest)


every = np.stack([vertices_at(f) for f in range(len(clip))])
for frame in range(len(clip)):
    assert (every[frame] >= boxes[frame, 0]).all() and (every[frame] <= boxes[frame, 1]).all()

# The two axes along which the character is largest, and the one of them along which it moves most.
size = (boxes[:, 1].max(0) - boxes[:, 0].min(0))
across, up = sorted(np.argsort(size)[1:])
moving = max((across, up), key=lambda axis: np.ptp(boxes[:, 1, axis]) + np.ptp(boxes[:, 0, axis]))
names = "xyz"

figure, (view, reach) = plt.subplots(1, 2, figsize=(9, 3.8), layout="constrained")
shades = plt.get_cmap("viridis")(np.linspace(0, 0.85, 5))
for frame, shade in zip(np.linspace(0, len(clip) - 1, 5).astype(int), shades):
    flat = every[frame][:, [across, up]]
    view.add_collection(PolyCollection(flat[character.surface.triangles], facecolor=shade, alpha=0.15, linewidth=0))
    low, high = boxes[frame][:, [across, up]]
    view.add_patch(Rectangle(low, *(high - low), fill=False, edgecolor=shade, linewidth=1.2,
                             label=f"{clip.times[frame]:.2f} s"))
view.autoscale_view()
view.set(xlabel=names[across], ylabel=names[up], title="the character and its root's boxes", aspect="equal")
view.legend(loc="best", fontsize=8, frameon=False)

reach.fill_between(clip.times, every[:, :, moving].min(1), every[:, :, moving].max(1), color="0.8",
                   label="the vertices, at frames")
for side in (0, 1):
    reach.plot(clip.times, boxes[:, side, moving], color=shades[0], linewidth=1,
               label=None if side else "bounds of frames")
for i, ((first, last), box) in enumerate(zip(baked.times, swept)):
    reach.add_patch(Rectangle((first, box[0, moving]), last - first, box[1, moving] - box[0, moving], fill=False,
                              edgecolor="tab:red", linewidth=1.2, label=None if i else "bounds for all times"))
reach.autoscale_view()
reach.set(xlabel="time, s", ylabel=names[moving], title=f"clip '{clip.name}'")
low, high = reach.get_ylim()
reach.set_ylim(low, high + 0.3 * (high - low))
reach.legend(loc="upper right", fontsize=8, frameon=False)
figure.savefig(options.out, dpi=100)
print(f"{len(clip)} frames and {len(baked)} intervals of {len(bvh)} BVs; every vertex is inside")
