# SPDX-License-Identifier: GPL-3.0-or-later
"""What must hold of every surface and motion (hypothesis)."""
import cinch
import numpy as np
import shapes
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

numbers = st.floats(-1e3, 1e3, allow_nan=False)


@st.composite
def surfaces(draw):
    count, nodes = draw(st.integers(3, 12)), draw(st.integers(1, 5))
    vertices = draw(hnp.arrays(np.float64, (count, 3), elements=numbers))
    triangles = draw(hnp.arrays(np.int64, (draw(st.integers(1, 12)), 3), elements=st.integers(0, count - 1)))
    raw = draw(hnp.arrays(np.float64, (count, nodes), elements=st.floats(0, 1)))
    raw[np.arange(count), draw(hnp.arrays(np.int64, count, elements=st.integers(0, nodes - 1)))] += 0.125
    return cinch.Surface(vertices, triangles, raw, normalise=True)


def maps_of(nodes, most=numbers):
    return hnp.arrays(np.float64, (nodes, 3, 4), elements=most)


def holds(bvh, vertices, supports, axes):
    """Whether every BV's supports hold its vertices, along each axis and against it."""
    for bv in range(len(bvh)):
        inside = vertices[bvh.vertices_of(bv)]
        along = (axes[:, 0] * inside[:, :1] + axes[:, 1] * inside[:, 1:2]) + axes[:, 2] * inside[:, 2:]
        room = 0 if len(axes) == 3 else 8e-16 * np.abs(inside).max()  # sums are rounded here
        if not ((along <= supports[bv, 0::2] + room).all() and (-along <= supports[bv, 1::2] + room).all()):
            return False
    return True


@settings(max_examples=150)
@given(st.data())
def test_bounds_hold_vertices(data):
    surface = data.draw(surfaces())
    maps = data.draw(maps_of(surface.node_count))
    method, kdop = data.draw(st.sampled_from(cinch.methods())), data.draw(st.sampled_from(cinch.kdops))
    bvh = cinch.build_bvh(surface, data.draw(st.integers(1, 4)))
    supports = cinch.Refitter(bvh, method=method, kdop=kdop).supports(maps)
    vertices = cinch.evaluate(surface, maps)
    assert holds(bvh, vertices, supports, cinch.axes(kdop))
    if np.isfinite(supports).all():  # and what is below a vertex does not
        assert not holds(bvh, vertices, supports - 1e9, cinch.axes(kdop))


@settings(max_examples=60)
@given(st.data())
def test_bounds_are_proven(exact, data):
    surface = data.draw(surfaces())
    maps = data.draw(maps_of(surface.node_count))
    method, kdop = data.draw(st.sampled_from(cinch.methods())), data.draw(st.sampled_from(cinch.kdops))
    bvh = cinch.build_bvh(surface, 2)
    supports = cinch.Refitter(bvh, method=method, kdop=kdop).supports(maps)
    assert exact.verify(bvh, maps, supports, method=method).violated == 0
    truth = cinch.Refitter(bvh, method="vertices", kdop=kdop).supports(maps)
    lowered = truth - 1e-9 * (1 + np.abs(truth).max())  # more than all rounding of them
    assert exact.verify(bvh, maps, lowered, method="vertices").violated == lowered.size


@settings(max_examples=60)
@given(st.data())
def test_every_layout_gives_the_same(data):
    vertices, triangles = shapes.torus(8, 6)
    dense = shapes.weights(vertices, 3)
    bvh = cinch.build_bvh(cinch.Surface(vertices, triangles, dense))
    refit = cinch.Refitter(bvh)
    maps = data.draw(maps_of(3, st.integers(-100, 100).map(float)))
    same = refit(maps)
    for other in (maps.tolist(), np.asfortranarray(maps), maps.astype(np.float32), maps.astype(np.int16),
                  maps.astype(">f8"), np.stack([maps] * 2)[::2][0], cinch.Clip("one", [0.0], maps[None])):
        assert np.array_equal(np.squeeze(refit(other)), np.squeeze(same))
    assert np.array_equal(refit(np.stack([maps, maps]))[1], same)


@settings(max_examples=60)
@given(st.data())
def test_pairs_are_symmetric_and_whole(data):
    vertices, triangles = shapes.torus(8, 6)
    surface = cinch.Surface(vertices, triangles, shapes.weights(vertices, 3))
    first, second = data.draw(maps_of(3, st.floats(-3, 3))), data.draw(maps_of(3, st.floats(-3, 3)))
    pairs = []
    for frames in ([first, second], [second, first]):
        collider = cinch.Collider(method=data.draw(st.sampled_from(["best", "eq12", "vertices", "sphere", "corners"])))
        collider.add(surface), collider.add(surface)
        collider.update(frames)
        found = collider.pairs()
        assert collider.any() == (len(found) > 0)
        pairs.append({(a, b) for _, a, _, b in found.tolist()})
    assert pairs[0] == {(b, a) for a, b in pairs[1]}
