# SPDX-License-Identifier: GPL-3.0-or-later
"""Whatever is handed in: a Python error with a sentence, never a crash, never a wrong answer."""
import gc
import importlib
import importlib.util
import os
import signal
import threading
import time

import cinch
import numpy as np
import pytest
import shapes

nodes = 6
vertices, triangles = shapes.torus(16, 10)
dense = shapes.weights(vertices, nodes)


def made(**options):
    return cinch.Surface(vertices.copy(), triangles, dense, **options)


def says(text, call, *arguments, error=ValueError, **more):
    with pytest.raises(error) as raised:
        call(*arguments, **more)
    assert text in str(raised.value), str(raised.value)


def test_shapes_kinds_and_numbers_of_surfaces():
    for bad in (np.zeros(3), np.zeros((4, 2)), np.zeros((2, 3, 3)), 1.0):
        says("vertices: an array of shape (n, 3) is needed", cinch.Surface, bad, triangles, dense)
    for bad in (vertices.astype(complex), vertices.astype(str), vertices.astype(np.longdouble), vertices > 0):
        says("vertices: an array of float64 is needed", cinch.Surface, bad, triangles, dense)
    says("vertices: an array of numbers is needed", cinch.Surface, None, triangles, dense)
    for bad in (np.nan, np.inf, -np.inf):
        wrong = vertices.copy()
        wrong[7, 1] = bad
        says("vertices[7]", cinch.Surface, wrong, triangles, dense)
    says("triangles: an array of shape (n, 3)", cinch.Surface, vertices.copy(), triangles[:, :2], dense)
    says("whole numbers", cinch.Surface, vertices.copy(), triangles.astype(float), dense)
    for bad in (-1, len(vertices), 2**40):
        wrong = triangles.astype(np.int64)
        wrong[5, 2] = bad
        says(f"index {bad} at place 17 is out of range", cinch.Surface, vertices.copy(), wrong, dense)


def test_layouts_group_triangles_and_change_no_truth():
    moved = vertices * [1, 1, 9]
    says("layout: an array of shape", made, layout=vertices[1:])
    says("layout[2]", made, layout=np.where(np.arange(len(vertices))[:, None] == 2, np.nan, vertices))
    plain, laid = (cinch.build_bvh(made(**more)) for more in ({}, {"layout": moved}))
    assert np.array_equal(laid.surface.layout, moved) and plain.surface.layout is None
    assert not np.array_equal(plain.triangle, laid.triangle)
    assert np.array_equal(np.sort(plain.triangle), np.sort(laid.triangle))
    assert plain.local.shape == (len(plain.node), 6) and plain.model.shape == (len(plain.node), 8)
    assert np.allclose(np.add.reduceat(plain.model[:, 0], plain.first_influence), 1, rtol=0, atol=1e-15)


def test_weights_that_are_not_convex():
    def weights(change, **options):
        wrong = dense.copy()
        change(wrong)
        return cinch.Weights(wrong, **options)

    says("vertex 3 has -0.1", weights, lambda w: w.__setitem__((3, 0), -0.1))
    says("vertex 3 has nan", weights, lambda w: w.__setitem__((3, 0), np.nan), normalise=True)
    says("normalise=True divides", weights, lambda w: w.__imul__(0.9))
    assert weights(lambda w: w.__imul__(0.9), normalise=True).report.normalised == len(vertices)
    says("has no influence", weights, lambda w: w.__setitem__(4, 0), normalise=True)
    says("the sum overflows", cinch.Weights, [[1e308, 1e308]], normalise=True)
    says("rows for", cinch.Surface, vertices.copy(), triangles, dense[1:])
    data, indices, indptr = shapes.csr(dense)
    says("out of range", cinch.Weights, (data, indices, indptr), nodes=nodes - 1)
    says("twice", cinch.Weights, ([0.5, 0.5], [1, 1], [0, 2]))
    for bad in (indptr[::-1], indptr[:-1], indptr + 1, [], [0]):
        with pytest.raises(ValueError):
            cinch.Weights((data, indices, bad))


