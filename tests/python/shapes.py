# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces and motions for tests: made, not read."""
import numpy as np


def torus(around, along):
    """Vertices, shape (around * along, 3), and triangles of a closed surface."""
    u, v = np.meshgrid(2 * np.pi * np.arange(around) / around, 2 * np.pi * np.arange(along) / along, indexing="ij")
    ring = 1 + 0.35 * np.cos(v)
    vertices = np.stack([ring * np.cos(u), ring * np.sin(u), 0.35 * np.sin(v)], axis=-1).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(around), np.arange(along), indexing="ij")
    a = i * along + j
    b = (i + 1) % around * along + j
    c = i * along + (j + 1) % along
    d = (i + 1) % around * along + (j + 1) % along
    triangles = np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([b, d, c], -1).reshape(-1, 3)])
    return np.ascontiguousarray(vertices), triangles.astype(np.uint32)


def weights(vertices, nodes):
    """Dense convex weights of simulation nodes around the ring, four of them per vertex."""
    angle = np.arctan2(vertices[:, 1], vertices[:, 0])[:, None] - 2 * np.pi * np.arange(nodes)[None] / nodes
    near = np.exp(4 * np.cos(angle))
    least = np.sort(near, axis=1)[:, -min(4, nodes)][:, None]
    near[near < least] = 0
    return near / near.sum(axis=1, keepdims=True)


def motion(nodes, frames, seed=0, strength=0.4):
    """Maps, shape (frames, nodes, 3, 4): each simulation node turns, stretches and wanders on its own."""
    random = np.random.default_rng(seed)
    grow = np.linspace(0, 1, frames)[:, None, None, None] if frames > 1 else np.ones((1, 1, 1, 1))
    away = strength * random.standard_normal((1, nodes, 3, 4))
    return np.ascontiguousarray(np.eye(3, 4)[None, None] + grow * away)


def csr(dense):
    """(data, indices, indptr)."""
    rows, columns = np.nonzero(dense)
    return dense[rows, columns], columns, np.concatenate([[0], np.cumsum((dense != 0).sum(axis=1))])
