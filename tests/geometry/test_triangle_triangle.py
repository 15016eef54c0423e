"""Triangles against triangles: linear programming on grids, rationals within rounding of contact, the segment."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog
from shadelab import geometry

coordinate = st.integers(-2, 2)
point = st.tuples(coordinate, coordinate, coordinate)
triangle = st.tuples(point, point, point)


def hulls_meet(p, q):
    """Whether some point is a convex combination of either set."""
    n, m = len(p), len(q)
    equal = np.block([[p.T, -q.T], [np.ones(n), np.zeros(m)], [np.zeros(n), np.ones(m)]])
    return linprog(np.zeros(n + m), A_eq=equal, b_eq=[0, 0, 0, 1, 1]).status == 0


def meet(a, b, **more):
    return geometry.triangle_triangle(*(a[..., i, :] for i in range(3)), *(b[..., i, :] for i in range(3)), **more)


@settings(max_examples=300, deadline=None)
@given(triangle, triangle)
def test_grids_where_triangles_touch_or_are_none(a, b):
    a, b = np.array(a, float), np.array(b, float)
    expected = hulls_meet(a, b)
    # On such a grid what is apart is so by a hundredth and more, which the program's tolerance does not bridge.
    for dtype in (np.float32, np.float64):
        assert bool(meet(a.astype(dtype), b.astype(dtype))) == expected
    assert bool(meet(b[::-1], a[[1, 2, 0]], full_output=True).overlap) == expected


@settings(max_examples=300, deadline=None)
@given(triangle, triangle)
def test_grids_of_one_plane(a, b):
    a, b = np.array(a, float), np.array(b, float)
    # The slanted plane z = 2 x - y.
    a[:, 2], b[:, 2] = 2 * a[:, 0] - a[:, 1], 2 * b[:, 0] - b[:, 1]
    got = meet(a, b, full_output=True)
    assert bool(got.overlap) == hulls_meet(a, b) and got.coplanar and np.isnan(got.start).all()


def rational(x):
    return np.vectorize(lambda v: Fraction(float(v)), otypes=[object])(x)


def cross(a, b):
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def separated(a, b):
    """By the normals and the products of edges, in rationals; for triangles with area in different planes."""
    a, b = rational(a), rational(b)
    ea, eb = ([t[(i + 1) % 3] - t[i] for i in range(3)] for t in (a, b))
    axes = [cross(ea[0], ea[1]), cross(eb[0], eb[1]), *(cross(u, v) for u in ea for v in eb)]
    shadows = [([n @ p for p in a], [n @ p for p in b]) for n in axes]
    return any(max(p) < min(q) or max(q) < min(p) for p, q in shadows)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("shift", [0.0, 1e6])
def test_contacts_within_rounding(dtype, shift):
    rng = np.random.default_rng(1)
    n = 200
    a, b = rng.normal(size=(2, n, 3, 3))
    # A vertex of B on the face of A, or an edge of B through an edge of A, up to rounding.
    on_face = (rng.dirichlet([1, 1, 1], n)[..., None] * a).sum(1)
    s, t = rng.uniform(0.1, 0.9, (2, n, 1))
    on_edge = a[:, 0] + s * (a[:, 1] - a[:, 0])
    half = rng.random(n) < 0.5
    b[:, 0] = np.where(half[:, None], on_face, b[:, 0])
    b[:, 1] = np.where(half[:, None], b[:, 1], b[:, 0] + (on_edge - b[:, 0]) / t)
    # The rest of B lies to one side, so that rounding decides.
    normal = np.cross(a[:, 1] - a[:, 0], a[:, 2] - a[:, 0])
    for k in (1, 2):
        height = np.einsum("ni,ni->n", b[:, k] - on_face, normal)
        b[half & (height < 0), k] -= (2 * height / (normal**2).sum(-1))[half & (height < 0), None] * normal[
            half & (height < 0)
        ]
    a, b = (a + shift).astype(dtype), (b + shift).astype(dtype)
    got = meet(a, b)
    assert got.tolist() == [not separated(*x) for x in zip(a, b, strict=True)] and 40 < got.sum() < 190


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("tilt", [1.0, 1e-5])
def test_the_segment_ends_on_both(dtype, tilt):
    rng = np.random.default_rng(2)
    n = 200
    a, b = rng.normal(size=(2, n, 3, 3))
    # With little tilt the planes are nearly one.
    a[..., 2] *= tilt
    b[..., 2] *= tilt
    a, b = a.astype(dtype), b.astype(dtype)
    got = meet(a, b, full_output=True)
    assert np.array_equal(got.overlap, meet(a, b)) and not got.coplanar.any() and got.overlap.sum() > 40
    assert np.isnan(got.start[~got.overlap]).all()
    # As documented: four rounding units of the largest coordinate, against the edges' crossings in rationals.
    for i in np.flatnonzero(got.overlap):
        tolerance = 4 * float(np.finfo(dtype).eps) * max(abs(a[i]).max(), abs(b[i]).max())
        ends = []
        for t, o in ((rational(a[i]), rational(b[i])), (rational(b[i]), rational(a[i]))):
            normal = cross(o[1] - o[0], o[2] - o[0])
            height = [normal @ (p - o[0]) for p in t]
            for j in range(3):
                k = (j + 1) % 3
                if height[j] * height[k] < 0:
                    x = t[j] + (height[j] / (height[j] - height[k])) * (t[k] - t[j])
                    if all(normal @ cross(o[(m + 1) % 3] - o[m], x - o[m]) >= 0 for m in range(3)):
                        ends.append(x.astype(float))
        for end in (got.start[i], got.end[i]):
            assert min(np.abs(end - x).max() for x in ends) <= tolerance
        length = max(np.linalg.norm(x - y) for x in ends for y in ends)
        assert abs(np.linalg.norm(got.start[i].astype(float) - got.end[i]) - length) <= 4 * tolerance


def test_contact_in_a_vertex_is_a_segment_without_length():
    a, b = np.array([[0, 0, 0], [2, 0, 0], [0, 2, 0.0]]), np.array([[0.5, 0.5, 0], [0, 0, 1], [1, 1, 1.0]])
    got = meet(a, b, full_output=True)
    assert got.overlap and not got.coplanar
    assert np.array_equal(got.start, [0.5, 0.5, 0]) and np.array_equal(got.end, [0.5, 0.5, 0])


def test_a_shared_edge_is_the_segment():
    got = meet(
        np.array([[0, 0, 0], [2, 0, 0], [0, 2, 0.0]]), np.array([[0, 0, 0], [2, 0, 0], [0, 1, 1.0]]), full_output=True
    )
    assert sorted([got.start.tolist(), got.end.tolist()]) == [[0, 0, 0], [2, 0, 0]]


def test_nan_touches_no_other():
    a = np.array([[[0, 0, 0], [2, 0, 0], [0, 2, 0.0]]] * 2)
    b = a.copy()
    b[0, 1, 1] = np.nan
    assert meet(a, b).tolist() == [False, True]