def test_triplets_dense_and_sparse_are_the_same():
    class Csr:  # what SciPy's have
        shape = dense.shape

        def __init__(self):
            self.data, self.indices, self.indptr = shapes.csr(dense)

    data, indices, indptr = shapes.csr(dense)
    every = [cinch.Weights(Csr()), cinch.Weights(dense), cinch.Weights((data, indices, indptr), nodes=nodes),
             cinch.Weights((data.tolist(), indices.tolist(), indptr.tolist()), nodes=nodes)]
    if importlib.util.find_spec("scipy"):
        from scipy import sparse
        every += [cinch.Weights(sparse.csr_matrix(dense)), cinch.Weights(sparse.coo_array(dense))]
    backward = [np.concatenate([part[a:b][::-1] for a, b in zip(indptr, indptr[1:])]) for part in (data, indices)]
    every.append(cinch.Weights((*backward, indptr), nodes=nodes))
    for one in every:
        assert np.array_equal(one.toarray(), every[0].toarray()) and one.shape == dense.shape
        assert (one.toarray().sum(axis=1) == 1).all()


def test_no_copy_on_the_way_in():
    many, corners = shapes.torus(300, 100)
    assert len(many) == 30_000
    where = many.ctypes.data
    surface = cinch.Surface(many, corners, shapes.weights(many, 8))
    assert surface.shares_memory and surface.vertices.ctypes.data == where
    bvh = cinch.build_bvh(surface, 64, detail="boxes")
    kept = many.copy()
    with pytest.raises(ValueError, match="read-only"):
        many[0] = 7
    with pytest.raises(ValueError):
        many.resize((5, 3), refcheck=False)
    maps = shapes.motion(8, 1)[0]
    before = cinch.evaluate(surface, maps)
    del many, surface
    gc.collect()
    assert np.array_equal(cinch.evaluate(bvh.surface, maps), before)
    assert np.array_equal(bvh.surface.vertices, kept)


def test_what_cannot_be_shared_is_copied():
    lists = cinch.Surface(vertices.tolist(), triangles.tolist(), dense.tolist())
    for other in (np.asfortranarray(vertices), vertices.astype(">f8"), vertices[::-1],
                  np.pad(vertices, 1)[1:-1, 1:-1], np.vstack([vertices, vertices])[:len(vertices)]):
        surface = cinch.Surface(other, triangles, dense)
        assert surface.vertices.ctypes.data != other.ctypes.data and other.flags.writeable
        assert np.array_equal(surface.vertices, other)
    own = vertices.copy()
    assert not cinch.Surface(own, triangles, dense, copy=True).shares_memory and own.flags.writeable
    flat = np.array(vertices.ravel())
    assert cinch.Surface(flat.reshape(-1, 3), triangles, dense).shares_memory and not flat.flags.writeable
    assert np.array_equal(lists.vertices, vertices)


def test_an_array_that_is_changed_all_the_same_is_an_error():
    own = vertices.copy()
    back_door = own[:]
    surface = cinch.Surface(own, triangles, dense)
    bvh = cinch.build_bvh(surface)
    refit = cinch.Refitter(bvh, method="vertices")
    maps = shapes.motion(nodes, 1)[0]
    back_door[3, 0] += 1
    for call in (lambda: cinch.build_bvh(surface), lambda: cinch.evaluate(surface, maps), lambda: refit(maps),
                 lambda: cinch.Refitter(bvh), lambda: cinch.Collider().add(surface),
                 lambda: cinch.SurfaceEvaluator(surface)):
        says("was changed after the surface was made", call)


