"""Planes and oriented boxes: the sides of the eight corners, in rational arithmetic."""

from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from shadelab import geometry

fractions = np.vectorize(lambda x: Fraction(float(x)), otypes=[object])


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_sides_are_those_of_the_corners(dtype):
    rng = np.random.default_rng(1)
    n = 300
    axes = Rotation.random(n, rng=rng).as_matrix().astype(dtype)
    center = rng.normal(size=(n, 3)).astype(dtype)
    half = (rng.integers(0, 4, (n, 3)) / 2).astype(dtype)
    signs = np.array(list(product((-1, 1), repeat=3)))
    corners = fractions(center) + (signs[:, None, :, None] * fractions(half)[:, :, None] * fractions(axes)).sum(2)
    normal = np.where(rng.random((n, 1)) < 0.5, axes[:, 0], rng.normal(size=(n, 3)))
    d = -(normal * corners[rng.integers(0, 8, n), np.arange(n)].astype(float)).sum(-1)
    plane = np.concatenate([normal, d[:, None]], -1).astype(dtype)
    plane[::4, 3] += rng.choice([-2, 2], n)[::4]
    p = fractions(plane)
    heights = (p[:, :3] * corners).sum(-1) + p[:, 3]
    expected = np.where((heights > 0).all(0), 1, np.where((heights < 0).all(0), -1, 0))
    got = geometry.plane_obb(plane, center, axes, half)
    assert np.array_equal(got, expected) and (np.bincount(got + 1) > 20).all()


def test_agrees_with_boxes_along_the_axes():
    rng = np.random.default_rng(2)
    plane, low = rng.normal(size=(200, 4)), rng.normal(size=(200, 3))
    half = rng.random((200, 3))
    a = geometry.plane_aabb(plane, low, low + 2 * half, full_output=True)
    b = geometry.plane_obb(plane, low + half, np.eye(3), half, full_output=True)
    assert np.array_equal(a.side, b.side)
    assert np.allclose(a.distance, b.distance) and np.allclose(a.radius, b.radius)


def test_negative_extents_and_nan_are_not_ruled_out():
    half = [[1, 1, 1], [1, -1, 1], [1, np.nan, 1]]
    assert geometry.plane_obb([1.0, 0, 0, 0], [5, 0, 0], np.eye(3), half).tolist() == [1, 0, 0]


def test_wrong_shapes_name_the_argument():
    with pytest.raises(ValueError, match=r"axes: expected shape \(\.\.\., 3, 3\), got \(3,\)"):
        geometry.plane_obb([1.0, 0, 0, 0], [5, 0, 0], [1, 0, 0], [1, 1, 1])
