#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""ctypes_test.py LIBRARY HEADERS DATA BOUNDS: the library for C from Python's standard library alone: bounds hold the
vertices, baked files say what they say, handles keep what they refer to, and threads cannot use one thing at once."""
import ctypes
import gc
import json
import math
import pathlib
import sys
import tempfile
import threading
import unittest

import library as of

LIBRARY, HEADERS, DATA, BOUNDS = sys.argv[1:5]
c = of.Library(LIBRARY, HEADERS)
REST = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]


def lifted(height):
    return of.doubles(REST + REST[:-1] + [height])


def sizes_of(kind, handle):
    sizes = c.structures[f"cinch_{kind}_sizes"]()
    c.need(f"cinch_{kind}_get_sizes", handle, ctypes.byref(sizes))
    return sizes


class Bounds(unittest.TestCase):
    def setUp(self):
        self.arrays = of.strip_arrays(c, 30, targets=2)
        self.surface = c.make("cinch_surface_from_arrays", ctypes.byref(self.arrays))
        self.bvh = c.make("cinch_bvh_build", self.surface, 4, 0, 0)
        self.bvs = sizes_of("bvh", self.bvh).bvs

    def tearDown(self):
        for handle in (self.surface, self.bvh):
            c.need("cinch_free", handle)

    def test_bounds_hold_the_vertices_of_every_frame(self):
        for k in (6, 14, 18, 26):
            axes = (ctypes.c_int32 * (3 * k // 2))()
            c.need("cinch_axes", k, axes, k // 2)
            options = c.structures["cinch_refit_options"](kdop=k)
            refitter = c.make("cinch_refitter_new", self.bvh, ctypes.byref(options))
            heights, weights = [0.0, 0.25, -3.0], of.doubles([0, 0, 1, 0.5, -2, 1])
            maps = of.doubles([x for h in heights for x in lifted(h)])
            supports = (ctypes.c_double * (3 * self.bvs * k))()
            c.need("cinch_refitter_refit", refitter, 3, maps, 6, weights, 6, supports, 3 * self.bvs, None)
            for f in range(3):
                places = (ctypes.c_double * (3 * self.arrays.vertex_count))()
                c.need("cinch_surface_evaluate", self.surface, ctypes.byref(maps, 192 * f), 2,
                       ctypes.byref(weights, 16 * f), 2, places, self.arrays.vertex_count)
                root = supports[f * self.bvs * k:][:k]
                for v in range(0, len(places), 3):
                    for a in range(k // 2):
                        along = sum(axes[3 * a + r] * places[v + r] for r in range(3))
                        self.assertLessEqual(along, root[2 * a] + 1e-15)
                        self.assertLessEqual(-along, root[2 * a + 1] + 1e-15)
                if f == 0:  # nothing is displaced
                    self.assertLess(root[4] - max(places[2::3]), 1e-5)
            c.need("cinch_free", refitter)

    def test_arrays_may_go_after_the_call(self):
        handle = c.make("cinch_surface_from_arrays", ctypes.byref(self.arrays))
        positions = list(self.arrays.kept["positions"])
        for array in self.arrays.kept.values():
            ctypes.memset(array, 0xff, ctypes.sizeof(array))
        self.arrays = None
        gc.collect()
        sizes = sizes_of("surface", handle)
        out = (ctypes.c_double * (3 * sizes.vertices))()
        c.need("cinch_surface_get_mesh", handle, out, sizes.vertices, None, 0)
        self.assertEqual(positions, list(out))
        c.need("cinch_free", handle)

    def test_a_refitter_belongs_to_one_thread_at_a_time_and_a_freed_one_ends_its_calls(self):
        frames = 3000
        refitter = c.make("cinch_refitter_new", self.bvh, None)
        maps = of.doubles(list(lifted(0.5)) * frames)
        results, supports = [], [(ctypes.c_double * (6 * self.bvs * frames))() for _ in range(4)]

        def refit(out):
            status = c.cinch_refitter_refit(refitter, frames, maps, 2 * frames, None, 0, out, self.bvs * frames, None)
            results.append((status, c.message() if status else ""))

        threads = [threading.Thread(target=refit, args=[out]) for out in supports]
        for thread in threads:
            thread.start()
        c.need("cinch_free", refitter)
        for thread in threads:
            thread.join()
        constants = c.constants
        for status, message in results:
            self.assertIn(status, (0, constants["CINCH_ERROR_BUSY"], constants["CINCH_ERROR_HANDLE"]), message)
        self.assertEqual(len(results), 4)

    def test_messages_belong_to_their_threads(self):
        self.assertNotEqual(c.cinch_free(1), 0)
        mine, others = c.message(), []
        thread = threading.Thread(target=lambda: others.append((c.message(), c.cinch_axes(5, None, 0), c.message())))
        thread.start()
        thread.join()
        self.assertEqual(others, [("", c.constants["CINCH_ERROR_ARGUMENT"], "k must be 6, 14, 18 or 26")])
        self.assertEqual(mine, c.message())

    def test_an_executor_of_python(self):
        columns = 2000
        arrays, calls = of.strip_arrays(c, columns), []
        surface = c.make("cinch_surface_from_arrays", ctypes.byref(arrays))

        def run(_, count, task, work):
            calls.append(count)
            for i in reversed(range(count)):
                task(work, i)

        kept, results = c.callbacks["cinch_run"](run), []
        for executor in (c.callbacks["cinch_run"](), kept):
            c.need("cinch_use_executor", executor, None)
            out = (ctypes.c_double * (3 * arrays.vertex_count))()
            c.need("cinch_surface_evaluate", surface, lifted(1), 2, None, 0, out, arrays.vertex_count)
            results.append(bytes(out))
        c.need("cinch_use_executor", c.callbacks["cinch_run"](), None)
        self.assertEqual(results[0], results[1])
        self.assertGreater(sum(calls), 1)
        c.need("cinch_free", surface)

    def test_two_strips_that_cross(self):
        collider = c.make("cinch_collider_new", None)
        ident, count = ctypes.c_uint32(), ctypes.c_size_t()
        plain = of.strip_arrays(c, 30)
        surface = c.make("cinch_surface_from_arrays", ctypes.byref(plain))
        for _ in range(2):
            c.need("cinch_collider_add", collider, surface, None, None, ctypes.byref(ident))
        c.need("cinch_free", surface)
        frames = (c.structures["cinch_body_frame"] * 2)()
        flat, tilted = lifted(0), of.doubles(REST[:-1] + [-1] + REST[:-1] + [1])
        for frame, maps in zip(frames, (flat, tilted)):
            frame.maps, frame.map_count = ctypes.addressof(maps), 2
        c.need("cinch_collider_update", collider, frames, 2)
        c.need("cinch_collider_query", collider, 0, ctypes.byref(count))
        pairs = (ctypes.c_uint32 * (4 * count.value))()
        c.need("cinch_collider_get_pairs", collider, pairs, count)
        self.assertGreater(count.value, 0)
        middle = {pairs[i] for i in range(1, len(pairs), 4)}
        self.assertTrue(all(26 <= t <= 33 for t in middle), middle)  # they cross where x is a half
        c.need("cinch_free", collider)


class Files(unittest.TestCase):
    def setUp(self):
        if not c.cinch_parts() & c.constants["CINCH_PART_IO"]:
            self.skipTest("built without cinch::io")

    def read(self, path):
        clips = ctypes.c_size_t()
        handle = ctypes.c_void_p()
        c.need("cinch_baked_read", str(path).encode(), ctypes.byref(handle), ctypes.byref(clips))
        return handle.value, clips.value

    def test_baked_bounds_are_those_of_the_file(self):
        records = [json.loads(line) for line in pathlib.Path(BOUNDS).read_text().splitlines()]
        records = [r for r in records if r["experiment"] == "bake" and "bv" in r]
        baked, clips = self.read(BOUNDS)
        self.assertEqual(clips, len({r["clip"] for r in records}))
        info = c.structures["cinch_baked_clip"]()
        c.need("cinch_baked_get_clip", baked, 0, ctypes.byref(info))
        self.assertEqual((info.name.decode(), info.statement.decode()), (records[0]["clip"], records[0]["statement"]))
        self.assertEqual(info.intervals * info.bvs, len(records))
        times, supports = (ctypes.c_double * (2 * info.intervals))(), (ctypes.c_double * (6 * len(records)))()
        c.need("cinch_baked_get_supports", baked, 0, times, info.intervals, supports, len(records))
        for i, record in enumerate(records):
            box = (ctypes.c_double * 6)()
            c.need("cinch_boxes_of", ctypes.byref(supports, 48 * i), 6, box, 1)
            self.assertEqual(list(box), record["min"] + record["max"])
            self.assertEqual(list(times[2 * i:2 * i + 2]), [record["t0"], record["t1"]])
        c.need("cinch_free", baked)

    def test_damaged_baked_files_are_refused_with_file_and_line(self):
        good = json.loads(pathlib.Path(BOUNDS).read_text().splitlines()[0])
        damages = [("min", [1, 2]), ("min", [9, 9, 9]), ("min", ["a", 0, 0]), ("t0", "x"), ("t0", 1e9), ("kdop", 7),
                   ("kdop", 14), ("bv", 2), ("bv", -1), ("clip", 3), ("input", None), ("statement", [])]
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "bounds.jsonl")
            for name, value in damages:
                path.write_text(json.dumps(good) + "\n" + json.dumps(good | {name: value}) + "\n")
                with self.assertRaisesRegex(ValueError, r"bounds\.jsonl:2: ", msg=f"{name}: {value}"):
                    self.read(path)
            for text in ("", "{", "[]", '{"experiment": "bake", "bv": 0}', "[" * 100000):
                path.write_text(text)
                with self.assertRaisesRegex(ValueError, r"bounds\.jsonl:(\d:)? "):
                    self.read(path)
            both = [good, good | {"bv": 1, "min": [None, 0, 0], "max": [1, None, 1]}, {"experiment": "verify"}]
            path.write_text("\n".join(json.dumps(r) for r in both))
            baked, _ = self.read(path)
            box = (ctypes.c_double * 6)()
            c.need("cinch_baked_box", baked, 0, good["t0"], 1, box)
            self.assertEqual(list(box), [-math.inf, 0, 0, 1, math.inf, 1])
            c.need("cinch_free", baked)

    def test_a_surface_of_files(self):
        with tempfile.TemporaryDirectory() as folder:
            mesh, skin = pathlib.Path(folder, "a.off"), pathlib.Path(folder, "a.txt")
            mesh.write_text("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
            skin.write_text("3 2\n1 0 1\n2 0 1 1 1\n1 1 0.5\n")
            surface = c.make("cinch_surface_read", str(mesh).encode(), str(skin).encode())
            sizes = sizes_of("surface", surface)
            self.assertEqual((sizes.vertices, sizes.nodes, sizes.weights, sizes.normalised), (3, 2, 4, 2))
            c.need("cinch_free", surface)
            skin.write_text("2 2\n1 0 1\n")
            with self.assertRaisesRegex(ValueError, r"a\.txt:1: "):
                c.make("cinch_surface_read", str(mesh).encode(), str(skin).encode())

    def test_a_characters_clip_bounder_outlives_its_handles(self):
        tube = str(pathlib.Path(DATA, "scenes/tube.glb")).encode()
        character = c.make("cinch_character_read", tube, 0)
        surface, clips = ctypes.c_void_p(), ctypes.c_size_t()
        c.need("cinch_character_get_surface", character, ctypes.byref(surface), ctypes.byref(clips))
        bvh = c.make("cinch_bvh_build", surface, 16, 0, 0)
        bounder = c.make("cinch_clip_bounder_new", character, 0, bvh, None)
        bvs = sizes_of("bvh", bvh).bvs
        for handle in (character, surface, bvh):
            c.need("cinch_free", handle)
        out = (ctypes.c_double * (6 * bvs))()
        c.need("cinch_clip_bounder_bound", bounder, of.doubles([0, 2]), 1, 0.01, out, bvs)
        self.assertTrue(all(math.isfinite(x) for x in out))
        with self.assertRaisesRegex(ValueError, "do not lie in the clip's"):
            c.need("cinch_clip_bounder_bound", bounder, of.doubles([1, math.nan]), 1, 0.01, out, bvs)
        c.need("cinch_free", bounder)


unittest.main(argv=sys.argv[:1])
