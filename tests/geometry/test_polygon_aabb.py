"""Polygons and boxes: triangles that they consist of, in rationals and by the triangle's own test."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shadelab import geometry

coordinate = st.integers(-3, 3)
point = st.tuples(coordinate, coordinate, coordinate)


@settings(max_examples=300, deadline=None)
@given(st.tuples(point, point, point), point, point)
def test_three_corners_are_a_triangle(triangle, one, other):
    low, high = np.minimum(one, other).astype(float), np.maximum(one, other).astype(float)
    expected = geometry.triangle_aabb(*np.array(triangle, float), low, high)
    assert geometry.polygon_aabb(np.array(triangle, float), low, high) == expected
    assert geometry.polygon_aabb(np.array(triangle, np.float32)[::-1], low, high) == expected


# A star in the plane z = x + y, with a collinear corner and one doubled; and the triangles it consists of.
STAR = np.array([[4, 0], [1, 1], [0, 4], [0, 4], [-1, 1], [-4, 0], [-1, -1], [0, -4], [1, -1], [2.5, -0.5]])
CENTRE = np.zeros(2)


def lifted(p):
    return np.concatenate([p, p.sum(-1, keepdims=True)], -1)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("turned", [False, True])
def test_a_star_is_the_triangles_it_consists_of(dtype, turned):
    rng = np.random.default_rng(1)
    n = 2000
    low = rng.integers(-10, 10, (n, 3)) / 2
    high = low + rng.integers(0, 5, (n, 3)) / 2
    # Half of the boxes touch the plane.
    low[::2, 2] = low[::2, :2].sum(-1)
    high[:, 2] = np.maximum(low[:, 2], high[:, 2])
    star = lifted(STAR)[:: -1 if turned else 1]
    expected = np.zeros(n, bool)
    for a, b in zip(STAR, np.roll(STAR, -1, 0), strict=True):
        expected |= geometry.triangle_aabb(lifted(CENTRE), lifted(a), lifted(b), low, high)
    got = geometry.polygon_aabb(star.astype(dtype), low.astype(dtype), high.astype(dtype), full_output=True)
    assert np.array_equal(got.overlap, expected)
    assert (np.bincount(got.by) > 40).all()


def test_flat_boxes_within_the_plane():
    ring = [[0, 0, 1], [9, 0, 1], [9, 9, 1], [0, 9, 1], [0, 5, 1], [6, 5, 1], [6, 4, 1], [0, 4, 1.0]]
    low = np.array([[1, 1, 1], [1, 4.3, 1], [7, 4.4, 1], [1, 1, 1.1]])
    # A rectangle inside, one in the notch, a point inside, one beside the plane.
    high = low + np.array([[1, 1, 0], [1, 0.4, 0], [0, 0, 0], [1, 1, 0]])
    assert geometry.polygon_aabb(ring, low, high).tolist() == [True, False, True, False]


def test_nan_touches_no_other_and_shapes_are_named():
    square = np.array([[[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0.0]]] * 2)
    square[0, 1, 1] = np.nan
    assert geometry.polygon_aabb(square, [0, 0, -1], [1, 1, 1]).tolist() == [False, True]
    with pytest.raises(ValueError, match=r"polygon: expected shape \(\.\.\., N, 3\)"):
        geometry.polygon_aabb([0, 0, 0.0], [0, 0, 0], [1, 1, 1])
