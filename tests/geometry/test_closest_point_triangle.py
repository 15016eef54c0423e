"""The nearest point of a triangle: exact arithmetic, trimesh, slivers, lines and points."""

import numpy as np
import pytest
import shadelab as sl
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from .rational import add, cross, dot, nearest_on_segment, root, sub, times, vector

PRECISIONS = pytest.mark.parametrize("dtype", [np.float32, np.float64])


def exact(p, a, b, c):
    """The distance, and whether the nearest point lies in the open triangle."""
    p, a, b, c = (vector(v) for v in (p, a, b, c))
    n = cross(sub(b, a), sub(c, a))
    corners = [a, b, c]
    if any(n):
        areas = [dot(n, cross(sub(corners[i - 2], p), sub(corners[i - 1], p))) for i in range(3)]
        if min(areas) > 0:
            height = dot(n, sub(p, a))
            return root(height * height / dot(n, n)), True
    squares = []
    for q, r in ((a, b), (b, c), (c, a)):
        foot = sub(add(q, times(sub(r, q), nearest_on_segment(p, q, r))), p)
        squares.append(dot(foot, foot))
    return root(min(squares)), False


def check(p, a, b, c, found, dtype):
    distance, inside = exact(p, a, b, c)
    p, a, b, c = (x.astype(float) for x in (p, a, b, c))
    farthest = max(np.linalg.norm(x - p) for x in (a, b, c))
    bound = 8 * np.finfo(dtype).eps * farthest
    assert abs(float(found.distance) - float(distance)) <= bound
    w = found.weights.astype(float)
    assert (w >= 0).all() and abs(w.sum() - 1) <= 2 * np.finfo(dtype).eps
    # The weights make the point, and the point has the distance.
    size = np.finfo(dtype).eps * max(np.abs(x).max() for x in (a, b, c))
    assert np.abs(w @ np.stack([a, b, c]) - found.point).max() <= bound + 2 * size
    assert abs(np.linalg.norm(found.point - p) - float(distance)) <= bound + 2 * size
    return inside


@settings(max_examples=300, deadline=None)
@given(st.lists(st.tuples(*[st.integers(-3, 3)] * 3), min_size=4, max_size=4), st.sampled_from([1, 3, 10]))
def test_distance_on_a_grid(points, divisor):
    for dtype in (np.float32, np.float64):
        given_ = [np.array(x, dtype) / dtype(divisor) for x in points]
        check(*given_, sl.geometry.closest_point_triangle(*given_, full_output=True), dtype)


@PRECISIONS
@pytest.mark.parametrize(
    ("thin", "size", "shift"), [(1, 1, 0), (1e-8, 1, 0), (1, 1e-15, 0), (1, 1e4, 1e6), (1e-30, 1, 0)]
)
def test_distance_at_slivers_and_sizes(dtype, thin, size, shift):
    rng = np.random.default_rng(1)
    a, u, v, p = rng.normal(size=(4, 80, 3))
    b, c = a + u, a + 0.4 * u + thin * v
    p = a + rng.uniform(-1, 2, (80, 1)) * u + p * rng.choice([1, thin], (80, 1))
    given_ = [(size * x + shift).astype(dtype) for x in (p, a, b, c)]
    found = sl.geometry.closest_point_triangle(*given_, full_output=True)
    for i in range(80):
        check(*(x[i] for x in given_), type(found)(*(x[i] for x in found)), dtype)


@PRECISIONS
@pytest.mark.parametrize("thin", [1e-4, 1e-8, 1e-12])
def test_distance_of_points_as_near_as_the_sliver_is_thin(dtype, thin):
    rng = np.random.default_rng(5)
    a, u, v, p = rng.normal(size=(4, 80, 3))
    # The short edge anywhere, so that the long ones meet at a needle's point or flank it.
    b, c = a + u, a + rng.choice([0, 0.4, 1], (80, 1)) * u + thin * v
    p = a + rng.choice([0, 0.3, 0.999999, 1], (80, 1)) * u + thin * p
    given_ = [x.astype(dtype) for x in (p, a, b, c)]
    found = sl.geometry.closest_point_triangle(*given_, full_output=True)
    for i in range(80):
        check(*(x[i] for x in given_), type(found)(*(x[i] for x in found)), dtype)


@PRECISIONS
def test_regions_tell_where_the_point_lies(dtype):
    rng = np.random.default_rng(2)
    p, a, b, c = (2 * rng.normal(size=(4, 2000, 3))).astype(dtype)
    found = sl.geometry.closest_point_triangle(p, a, b, c, full_output=True)
    support = found.weights > 0
    faces = {0: (1, 1, 1), 1: (1, 1, 0), 2: (0, 1, 1), 3: (1, 0, 1), 4: (1, 0, 0), 5: (0, 1, 0), 6: (0, 0, 1)}
    for region, pattern in faces.items():
        at = found.region == region
        assert at.sum() > 20 and (support[at] == np.array(pattern, bool)).all()
    assert np.array_equal(found.point[found.region == 5], b[found.region == 5])
    # From a vertex to its own triangle the way is nothing.
    assert (sl.geometry.closest_point_triangle(a, a, b, c, full_output=True).region == 4).all()


def test_agrees_with_trimesh():
    rng = np.random.default_rng(3)
    triangles, p = rng.normal(size=(1000, 3, 3)), rng.normal(size=(1000, 3))
    want = trimesh.triangles.closest_point(triangles, p)
    got = sl.geometry.closest_point_triangle(p, *np.moveaxis(triangles, 1, 0))
    assert np.allclose(np.linalg.norm(got - p, axis=-1), np.linalg.norm(want - p, axis=-1), atol=1e-12)
    assert np.allclose(got, want, atol=1e-6)


def test_nan_stays_in_its_element():
    p, a, b, c = np.random.default_rng(4).normal(size=(4, 3, 3))
    clean = sl.geometry.closest_point_triangle(p, a, b, c)
    p[0, 0], c[1, 2] = np.nan, np.inf
    found = sl.geometry.closest_point_triangle(p, a, b, c, full_output=True)
    assert np.isnan(found.point[:2]).all() and (found.region[:2] == -1).all()
    assert np.array_equal(found.point[2], clean[2])
    with pytest.raises(ValueError, match=r"points: expected shape"):
        sl.geometry.closest_point_triangle([0, 0], a, b, c)
