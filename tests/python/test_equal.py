# SPDX-License-Identifier: GPL-3.0-or-later
"""The same bits as C++, and as the program cinch."""
import json
import subprocess

import cinch
import numpy as np
import pytest
import reference
import shapes

needs_reference = pytest.mark.skipif(not reference.library, reason="SKIPPED: the library of reference.cpp is not built")


def made(method="best", kdop=6, precision="float32", leaf=4, nodes=12):
    vertices, triangles = shapes.torus(30, 14)
    dense = shapes.weights(vertices, nodes)
    surface = cinch.Surface(vertices, triangles, dense)
    bvh = cinch.build_bvh(surface, leaf)
    refit = cinch.Refitter(bvh, surface, method=method, kdop=kdop, precision=precision)
    return refit, reference.Reference(vertices, triangles, dense, leaf, method, kdop, precision)


@needs_reference
@pytest.mark.parametrize("method", cinch.methods() + ["support+linear"])
@pytest.mark.parametrize("kdop", cinch.kdops)
def test_bounds_are_those_of_cpp(method, kdop):
    for precision in ("float32", "float64"):
        refit, same = made(method, kdop, precision)
        maps = shapes.motion(12, 3)
        theirs, _ = same.refit(maps)
        assert np.array_equal(refit.supports(maps), theirs)
        assert np.array_equal(refit.supports(maps[1]), theirs[1])
        ours = refit(maps)
        if kdop == 6:
            assert ours.shape == (3, same.bvs, 2, 3)
            assert np.array_equal(ours[:, :, 1], theirs[:, :, 0::2]) and np.array_equal(ours[:, :, 0],
                                                                                        -theirs[:, :, 1::2])
        else:
            assert np.array_equal(ours, theirs)


@needs_reference
def test_weights_vertices_crowds_and_pairs_are_those_of_cpp():
    refit, same = made()
    surface, maps = refit.bvh.surface, shapes.motion(12, 2)
    assert np.array_equal(surface.weights.data, same.weights())
    assert np.array_equal(cinch.evaluate(surface, maps)[1], same.evaluate(maps[1]))
    assert np.array_equal(cinch.SurfaceEvaluator(surface)(maps)[1], same.evaluate(maps[1]))
    for level in (0, 3):
        crowd = cinch.CrowdRefitter(refit.bvh, level=level)
        assert np.array_equal(crowd(maps), same.crowd(maps, level))
    moved = maps[0] + np.eye(3, 4, 3) * 0.4
    collider = cinch.Collider()
    collider.add(surface), collider.add(surface)
    collider.update([maps[0], moved])
    theirs = same.pairs(np.ascontiguousarray(maps[0]), moved)
    assert len(theirs) > 100 and np.array_equal(collider.pairs(), theirs)


@pytest.mark.parametrize("kdop", cinch.kdops)
def test_a_bound_that_tightens_goes_from_one_bound_to_the_true_box(kdop):
    refit, _ = made(kdop=kdop)
    maps = shapes.motion(12, 3)
    first, truth = refit(maps), cinch.Refitter(refit.bvh, method="vertices", kdop=kdop)(maps)
    bounder = cinch.AnytimeBounder(refit.bvh, kdop=kdop)
    for bv in (0, 5, len(refit.bvh) - 1):
        one, half, end = (bounder(maps, bv, **stop) for stop in ({"seconds": 0}, {"tolerance": 0.05}, {}))
        if kdop == 6:  # boxes: the least corner is the less the looser
            one, half, end, of_all = (x * [[-1], [1]] for x in (one, half, end, truth[:, bv]))
            assert np.array_equal(one, first[:, bv] * [[-1], [1]])
        else:
            of_all = truth[:, bv]
            assert np.array_equal(one, first[:, bv])
        assert (end <= half).all() and (half <= one).all() and (end < one).any()
        assert np.array_equal(end, np.minimum(of_all, one))
    assert np.array_equal(bounder(maps[1]), bounder(maps)[1])


def test_baked_bounds_are_those_of_the_program(program, data, tube, tmp_path):
    for options, more in ((["--kdop", "14"], {"kdop": 14}), (["--interval", "0.3"], {"interval": 0.3}),
                          (["--whole", "--method", "eq12"], {"whole": True, "method": "eq12"}),
                          (["--engine", "float32", "--nlerp"], {"engine": {"float32": True, "nlerp": True}})):
        file = tmp_path / "bounds.npz"
        subprocess.run([program, "bake", data / "scenes" / "tube.glb", "--level", "-1", "--npz", file, *options],
                       check=True, stdout=subprocess.DEVNULL)
        theirs = np.load(file)
        ours = cinch.bake(tube, "wave", **more)
        assert np.array_equal(ours.times, theirs["wave/times"])
        assert np.array_equal(ours.bounds, theirs["wave/bounds"])


def test_verdicts_are_those_of_the_program(program, data, tube, exact):
    printed = subprocess.run([program, "verify", data / "scenes" / "tube.glb", "--frames", "3", "--json", "--method",
                              "local", "--kdop", "18"], check=True, capture_output=True, text=True).stdout
    record = next(r for r in map(json.loads, printed.splitlines()) if "bounds" in r)
    clip = tube.sample(fps=30).evenly_spread(3)
    bvh = cinch.build_bvh(tube.surface, 1)
    supports = cinch.Refitter(bvh, method="local", kdop=18)(clip)
    verdicts = exact.verify(bvh, clip, supports, method="local")
    assert sum(v.bounds for v in verdicts) == record["bounds"]
    assert sum(v.proven for v in verdicts) == record["proven"] and record["violated"] == 0
