"""Planes and boxes along the axes: the sides of the eight corners, in rational arithmetic."""

from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from shadelab import geometry

fractions = np.vectorize(lambda x: Fraction(float(x)), otypes=[object])


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("shift", [0.0, 1e6])
def test_sides_are_those_of_the_corners(dtype, shift):
    rng = np.random.default_rng(1)
    n = 400
    normal = np.where(rng.random((n, 1)) < 0.5, rng.integers(-2, 3, (n, 3)), rng.normal(size=(n, 3)))
    low = rng.integers(-3, 4, (n, 3)) + shift
    high = low + rng.integers(0, 3, (n, 3))
    corner = np.where(rng.random((n, 3)) < 0.5, low, high)
    # Planes through a corner up to rounding, where a careless test errs.
    plane = np.concatenate([normal, -(normal * corner).sum(-1, keepdims=True)], -1).astype(dtype)
    plane[::4, 3] += rng.choice([-2, 2], n)[::4]
    low, high = low.astype(dtype), high.astype(dtype)
    p, box = fractions(plane), [fractions(low), fractions(high)]
    corners = [np.stack([box[k][:, i] for i, k in enumerate(ks)], -1) for ks in product((0, 1), repeat=3)]
    heights = np.stack([(p[:, :3] * c).sum(-1) + p[:, 3] for c in corners])
    expected = np.where((heights > 0).all(0), 1, np.where((heights < 0).all(0), -1, 0))
    got = geometry.plane_aabb(plane, low, high)
    assert got.dtype == np.int8 and np.array_equal(got, expected) and (np.bincount(got + 1) > 20).all()


def test_distance_and_radius():
    got = geometry.plane_aabb([0, 0, 2.0, -4], [-1, -1, 4], [1, 3, 6], full_output=True)
    assert got.side == 1 and got.distance == 3 and got.radius == 1


def test_what_cannot_be_told_is_not_ruled_out():
    low = [[5, 5, 5], [np.nan, 5, 5], [7, 5, 5], [-np.inf] * 3]
    assert geometry.plane_aabb([1.0, 0, 0, 0], low, [6, 6, 6]).tolist() == [1, 0, 0, 0]