def test_frames():
    bvh = cinch.build_bvh(made())
    refit = cinch.Refitter(bvh)
    maps = shapes.motion(nodes, 4)
    for bad in (maps[:, 1:], maps[0, 0], maps.reshape(4, nodes, 12), maps.astype(complex), np.zeros(0), "x", None,
                [[]]):
        with pytest.raises(ValueError):
            refit(bad)
    for out in (np.empty((4, len(bvh), 6)), np.empty((4, len(bvh), 2, 3), np.float32), np.empty((2, 3, len(bvh), 4)).T,
                np.broadcast_to(np.empty(3), (4, len(bvh), 2, 3)), [1]):
        with pytest.raises(ValueError):
            refit(maps, out=out)
    out = np.empty((4, len(bvh), 2, 3))
    assert refit(maps, out=out) is out and np.array_equal(out, refit(maps))
    assert refit(maps[:0]).shape == (0, len(bvh), 2, 3)
    broken = maps.copy()
    broken[2, 1, 0, 0] = np.nan
    bounds = refit(broken)
    assert not np.isnan(bounds).any() and np.isinf(bounds[2, 0]).all() and np.isfinite(bounds[1]).all()
    assert refit.report.unbounded_nodes == 1 and refit.report.infinite > 0


def test_options():
    bvh = cinch.build_bvh(made(), detail="boxes")
    says("method: 'bets' is unknown; known are convex", cinch.Refitter, bvh, method="bets")
    says("k must be 6, 14, 18 or 26", cinch.Refitter, bvh, kdop=8)
    says("precision", cinch.Refitter, bvh, precision="half")
    says("passes", cinch.Refitter, bvh, method="eq12", passes=-1)
    says("no option 'mehtod'", cinch.Refitter, bvh, mehtod="best", error=TypeError)
    says("option kdop", cinch.Refitter, bvh, kdop="six", error=TypeError)
    says("without the rest data", cinch.Refitter, bvh)
    says("a leaf needs at least one triangle", cinch.build_bvh, made(), 0)
    if importlib.util.find_spec("cinch.exact._exact"):
        says("without some of its rest data", importlib.import_module("cinch.exact").Verifier, bvh)
    says("without the rest data", cinch.Refitter, bvh, method="sphere")
    says("without local boxes", cinch.CrowdRefitter, bvh)
    bounder = cinch.AnytimeBounder(bvh, method="eq12")
    rest = np.tile(np.eye(3, 4), (bvh.surface.node_count, 1, 1))
    says("bv: there are", bounder, rest, len(bvh), error=IndexError)
    says("tolerance: at least 0", bounder, rest, tolerance=float("nan"))
    says("seconds: 0 to", bounder, rest, seconds=-1)
    says("maps: an array of shape", bounder, rest[1:])
    says("not built over this surface", cinch.Refitter, bvh, made(), method="eq12")
    with pytest.raises(TypeError):
        cinch.build_bvh(made(), -1)
    with pytest.raises(TypeError):
        cinch.Bvh()


def test_files(tmp_path, data):
    says("no-such.obj", cinch.read_mesh, tmp_path / "no-such.obj", error=cinch.InputError)
    bad = tmp_path / "bad.obj"
    bad.write_text("v 0 0 0\nf 1 2 3\n")
    says("bad.obj:2: ", cinch.read_mesh, bad)
    assert issubclass(cinch.InputError, ValueError)
    says("is no glTF file", cinch.read_character, data / "scenes" / "beam.json")
    tube = cinch.read_character(data / "scenes" / "tube.glb")
    says("has no clip 'walk'; it has wave", tube.sample, "walk")
    says("of another character", tube.sample, cinch.read_character(data / "scenes" / "tube.glb").clips[0])
    says("fps", tube.sample, fps=0)
    bvh = cinch.build_bvh(tube.surface)
    bound = cinch.ClipBounder(tube, "wave", bvh)
    says("do not lie in the clip's", bound, 0, 3)
    says("finite", bound, 0, np.nan)
    says("not built over the character's surface", cinch.ClipBounder, tube, "wave", cinch.build_bvh(made()))
    says("beam", cinch.Simulation, tmp_path / "beam.json", error=cinch.InputError)
    says("scene", cinch.Simulation, "{", folder=tmp_path, error=cinch.InputError)


