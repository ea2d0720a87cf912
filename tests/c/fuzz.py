#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""fuzz.py LIBRARY HEADERS DATA SECONDS [SEED]: for so long (times CINCH_TEST_SHARE) random calls of all functions of
the library for C: right ones, and ones with wrong, null and stale handles, null pointers, numbers of rows that do not
fit, options that are none, indices out of range and what is no number. Each must return a status, and what fails must
say why; a crash is what is looked for.

What C cannot see is kept from it: arrays have the rows that are said, or more."""
import collections
import ctypes
import os
import pathlib
import random
import sys
import tempfile
import time

import library as of

LIBRARY, HEADERS, DATA, SECONDS = sys.argv[1:5]
seed = int(sys.argv[5]) if len(sys.argv) > 5 else int.from_bytes(os.urandom(4), "little")
chance = random.Random(seed)
c = of.Library(LIBRARY, HEADERS)
LEAST = 1 << 16  # bytes of every array whose size a call may get wrong
ODD = [0, -0.0, 1, -1, 0.5, 1e-320, 1e300, -1e300, 1e38, float("inf"), float("-inf"), float("nan"), 3.5, 1e-8]
KINDS = ("surface", "bvh", "refitter", "crowd", "collider", "character", "clip", "clip_bounder", "simulation", "baked")
handles = {kind: [] for kind in KINDS}
stale = []
statuses = collections.Counter()
alive = []
folder = tempfile.TemporaryDirectory()


def one_in(n):
    return chance.randrange(n) == 0


def array(kind, rows):
    """Of so many numbers, and room for what a wrong number of rows may take."""
    size = max(rows, LEAST // ctypes.sizeof(kind))
    out = (kind * size)()
    if kind in (ctypes.c_double, ctypes.c_float):
        odd = one_in(4)
        for i in range(min(rows, 600)):
            out[i] = chance.choice(ODD) if odd and one_in(3) else chance.uniform(-2, 2)
    elif kind is ctypes.c_uint32:
        for i in range(min(rows, 600)):
            out[i] = chance.randrange(4)
    return out


def pointer(value, odd=40):
    """To an array or structure, which lives until the end of the round; seldom null or not aligned."""
    alive.append(value)
    if one_in(odd):
        return None
    if one_in(3 * odd):
        return ctypes.addressof(value) + 1 if ctypes.sizeof(value) > 8 else ctypes.addressof(value)
    return ctypes.addressof(value)


def count(wanted, most=None):
    """Mostly what is wanted; else less, or what no array can have."""
    if not one_in(12):
        return wanted
    return chance.choice([0, 1, max(wanted - 1, 0), wanted // 2, 2**64 - 1, 2**63, 2**61])


def handle(kind, odd=15):
    if one_in(odd):
        wrong = [None, 1, 8, 2**64 - 1, chance.getrandbits(64), ctypes.addressof(keep), 0xc19c << 48]
        others = [h for all_of in handles.values() for h in all_of]
        return chance.choice(wrong + stale[-20:] + others)
    return chance.choice(handles[kind]) if handles[kind] else None


keep = (ctypes.c_double * 1000)()


def called(name, *arguments):
    status = getattr(c, name)(*arguments)
    assert 0 <= status < 10, (name, status, c.message())  # 10: a fault of cinch
    assert status == 0 or c.message(), name
    statuses[name, status == 0] += 1
    return status


def made(kind, name, *arguments):
    out = ctypes.c_void_p(77)
    status = called(name, *arguments, None if one_in(60) else ctypes.byref(out))
    if status == 0:
        assert out.value
        handles[kind].append(out.value)
        if len(handles[kind]) > 4:
            free(kind)
        return out.value
    return None


def free(kind=None):
    kind = kind or chance.choice(KINDS)
    if handles[kind] and not one_in(20):
        stale.append(handles[kind].pop(chance.randrange(len(handles[kind]))))
        assert called("cinch_free", stale[-1]) == 0
    else:
        called("cinch_free", chance.choice([None, 1, chance.getrandbits(64)] + stale[-5:]))


def options(kind):
    """At random, or by default."""
    if one_in(2):
        return None
    out = c.structures[kind]()
    for name, number in out._fields_:
        if one_in(2):
            continue
        choices = {"methods": [1 << chance.randrange(12), chance.getrandbits(11)], "kdop": [6, 14, 18, 26, 7, -6],
                   "passes": [1, 2, 3, -1, 2**31 - 1], "level": [0, 1, 2, 5, 2**31 - 1, -1], "update": [0, 1, 2, 3, -1],
                   "lanes": [4, 8, 16, 5, -4]}.get(name, [0, 1, 1, 2])
        setattr(out, name, chance.choice(choices))
    return pointer(out, 6)


def new_surface():
    arrays = of.strip_arrays(c, chance.choice([1, 3, 10, 40]), chance.choice([0, 0, 2]))
    for _ in range(chance.choice([0, 0, 0, 1, 2])):
        kind = chance.randrange(3)
        if kind == 0:
            field = chance.choice(list(arrays.kept))
            values = arrays.kept[field]
            place = chance.randrange(len(values))
            values[place] = chance.choice(ODD if values._type_ is ctypes.c_double else [0, 1, 7, 2**32 - 1])
        elif kind == 1:
            field = chance.choice(["vertex_count", "triangle_count", "weight_count", "node_count",
                                   "displacement_count"])
            most = [2**32 - 1, 2**24 + 1, 500] if field == "node_count" else [2**63]
            setattr(arrays, field, chance.choice([0, 1, getattr(arrays, field) // 2] + most))
        else:
            setattr(arrays, chance.choice(list(arrays.kept)), None)
    if one_in(5) and arrays.node_count <= 2:
        arrays.rest = array(ctypes.c_double, 24)
        arrays.rest_maps = ctypes.addressof(arrays.rest)
    made("surface", "cinch_surface_from_arrays", pointer(arrays))


def sizes(kind, of_what):
    out = c.structures[f"cinch_{kind}_sizes"]()
    called(f"cinch_{kind}_get_sizes", of_what, ctypes.byref(out))
    return out


def read_surface():
    paths = []
    for name, text in (("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
                       ("a.txt", "3 2\n1 0 1\n2 0 1 1 1\n1 1 0.5\n")):
        place = chance.randrange(len(text))
        path = pathlib.Path(folder.name, name)
        path.write_text(text[:place] + chance.choice("x-19 .") + text[place + 1:] if one_in(4) else text)
        paths.append(chance.choice([None, b""]) if one_in(10) else str(path).encode())
    made("surface", "cinch_surface_read", *paths)


def look_at_surface():
    surface = handle("surface")
    s = sizes("surface", surface)
    n, t, w = s.vertices, s.triangles, s.weights
    called("cinch_surface_get_mesh", surface, pointer(array(ctypes.c_double, 3 * n)), count(n),
           pointer(array(ctypes.c_uint32, 3 * t)), count(t))
    called("cinch_surface_get_weights", surface, pointer(array(ctypes.c_uint32, n + 1)), count(n + 1),
           pointer(array(ctypes.c_uint32, w)), pointer(array(ctypes.c_double, w)), count(w))
    called("cinch_surface_evaluate", surface, pointer(array(ctypes.c_double, 12 * s.nodes)), count(s.nodes),
           pointer(array(ctypes.c_double, s.targets)), count(s.targets), pointer(array(ctypes.c_double, 3 * n)),
           count(n))


def new_bvh(surface=None):
    bvh = made("bvh", "cinch_bvh_build", surface or handle("surface"), chance.choice([0, 1, 4, 16, 2**64 - 1]),
               chance.choice([0, 0, 2, 3, 16, 2**64 - 1]), chance.choice([0, 0, 0, 1, 2, 3, -1]))
    bvs_of[bvh] = sizes("bvh", bvh).bvs if bvh else 0
    return bvh


def look_at_bvh():
    bvh = handle("bvh")
    s = sizes("bvh", bvh)
    for name, kind, n in (("bvs", "cinch_bv", s.bvs), ("influences", "cinch_influence", s.influences)):
        called(f"cinch_bvh_get_{name}", bvh, pointer(array(c.structures[kind], n)), count(n))
    which = chance.randrange(-1, 4)
    n = [s.levels + 1, s.triangles, s.points, 0, 0][which]
    called("cinch_bvh_get_indices", bvh, which, pointer(array(ctypes.c_uint32, n)), count(n))


def new_refitter():
    at, bvh = options("cinch_refit_options"), handle("bvh")
    bvs_of[made("refitter", "cinch_refitter_new", bvh, at)] = bvs_of.get(bvh, 0)


bvs_of = {}  # of trees, and of what was made of them


def refit():
    refitter, frames = handle("refitter"), chance.choice([0, 1, 1, 2, 5])
    reports = (c.structures["cinch_refit_report"] * 8)()
    rows = bvs_of.get(refitter, 0)
    called("cinch_refitter_refit", refitter, frames, pointer(array(ctypes.c_double, 24 * frames)), count(2 * frames),
           pointer(array(ctypes.c_double, 2 * frames)), chance.choice([0, 0, 2 * frames, 1]),
           pointer(array(ctypes.c_double, 26 * frames * rows)), count(frames * rows),
           chance.choice([None, ctypes.addressof(reports)]))


def crowd():
    if one_in(3):
        at = options("cinch_crowd_options")
        made("crowd", "cinch_crowd_new", handle("bvh"), at)
    which, n = handle("crowd"), ctypes.c_size_t()
    called("cinch_crowd_get_bvs", which, pointer(array(ctypes.c_uint32, 64)), 64, pointer(n))
    bodies = chance.choice([0, 1, 3, 20])
    called("cinch_crowd_refit", which, pointer(array(ctypes.c_double, 24 * bodies)), count(2 * bodies),
           pointer(array(ctypes.c_double, 6 * bodies * n.value)), count(bodies * n.value))


def said_by_chance(*_):
    return chance.randrange(2)


FILTERS = [c.callbacks["cinch_filter"](), c.callbacks["cinch_filter"](said_by_chance)]


def new_collider():
    at = options("cinch_body_options")
    made("collider", "cinch_collider_new", at)


def collide():
    collider, n, ident = handle("collider"), ctypes.c_size_t(), ctypes.c_uint32()
    if one_in(2):
        at = options("cinch_body_options")
        called("cinch_collider_add", collider, handle("surface"), None if one_in(2) else handle("bvh"),
               None if one_in(2) else at, pointer(ident))
    if one_in(6):
        called("cinch_collider_remove", collider, chance.randrange(6))
    if one_in(6):
        called("cinch_collider_set_filter", collider, chance.choice(FILTERS), None)
    ids = array(ctypes.c_uint32, 64)
    called("cinch_collider_get_bodies", collider, chance.choice([0, 0, 1, 2]), pointer(ids), 64, pointer(n))
    bodies, kept = n.value if n.value < 64 else 0, []
    frames = (c.structures["cinch_body_frame"] * 64)()
    for frame in frames[:bodies]:
        for field, rows, wide in (("map", 2, 12), ("position", chance.choice([0, 0, 4, 8, 22, 82]), 3),
                                  ("weight", chance.choice([0, 0, 2]), 1)):
            kept.append(array(ctypes.c_double, rows * wide))
            setattr(frame, {"map": "maps", "position": "positions", "weight": "weights"}[field], pointer(kept[-1]))
            setattr(frame, field + "_count", count(rows))
    called("cinch_collider_update", collider, pointer(frames), count(bodies))
    for _ in range(2):
        called("cinch_collider_query", collider, chance.choice([0, 0, 1, 2, 3, -1]), pointer(n))
        called("cinch_collider_get_pairs", collider, pointer(array(ctypes.c_uint32, 4 * n.value)), count(n.value))
    called("cinch_collider_get_counts", collider, pointer(c.structures["cinch_query_counts"]()))


def swept():
    bodies, n, kept = (c.structures["cinch_swept_body"] * 3)(), ctypes.c_size_t(), []
    k = chance.choice([6, 14, 0, 5])
    for body in bodies:
        body.bvh = handle("bvh")
        s = c.structures["cinch_bvh_sizes"]()
        c.cinch_bvh_get_sizes(body.bvh, ctypes.byref(s))
        kept.append(array(ctypes.c_double, 14 * s.bvs))
        body.supports, body.support_count = pointer(kept[-1]), count(s.bvs)
    called("cinch_swept_leaf_pairs", pointer(bodies), chance.randrange(4), k, pointer(array(ctypes.c_uint32, 400)), 100,
           pointer(n))
    rows = chance.choice([0, 7, 60])
    a, b = array(ctypes.c_double, rows), array(ctypes.c_double, rows)
    called("cinch_swept", pointer(a), pointer(b), pointer(a), count(rows))
    called("cinch_boxes_of", pointer(array(ctypes.c_double, 26 * rows)), chance.choice([6, 26, 0, 5]),
           pointer(array(ctypes.c_double, 6 * rows)), count(rows))
    called("cinch_maps_from_floats", pointer(array(ctypes.c_float, 16 * rows)), chance.randrange(-1, 4),
           pointer(array(ctypes.c_double, 12 * rows)), count(rows))
    called("cinch_axes", chance.choice([6, 14, 18, 26, 0, 3]), pointer(array(ctypes.c_int32, 39)),
           chance.choice([3, 7, 9, 13, 0, 2**63]))


def path_of(name):
    """A file of the data, seldom damaged, or what is none."""
    whole = (pathlib.Path(DATA) / name).read_bytes()
    if one_in(3):
        return chance.choice([None, b"", b"/", b"no.file", str(pathlib.Path(DATA)).encode()])
    if not one_in(3):
        return str(pathlib.Path(DATA) / name).encode()
    damaged = bytearray(whole[:chance.randrange(len(whole))] if one_in(3) else whole)
    for _ in range(chance.randrange(1, 4)):
        if damaged:
            damaged[chance.randrange(len(damaged))] = chance.choice(b'0{}[]",-e\xff')
    path = pathlib.Path(folder.name, pathlib.Path(name).name)
    path.write_bytes(damaged)
    return str(path).encode()


def characters():
    if one_in(3):
        made("character", "cinch_character_read", path_of("scenes/tube.glb"), chance.randrange(3))
    character, clips, surface = handle("character"), ctypes.c_size_t(), ctypes.c_void_p()
    if called("cinch_character_get_surface", character, ctypes.byref(surface), ctypes.byref(clips)) == 0:
        handles["surface"].append(surface.value)
        if len(handles["surface"]) > 6:
            called("cinch_free", handles["surface"].pop(0))
    clip = chance.choice([0, 0, 0, 1, 2**64 - 1, 2**63])
    called("cinch_character_get_clip", character, clip, pointer(c.structures["cinch_clip_info"]()))
    frames, clip_of = ctypes.c_size_t(), ctypes.c_void_p()
    if called("cinch_character_sample", character, clip, chance.choice([1, 10, 0, -1, 1e-300, 1e300, float("nan")]),
              ctypes.byref(clip_of), ctypes.byref(frames)) == 0:
        time_s = ctypes.c_double()
        frame = chance.choice([0, max(frames.value - 1, 0), 2**63])
        called("cinch_clip_get_frame", handle("clip", 2) or clip_of, frame, pointer(time_s),
               pointer(array(ctypes.c_double, 12 * 100)), count(4), None, count(0))
        called("cinch_free", clip_of)
    bvh = new_bvh(surface.value) if surface.value and one_in(2) else handle("bvh")
    at = options("cinch_refit_options")
    bvs_of[made("clip_bounder", "cinch_clip_bounder_new", character, clip, bvh, at)] = bvs_of.get(bvh, 0)
    bounder = handle("clip_bounder")
    times = of.doubles(sorted(chance.choice([0, 0.5, 1, 2] if one_in(2) else ODD) for _ in range(2)))
    rows = bvs_of.get(bounder, 1)
    called("cinch_clip_bounder_bound", bounder, pointer(times), 1, chance.choice([0.01, 0.1, 1, -1, float("nan")]),
           pointer(array(ctypes.c_double, 26 * rows)), count(rows))


def scenes():
    if one_in(3):
        made("simulation", "cinch_simulation_read", path_of("scenes/beam.json"))
    scene, n = handle("simulation"), ctypes.c_size_t()
    called("cinch_simulation_get_state", scene, pointer(c.structures["cinch_simulation_state"]()))
    name, surface = ctypes.c_void_p(), ctypes.c_void_p()
    if called("cinch_simulation_get_body", scene, chance.choice([0, 0, 1, 2**63]), ctypes.byref(name),
              ctypes.byref(surface)) == 0 and surface.value:
        called("cinch_free", surface)
    called("cinch_simulation_get_maps", scene, chance.choice([0, 0, 1]), pointer(array(ctypes.c_double, 1200)), 100,
           pointer(n))
    if one_in(5):
        called("cinch_simulation_advance", scene)


def baked():
    n = ctypes.c_size_t()
    out = ctypes.c_void_p()
    if one_in(2) and called("cinch_baked_read", path_of("../tests/examples/bounds.jsonl"), ctypes.byref(out),
                            ctypes.byref(n)) == 0:
        handles["baked"].append(out.value)
    which, info = handle("baked"), c.structures["cinch_baked_clip"]()
    clip = chance.choice([0, 0, 1, 2**63])
    called("cinch_baked_get_clip", which, clip, ctypes.byref(info))
    rows = info.intervals * info.bvs
    called("cinch_baked_get_supports", which, clip, pointer(array(ctypes.c_double, 2 * info.intervals)),
           count(info.intervals), pointer(array(ctypes.c_double, 26 * rows)), count(rows))
    called("cinch_baked_box", which, clip, chance.choice([0, 1, float("nan"), 9]), chance.choice([0, 1, 2**63]),
           pointer(array(ctypes.c_double, 6)))


def run_by_chance(_, n, task, work):
    for i in range(n):
        if not one_in(200):
            task(work, i)
        if one_in(50):
            task(work, chance.choice([0, i, n, 2**63]))


RUNS = [c.callbacks["cinch_run"](), c.callbacks["cinch_run"](run_by_chance)]


def library():
    called("cinch_use_executor", chance.choice(RUNS), None)
    if called("cinch_begin_default_arithmetic") == 0 and not one_in(20):
        called("cinch_end_default_arithmetic")
    if one_in(20):
        called("cinch_end_default_arithmetic")
    called("cinch_check_arithmetic")
    free()


ACTIONS = [new_surface, read_surface, look_at_surface, new_bvh, look_at_bvh, new_refitter, refit, crowd, new_collider,
           collide, swept, characters, scenes, baked, library, free]
print(f"seed {seed}", flush=True)
end, rounds = time.monotonic() + float(SECONDS) * float(os.environ.get("CINCH_TEST_SHARE", 1)), 0
while time.monotonic() < end:
    chance.choice(ACTIONS)()
    alive.clear()
    rounds += 1
called_well = sum(n for (_, well), n in statuses.items() if well)
print(f"{rounds} rounds, {sum(statuses.values())} calls, {called_well} of them succeeded")
if rounds > 3000:
    missing = [name for name in c.functions if c.functions[name] and (name, True) not in statuses]
    assert not missing, f"never succeeded: {missing}"
