"""Triangles and boxes along the axes: by linear programming on grids, and by clipping in rationals."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shadelab import geometry


def clipped(polygon, low, high):
    """What of a convex polygon is left within a box, in rationals: the method of Sutherland and Hodgman."""
    polygon = [[Fraction(float(x)) for x in p] for p in polygon]
    for k in range(3):
        for bound, sign in ((Fraction(float(low[k])), 1), (Fraction(float(high[k])), -1)):
            out = []
            for p, q in zip(polygon, polygon[1:] + polygon[:1], strict=True):
                dp, dq = sign * (p[k] - bound), sign * (q[k] - bound)
                if dp >= 0:
                    out.append(p)
                if (dp > 0 > dq) or (dp < 0 < dq):
                    t = dp / (dp - dq)
                    out.append([x + t * (y - x) for x, y in zip(p, q, strict=True)])
            polygon = out
    return polygon


coordinate = st.integers(-3, 3)
point = st.tuples(coordinate, coordinate, coordinate)


@settings(max_examples=400, deadline=None)
@given(st.tuples(point, point, point), point, point)
def test_grids_where_things_touch(triangle, one, other):
    low, high = np.minimum(one, other), np.maximum(one, other)
    expected = bool(clipped(triangle, low, high))
    for dtype in (np.float32, np.float64):
        got = geometry.triangle_aabb(*(np.array(p, dtype) for p in triangle), low.astype(dtype), high.astype(dtype))
        assert bool(got) == expected


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("shift", [0.0, 1e6])
def test_triangles_that_pass_corners_and_edges_within_rounding(dtype, shift):
    rng = np.random.default_rng(1)
    n = 300
    low = np.full((n, 3), shift, dtype)
    high = low + dtype(64)
    # Through a corner or a point of an edge, up to rounding: the plane there, the rest of the box to one side.
    at = np.where(rng.random((n, 3)) < 0.7, rng.integers(0, 2, (n, 3)), rng.random((n, 3))) * 64
    out = rng.normal(size=(n, 3)) * 40
    a = at + out
    b = at - out * rng.uniform(0.1, 2, (n, 1))
    c = at + (at - 32) * rng.uniform(0, 2, (n, 1))
    a, b, c = ((x + shift).astype(dtype) for x in (a, b, c))
    got = geometry.triangle_aabb(a, b, c, low, high, full_output=True)
    expected = [bool(clipped(t, x, y)) for *t, x, y in zip(a, b, c, low, high, strict=True)]
    assert got.overlap.tolist() == expected and 30 < got.overlap.sum() < 270
    assert np.array_equal(got.axis == -1, got.overlap) and len(set(got.axis)) > 3


def test_every_axis_is_needed_and_named():
    rng = np.random.default_rng(2)
    a, b, c = rng.normal(size=(3, 20000, 3)) * 2
    got = geometry.triangle_aabb(a, b, c, [-1, -1, -1], [1, 1, 1], full_output=True)
    assert set(got.axis) == set(range(-1, 13))


def test_the_named_axis_separates():
    rng = np.random.default_rng(3)
    t = rng.normal(size=(2000, 3, 3)) * 2
    axis = geometry.triangle_aabb(t[:, 0], t[:, 1], t[:, 2], [-1, -1, -1], [1, 1, 1], full_output=True).axis
    edges = np.roll(t, -1, 1) - t
    normals = np.cross(edges[:, 0], edges[:, 1])
    products = np.cross(np.eye(3)[None, :, None], edges[:, None]).reshape(-1, 9, 3)
    every = np.concatenate([np.broadcast_to(np.eye(3), (2000, 3, 3)), normals[:, None], products], 1)
    apart = axis >= 0
    n = every[apart, axis[apart]]
    shadow = np.einsum("nkj,nj->nk", t[apart], n)
    reach = np.abs(n).sum(-1)
    assert ((shadow.min(1) > reach) | (shadow.max(1) < -reach)).all()


def test_nan_and_empty_boxes_meet_nothing():
    a = [[0, 0, 0], [np.nan, 0, 0], [0, 0, 0.0]]
    got = geometry.triangle_aabb(
        a, [1, 0, 0], [0, 1, 0], [[0, 0, 0], [0, 0, 0], [2, 0, 0]], [1, 1, 1], full_output=True
    )
    assert got.overlap.tolist() == [True, False, False] and got.axis.tolist() == [-1, -1, -1]
