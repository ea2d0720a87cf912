# SPDX-License-Identifier: GPL-3.0-or-later
"""The exact side finds what is wrong, and proves what is right."""
import json
from fractions import Fraction

import cinch
import numpy as np
import pytest
import shapes

nodes = 5
vertices, triangles = shapes.torus(12, 8)
surface = cinch.Surface(vertices.copy(), triangles, shapes.weights(vertices, nodes))
bvh = cinch.build_bvh(surface)
maps = shapes.motion(nodes, 3)


def test_bounds_of_every_method_are_proven_and_lowered_ones_are_not(exact):
    for method in cinch.methods() + ["eq12+linear"]:
        for kdop in cinch.kdops:
            supports = cinch.Refitter(bvh, method=method, kdop=kdop).supports(maps)
            verdicts = exact.verify(bvh, maps, supports, method=method)
            assert [v.violated for v in verdicts] == [0, 0, 0]
            assert verdicts[0].proven == verdicts[0].bounds == len(bvh) * kdop
    truth = cinch.Refitter(bvh, method="vertices").supports(maps[2])
    truth[7, 3] -= 1e-6
    verdict = exact.verify(bvh, maps[2], truth, method="vertices")
    assert verdict.violated == 1 and verdict.failed[7, 3] & 4 and np.count_nonzero(verdict.failed) == 1
    assert verdict.examples[0]["bv"] == 7 and verdict.examples[0]["direction"] == 3


def test_boxes_are_as_good_as_supports(exact):
    refit = cinch.Refitter(bvh)
    one, other = (exact.verify(bvh, maps[1], bounds) for bounds in (refit(maps[1]), refit.supports(maps[1])))
    assert np.array_equal(one.failed, other.failed) and np.array_equal(one.bound_radius, other.bound_radius)
    assert (one.bound_radius >= one.true_radius * (1 - 1e-12)).all()
    loss = one.loss.sum(axis=1)
    assert np.isfinite(loss).all() and (loss > -1e-12).all()


def test_infinite_maps_have_no_exact_place(exact):
    broken = maps.copy()
    broken[0, 0, 0, 0] = np.inf
    with pytest.raises(ValueError, match="not finite"):
        exact.verify(bvh, broken, cinch.Refitter(bvh)(broken))
    with pytest.raises(ValueError, match="is needed, not"):
        exact.verify(bvh, maps[0], np.zeros((len(bvh), 7)))


def test_all_times(exact, tube):
    baked = cinch.bake(tube, method="best")
    verdict = exact.verify_times(baked)
    assert verdict.proven == verdict.bounds == 6 * len(baked.bvh) * len(baked) and verdict.worst is None
    lowered = baked.supports
    lowered[0, 0, 0] -= 0.05  # more than what a tolerance of 1 % leaves
    verdict = exact.verify_times(baked, bounds=lowered)
    assert verdict.violated == 1 and verdict.worst["bv"] == 0 and verdict.worst["bound"] < verdict.worst["at_least"]


def test_any_weights_are_proven(exact, tube):
    with pytest.raises(ValueError):
        tube.with_any_weights(1, 0)
    free = tube.with_any_weights(0, 1)
    assert exact.verify_times(cinch.bake(free, whole=True)).violated == 0


def test_known_answers(exact, data):
    for file in sorted((data / "cases").glob("*.json")):
        case = json.loads(file.read_text())
        l, h = ([float.fromhex(x) if isinstance(x, str) else x for x in case[name]] for name in "lh")
        assert exact.is_feasible(l, h) == case["feasible"], file.name
        if case["n"] > 40:
            continue
        count = exact.count_corners(l, h)
        if case["vertex_count"] is not None:
            assert str(count) == str(case["vertex_count"]), file.name
        if count is not None and count <= 300:
            assert len({tuple(corner) for corner in exact.corners(l, h)}) == count
        for b, maximum in zip(case["b"], case.get("exact_max") or []):
            extrema = [float.fromhex(x) if isinstance(x, str) else x for x in b]
            best = exact.optimum(l, h, extrema)
            assert (best is None) == (maximum is None)
            if best:
                assert best.value == Fraction(maximum) and best.bound_holds
                assert not exact.optimum(l, h, extrema, bound=np.nextafter(float(best.value), -np.inf)
                                         if Fraction(float(best.value)) <= best.value else -np.inf).bound_holds


def test_volumes(exact):
    cube = exact.polytope([[0, 0, 0], [1, 2, 3]])
    assert cube.volume == 6 and cube.vertices == 8 and cube.redundant == []
    assert exact.polytope([1, 0, 2, 0, 3, 0]).volume == 6
    corner = exact.polytope([1, 1, 1, 1, 1, 1, 1, 9, 9, 9, 9, 9, 9, 9])  # one corner of a cube of side 2 is cut off
    assert corner.volume == 8 - Fraction(8, 6) and 7 in corner.redundant
    assert exact.polytope([1, -1, 1, 1, 1, 1]).volume == 0
    true = exact.true_polytope(bvh, 0, maps[1])
    bound = exact.polytope(cinch.Refitter(bvh)(maps[1])[0])
    assert 0 < true.volume <= bound.volume
    for bad in ([1, 2, 3], [np.nan] * 6, [np.inf] * 6, "x"):
        with pytest.raises(ValueError):
            exact.polytope(bad)