def test_colliders():
    surface, maps = made(), shapes.motion(nodes, 1)[0]
    collider = cinch.Collider()
    says("a query", collider.pairs, error=RuntimeError)
    first, second = collider.add(surface), collider.add(cinch.build_bvh(surface, 4))
    says("maps: one per body", collider.update, [maps])
    says("maps: an array of shape", collider.update, [maps, maps[1:]])
    says("positions: an array", collider.update, [maps, maps], positions=[None, vertices[1:]])
    collider.update([maps, maps])
    assert collider.pairs().shape[1] == 4 and collider.any()
    says("more triangles or vertices than lanes", collider.add, cinch.build_bvh(surface, 100))
    collider.remove(collider.add(surface))
    says("a query", collider.pairs, error=RuntimeError)
    collider.update([maps, maps])
    collider.set_filter(lambda a, b: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        collider.pairs()
    collider.update([maps, maps])
    collider.set_filter(lambda a, b: collider.pairs())
    says("in a call already", collider.pairs, error=RuntimeError)
    collider.set_filter(None)
    collider.remove(first)
    says("there is no body", collider.remove, first)
    assert collider.bodies == [second]
    says("morph target 0 displaces vertex", collider.add, surface,
         [cinch.MorphTarget([len(vertices)], np.zeros((1, 3)))])


def test_forces_that_fail():
    scene = ('{"name": "jelly", "duration": 0.1, "bodies": [{"name": "box", "surface": "box", "box": [1, 1, 1], '
             '"cells": [2, 2, 2], "lattice": [4, 4, 4]}], "effects": [{"effect": "elastic", "young": 1e4}]}')

    class Bad:
        def energy(self, positions, masses, time_s):
            return 0.0

        def force(self, positions, masses, time_s):
            raise ZeroDivisionError("of mine")

    simulation = cinch.Simulation(scene, folder=".")
    says("no energy", simulation.add_force, 0, object(), error=TypeError)
    says("out of range", simulation.add_force, 5, Bad(), error=IndexError)
    simulation.add_force(0, Bad())
    says("of mine", simulation.advance, error=ZeroDivisionError)


def test_two_threads_at_once():
    refit = cinch.Refitter(cinch.build_bvh(made()))
    maps = shapes.motion(nodes, 3000)
    faults, answers = [], []

    def run():
        try:
            answers.append(refit(maps))
        except RuntimeError as error:
            faults.append(str(error))

    threads = [threading.Thread(target=run) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert answers and all(np.array_equal(a, answers[0]) for a in answers)
    assert all("in a call already" in fault for fault in faults)
    assert refit(maps[:1]).shape[0] == 1


def test_interrupts_and_progress():
    refit = cinch.Refitter(cinch.build_bvh(made(), 1))
    maps = np.broadcast_to(shapes.motion(nodes, 1), (1_000_000, nodes, 3, 4))[:60_000].copy()
    threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    began = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        while time.monotonic() - began < 60:
            refit(maps)
    assert time.monotonic() - began < 10
    seen = []
    refit(maps[:500], progress=lambda done, of: seen.append((done, of)))
    assert seen[-1] == (500, 500)

    def enough(done, of):
        raise StopAsyncIteration

    with pytest.raises(StopAsyncIteration):
        refit(maps, progress=enough)
    assert refit(maps[:2]).shape[0] == 2


def test_interrupts_of_what_has_no_pieces():
    many, corners = shapes.torus(500, 400)
    threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    began = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        while time.monotonic() - began < 60:
            cinch.sample_nodes(many, corners, 2000)
    assert time.monotonic() - began < 10


def test_what_is_freed_is_kept_by_those_who_need_it():
    refit = cinch.Refitter(cinch.build_bvh(made()))
    maps = shapes.motion(nodes, 2)
    same = refit(maps)
    views = [refit.bvh.l, refit.bvh.centre, refit.bvh.surface.triangles, refit.bvh.surface.weights.data]
    copies = [view.copy() for view in views]
    collider = cinch.Collider()
    collider.add(made()), collider.add(made())
    collider.update([maps[0].copy(), maps[1].copy()])
    bvh = refit.bvh
    del refit
    gc.collect()
    assert np.array_equal(cinch.Refitter(bvh)(maps), same)
    del bvh
    gc.collect()
    np.empty(10**6).fill(7)
    assert all(np.array_equal(a, b) for a, b in zip(views, copies))
    assert all(not view.flags.writeable for view in views)
    assert collider.pairs().ndim == 2
