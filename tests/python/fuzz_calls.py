#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""fuzz_calls.py [--seconds N] [--seed S]: random calls of everything in cinch and cinch.exact, with arguments that are
right, nearly right or absurd, objects that are kept, shared and dropped, and arrays that are changed while they are in
use. What may come back is a result or a Python error of the kinds that are documented; anything else, and any crash, is
a fault. Under AddressSanitizer: LD_PRELOAD=libasan.so ASAN_OPTIONS=detect_leaks=0 python3 fuzz_calls.py."""
import argparse
import faulthandler
import gc
import os
import pathlib
import random
import sys
import tempfile
import threading
import time
import traceback

import cinch
import numpy as np

try:
    from cinch import exact
except ImportError:
    exact = None

faulthandler.enable()
data = pathlib.Path(__file__).resolve().parents[2] / "data"
expected = (ValueError, TypeError, IndexError, RuntimeError, OverflowError, MemoryError, StopIteration, AttributeError)
scene = ('{"name": "jelly", "duration": 0.1, "bodies": [{"name": "box", "surface": "box", "box": [1, 1, 1], '
         '"cells": [2, 2, 2], "lattice": [3, 3, 3]}], "effects": [{"effect": "elastic", "young": 1e4}]}')


class Fuzz:
    """Pools of objects, from which arguments are taken, and into which results go."""

    def __init__(self, seed):
        self.r = random.Random(seed)
        self.n = np.random.default_rng(seed)
        self.pool = {}
        self.folder = tempfile.mkdtemp()

    def chance(self, share):
        return self.r.random() < share

    def keep(self, thing):
        if thing is None or isinstance(thing, (int, float, str, bool)):
            return
        kind = self.pool.setdefault(type(thing).__name__, [])
        kind.append(thing)
        if len(kind) > 6:
            kind.pop(self.r.randrange(len(kind)))

    def any_of(self, *kinds):
        found = [thing for kind in kinds for thing in self.pool.get(kind, [])]
        return self.r.choice(found) if found else None

    def absurd(self):
        huge = np.broadcast_to(np.float64(1), (2**40, 3))
        return self.r.choice([
            None, 0, -1, 3, 2**31, 2**63, 2**70, -2**40, 0.5, float("nan"), float("inf"), 1e308, 5e-324, "", "best",
            "x" * 3000, "\ud800", b"a\0b", [], [[]], [1, [2]], (), (1, 2), (None,) * 3, {}, {"a": 1}, object(),
            lambda *a: None, np.zeros(0), np.zeros((0, 3)), np.zeros((0, 3, 4)), np.zeros((2, 0, 3, 4)),
            np.full((3, 3, 4), np.nan), np.zeros((1, 2, 3, 4, 5)), np.zeros(3, complex), np.zeros(3, "U9"),
            np.zeros(3, object), np.zeros((4, 3), ">f8"), np.zeros((4, 3), np.float16), np.zeros((4, 3), bool),
            np.array(5.0), np.array("now", "M8"), np.ma.masked_all((3, 3)), huge[:3],
            np.zeros((3, 4), [("a", "f8")]), self.folder, data, *map(self.any_of, list(self.pool))])

    def doubles(self, *shape):
        scale = self.r.choice([1, 1, 1, 1e-3, 1e150, 1e-310, 0])
        array = scale * self.n.standard_normal(shape)
        if self.chance(0.05) and array.size:
            array.flat[self.r.randrange(array.size)] = self.r.choice([np.nan, np.inf, -np.inf, 1.7e308])
        if self.chance(0.1):
            array = self.r.choice([np.asfortranarray, lambda a: a.astype(np.float32), lambda a: a[::-1],
                                   lambda a: a.tolist(), lambda a: a.astype(">f8"), lambda a: a[..., :-1],
                                   lambda a: a[None]])(array)
        self.keep(array)
        return array

    def mesh(self):
        count = self.r.choice([1, 2, 3, 8, 60])
        vertices = self.doubles(count, 3)
        if self.chance(0.2):
            vertices = np.round(vertices)
        triangles = self.n.integers(0, count + self.chance(0.02), (self.r.choice([0, 1, 5, 80]), 3))
        return vertices, triangles

    def weights(self, count):
        nodes = self.r.choice([1, 2, 5, 30])
        raw = self.n.random((count, nodes)) * (self.n.random((count, nodes)) < 0.5)
        raw[:, 0] += 0.01
        if self.chance(0.8):
            raw /= raw.sum(axis=1, keepdims=True)
        return raw

    def surface(self):
        vertices, triangles = self.mesh()
        return cinch.Surface(vertices, triangles, self.weights(len(vertices)), copy=self.chance(0.3),
                             normalise=self.chance(0.9))

    def nodes_of(self, thing):
        surface = getattr(thing, "surface", thing)
        surface = getattr(getattr(thing, "bvh", None), "surface", surface)
        return getattr(surface, "node_count", 3)

    def maps(self, thing, *more):
        if self.chance(0.1):
            clip = self.any_of("Clip")
            if clip is not None:
                return clip
        return np.eye(3, 4) + self.doubles(*more, self.nodes_of(thing), 3, 4) if self.chance(0.9) else self.absurd()

    def options(self):
        out = {}
        for name, values in (("method", cinch.methods() + ["support+linear", "eq13"]), ("kdop", [6, 14, 18, 26, 7]),
                             ("precision", ["float32", "float64"]), ("passes", [1, 2, 0, -1]),
                             ("rest_shape", ["aabb", "obb"]), ("remember", [True, False]), ("proven", [True, False])):
            if self.chance(0.3):
                out[name] = self.r.choice(values)
        return out

    def or_absurd(self, thing):
        return self.absurd() if self.chance(0.04) or thing is None else thing

    def box_of(self, bvh, k=6):
        n = len(bvh) if isinstance(bvh, cinch.Bvh) else 3
        return self.r.choice([self.doubles(n, k), self.doubles(n, 2, 3)])

    def space(self):
        n = self.r.choice([1, 2, 3, 6])
        ends = np.sort(self.n.random((2, n)), axis=0) * self.r.choice([1, 0.5, 3 / n])
        return np.round(ends * 8) / 8 if self.chance(0.5) else np.minimum(ends, 1)

    # Each makes one call; its result is kept.
    def steps(self):
        o, any_of = self.or_absurd, self.any_of
        bvh, surface, character = any_of("Bvh"), any_of("Surface"), any_of("Character")
        collider, refitter, crowd = any_of("Collider"), any_of("Refitter"), any_of("CrowdRefitter")
        targets = self.r.choice([[], [any_of("MorphTarget")], o(())])
        some = lambda: self.r.choice([(), (1,), (3,)])  # noqa: E731
        calls = [
            self.surface, self.surface,
            lambda: cinch.Surface(o(self.mesh()[0]), o(self.mesh()[1]), o(self.weights(8)), layout=o(None)),
            lambda: cinch.Weights(o(self.weights(5)), nodes=o(None), normalise=o(True)),
            lambda: cinch.Weights((o(self.n.random(6)), o(self.n.integers(0, 4, 6)), o([0, 2, 4, 6])), nodes=o(4),
                                  normalise=True),
            lambda: cinch.MorphTarget(o(np.unique(self.n.integers(0, 9, 3))), o(self.doubles(3, 3)), o(None)),
            lambda: cinch.sample_nodes(*map(o, self.mesh()), o(self.r.choice([1, 4, 50])), seed=o(3)),
            lambda: cinch.kernel_weights(o(self.mesh()[0]), any_of("SimulationNodes"), o(2.0)),
            lambda: cinch.SimulationNodes(o(self.doubles(4, 3)), o(0.5)),
            lambda: cinch.build_bvh(o(surface), o(self.r.choice([1, 2, 4, 16])),
                                    detail=o(self.r.choice(["all", "all", "inner", "boxes"]))),
            lambda: cinch.build_bvh(o(surface), cluster=o(self.r.choice([(16, 16), (4, 4), (1, 3), (0, 0)]))),
            lambda: bvh.vertices_of(o(self.r.randrange(9))),
            lambda: cinch.Refitter(o(bvh), o(None), o(targets), **self.options()),
            lambda: refitter(self.maps(refitter, *some()), o(None), out=o(None), progress=o(None)),
            lambda: refitter.supports(self.maps(refitter, *some()), o(self.doubles(1))),
            lambda: cinch.refit(o(bvh), self.maps(bvh, *some()), **self.options()),
            lambda: cinch.CrowdRefitter(o(bvh), level=o(self.r.choice([0, 1, 5])), proven=o(True)),
            lambda: crowd(self.maps(bvh, 3), out=o(None)),
            lambda: cinch.AnytimeBounder(o(bvh), o(None), **self.options()),
            lambda: any_of("AnytimeBounder")(self.maps(any_of("AnytimeBounder"), *some()), o(self.r.choice([0, 3, 99])),
                                             tolerance=o(self.r.choice([0, 0.1, -1])), seconds=o(None)),
            lambda: cinch.evaluate(o(surface), self.maps(surface, *some()), rest=o(None), out=o(None)),
            lambda: cinch.SurfaceEvaluator(o(surface), o(self.r.choice(["float32", "float64"]))),
            lambda: any_of("SurfaceEvaluator")(self.maps(surface, *some())),
            lambda: cinch.displace(o(targets), o(self.doubles(1)), o(self.mesh()[0])),
            lambda: cinch.Clip(o("c"), o([0, 1.0]), self.maps(surface, 2)),
            lambda: any_of("Clip").evenly_spread(o(self.r.choice([0, 1, 2, 99]))), lambda: any_of("Clip")[o(0)],
            lambda: any_of("Clip").maps, lambda: any_of("Clip").weights, lambda: any_of("Clip").times,
            lambda: cinch.Collider(kdop=o(self.r.choice([6, 14, 18, 26])), lanes=o(self.r.choice([4, 8, 16])),
                                   update=o(self.r.choice(["automatic", "lazy", "full"])), keep_cut=o(True)),
            lambda: collider.add(o(self.r.choice([surface, bvh])), o(targets)),
            lambda: collider.add(o(surface), method=o(self.r.choice(cinch.methods()))),
            lambda: self.collide(collider), lambda: self.collide(collider), lambda: self.collide(collider),
            lambda: collider.remove(o(self.r.choice([0, 1, 7]))),
            lambda: collider.set_filter(o(self.r.choice([None, lambda a, b: a < b, lambda a, b: collider.pairs()]))),
            lambda: cinch.swept_leaf_pairs([(o(bvh), o(self.box_of(bvh)))] * self.r.choice([0, 1, 2]), kdop=o(6)),
            lambda: cinch.swept(o(self.box_of(bvh)), o(self.box_of(bvh))),
            lambda: cinch.read_character(self.character_file(), morphs=o(True), partial=o(False)),
            lambda: character.sample(o(None), o(self.r.choice([5, 30, 1e-9, 1e4, 1e13]))),
            lambda: character.with_any_weights(o(0), o(1)),
            lambda: cinch.build_bvh(character.surface, 16),
            lambda: cinch.ClipBounder(o(character), o(None), o(bvh), **self.options()),
            lambda: any_of("ClipBounder")(o(self.r.choice([0, 0.5, [0, 1]])), o(self.r.choice([1, 2, [1, 1.5]]))),
            lambda: cinch.bake(o(character), o(None), o(None), interval=o(self.r.choice([None, 0.5])), whole=o(True),
                               engine=o(None), **self.options()),
            lambda: any_of("Baked").bounds,
            lambda: cinch.read_mesh(self.mesh_file()), lambda: cinch.read_weights(self.mesh_file(), o(3)),
            lambda: cinch.read_clips(self.mesh_file(), o(3)),
            lambda: cinch.Simulation(o(self.scene_text()), folder=o(self.folder)),
            lambda: next(any_of("Simulation")), lambda: any_of("Simulation").surface(o(0)),
            lambda: any_of("Simulation").add_force(o(0), o(Force(self))), lambda: any_of("Simulation").transforms(o(0)),
            lambda: cinch.axes(o(6)), self.look, self.look, self.write, self.write, self.drop, self.at_once,
        ]
        if exact:
            calls += [
                lambda: exact.verify(o(bvh), self.maps(bvh), o(self.box_of(bvh)), method=o("best"), kdop=o(None)),
                lambda: exact.Verifier(o(bvh), targets=o(())),
                lambda: any_of("Verifier").check(self.maps(bvh), o(self.box_of(bvh))),
                lambda: exact.optimum(*map(o, self.space()), o(self.doubles(3))),
                lambda: exact.corners(*map(o, self.space()), limit=o(20)),
                lambda: exact.count_corners(*map(o, self.space())), lambda: exact.is_feasible(*map(o, self.space())),
                lambda: exact.polytope(o(self.doubles(self.r.choice([6, 14, 18, 26])))),
                lambda: exact.true_polytope(o(bvh), o(0), self.maps(bvh), kdop=o(14)),
                lambda: exact.verify_times(o(any_of("Baked"))) if self.chance(0.1) else None,
            ]
        return calls

    def collide(self, collider):
        bodies = len(collider.bodies)
        if self.chance(0.7):
            collider.update([self.maps(self.any_of("Surface")) for _ in range(bodies)])
        return self.r.choice([collider.pairs, collider.any, collider.leaves, lambda: collider.counts.bounds,
                              lambda: collider.find(lambda p: self.chance(0.5)), lambda: collider.unknown])()

    def torn(self, text):
        text = bytearray(text)
        for _ in range(self.r.choice([0, 1, 5])):
            if text:
                text[self.r.randrange(len(text))] = self.r.choice(b'0"{}[],:-x\xff')
        return bytes(text[:self.r.choice([len(text), self.r.randrange(len(text) + 1)])])

    def file(self, name, content):
        path = pathlib.Path(self.folder) / name
        path.write_bytes(content)
        return self.or_absurd(path)

    def scene_text(self):
        return scene if self.chance(0.7) else self.torn(scene.encode()).decode(errors="replace")

    def character_file(self):
        content = (data / "scenes" / "tube.glb").read_bytes()
        return self.file("c.glb", content if self.chance(0.7) else self.torn(content))

    def mesh_file(self):
        content = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
        return self.file("m" + self.r.choice([".obj", ".off", ".ply", ".stl", ".txt"]), self.torn(content))

    def look(self):
        thing = self.any_of(*self.pool)
        if type(thing).__module__.startswith("cinch"):
            names = [n for n in dir(thing) if not n.startswith("__") or n in ("__repr__", "__len__")]
            return getattr(thing, self.r.choice(names))
        return None

    def write(self):
        array = self.any_of("ndarray")
        if array is not None and array.size:
            self.r.choice([lambda: array.fill(self.r.choice([0, np.nan, 1e300, 7])), lambda: array.sort(axis=0),
                           lambda: array.resize((2, 3), refcheck=False), lambda: array.setflags(write=True)])()

    def drop(self):
        self.pool.pop(self.r.choice(list(self.pool)), None)
        gc.collect(self.r.choice([0, 2]))

    def at_once(self):
        """Two calls by two threads."""
        calls = self.r.sample(self.steps(), 2)
        threads = [threading.Thread(target=self.attempt, args=(call,)) for call in calls if call != self.at_once]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()

    def attempt(self, call):
        """Whether a result came back."""
        try:
            self.keep(call())
            return True
        except expected:
            return False
        except BaseException:
            print("an error of another kind:", file=sys.stderr)
            traceback.print_exc()
            os._exit(1)


class Force:
    def __init__(self, fuzz):
        self.fuzz = fuzz

    def energy(self, positions, masses, time_s):
        return self.fuzz.r.choice([0.0, 1.0, float("nan"), None]) if self.fuzz.chance(0.01) else 0.0

    def force(self, positions, masses, time_s):
        return self.fuzz.absurd() if self.fuzz.chance(0.01) else np.zeros_like(positions)


parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--seconds", type=float, default=20)
parser.add_argument("--seed", type=int, default=0)
options = parser.parse_args()
np.seterr(all="ignore")
end, calls, results, seed = time.monotonic() + options.seconds, 0, 0, options.seed
while time.monotonic() < end:
    fuzz = Fuzz(seed)
    for _ in range(2000):
        if os.environ.get("CINCH_FUZZ_TRACE"):
            print(seed, calls, file=sys.stderr, flush=True)
        if time.monotonic() >= end:
            break
        results += fuzz.attempt(fuzz.r.choice(fuzz.steps()))
        calls += 1
    seed += 1
print(f"{calls} calls, {results} with a result, {seed - options.seed} seeds from {options.seed} on, no fault")
sys.exit(0 if results > calls / 4 else "fewer than a quarter of the calls had a result: nothing was tried")
