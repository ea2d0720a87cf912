#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""tightness.py [MESH] [--nodes 16,64,256] [--out tightness.png]: the paper's Fig. 5 on a mesh of one's own. How much
larger bounds are than the true boxes, by the level of the tree, for methods and numbers of simulation nodes. MESH is an
OBJ, OFF, PLY or STL; without one, a torus."""
import argparse

import cinch
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("mesh", nargs="?")
parser.add_argument("--nodes", default="16,64,256", help="numbers of simulation nodes")
parser.add_argument("--methods", default="eq12,limited,best")
parser.add_argument("--out", default="tightness.png")
options = parser.parse_args()


def torus(around=120, along=40):
    u, v = np.meshgrid(np.linspace(0, 2 * np.pi, around, False), np.linspace(0, 2 * np.pi, along, False), indexing="ij")
    ring = 1 + 0.35 * np.cos(v)
    i, j = np.meshgrid(np.arange(around), np.arange(along), indexing="ij")
    a, b = i * along + j, (i + 1) % around * along + j
    c, d = i * along + (j + 1) % along, (i + 1) % around * along + (j + 1) % along
    faces = np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([b, d, c], -1).reshape(-1, 3)])
    return np.stack([ring * np.cos(u), ring * np.sin(u), 0.35 * np.sin(v)], -1).reshape(-1, 3), faces


def bend(points, amount):
    """Where a twist about z, then a bend about y, take points; `amount` 0 is rest."""
    angle = 1.2 * amount * points[:, 2]
    x = np.cos(angle) * points[:, 0] - np.sin(angle) * points[:, 1]
    y = np.sin(angle) * points[:, 0] + np.cos(angle) * points[:, 1]
    turn = 0.9 * amount * x
    return np.stack([x * np.cos(turn) + points[:, 2] * np.sin(turn), y,
                     points[:, 2] * np.cos(turn) - x * np.sin(turn)], axis=-1)


def maps_at(nodes, amount, step=1e-6):
    """The motion's affine map at every simulation node: shape (J, 3, 4)."""
    jacobian = np.stack([(bend(nodes + step * axis, amount) - bend(nodes - step * axis, amount)) / (2 * step)
                         for axis in np.eye(3)], axis=-1)
    moved = bend(nodes, amount) - np.einsum("jrc,jc->jr", jacobian, nodes)
    return np.concatenate([jacobian, moved[:, :, None]], axis=2)


if options.mesh:
    mesh = cinch.read_mesh(options.mesh)
    vertices, triangles = np.array(mesh.vertices), mesh.triangles
    middle = (vertices.max(0) + vertices.min(0)) / 2
    vertices = (vertices - middle) * 1.2 / np.abs(vertices - middle).max()
else:
    vertices, triangles = torus()

numbers, methods = [int(n) for n in options.nodes.split(",")], options.methods.split(",")
figure, (mean, most) = plt.subplots(1, 2, figsize=(9, 3.6), sharex=True, layout="constrained")
shades = plt.get_cmap("viridis")(np.linspace(0, 0.85, len(methods)))
for count, dash in zip(numbers, ["-", "--", ":", "-."]):
    nodes = cinch.sample_nodes(vertices, triangles, count)
    surface = cinch.Surface(vertices.copy(), triangles, cinch.kernel_weights(vertices, nodes, 2))
    bvh = cinch.build_bvh(surface, leaf_triangles=2)
    maps = np.stack([maps_at(nodes.positions, amount) for amount in (0.25, 0.5, 0.75, 1)])

    def radius(method):
        boxes = cinch.Refitter(bvh, method=method)(maps)
        return np.linalg.norm(boxes[:, :, 1] - boxes[:, :, 0], axis=-1) / 2

    truth = radius("vertices")
    for method, shade in zip(methods, shades):
        ratio = radius(method) / truth
        levels = [ratio[:, a:b] for a, b in zip(bvh.level, bvh.level[1:])]
        assert min(level.min() for level in levels) > 1 - 1e-6  # no bound is below the truth
        for axes, take in ((mean, np.mean), (most, np.max)):
            axes.plot([take(level) for level in levels], dash, color=shade, label=f"{method}, {count}")
        print(f"{count:4} simulation nodes, {method:8} root {levels[0].mean():6.3f}, leaves {levels[-1].mean():6.3f}")
for axes, title in ((mean, "mean"), (most, "maximum")):
    axes.set(xlabel="level of the tree (0: the root)", title=title)
    axes.set_yscale("log")
    axes.yaxis.set_major_formatter(matplotlib.ticker.FormatStrFormatter("%g"))
    axes.yaxis.set_minor_formatter(matplotlib.ticker.NullFormatter())
    top = max(line.get_ydata().max() for line in axes.lines)
    axes.set_yticks([t for t in (1, 1.1, 1.2, 1.5, 2, 3, 5, 10, 20, 50) if t < 1.2 * top])
    axes.xaxis.set_major_locator(matplotlib.ticker.MaxNLocator(integer=True))
    axes.grid(alpha=0.3)
mean.set_ylabel("radius of the bound / of the true box")
most.legend(loc="upper left", bbox_to_anchor=(1.02, 1), fontsize=8, frameon=False, title_fontsize=8,
            title="method, simulation nodes")
figure.savefig(options.out, dpi=100)
