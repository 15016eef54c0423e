"""Balls and boxes: the sign of rational arithmetic, at touching and one ulp beside it."""

from fractions import Fraction

import numpy as np
import pytest
from shadelab import geometry


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("shift", [0.0, 1e6])
def test_answers_are_those_of_rational_arithmetic(dtype, shift):
    rng = np.random.default_rng(1)
    n = 300
    low = (rng.integers(-4, 5, (n, 3)) + shift).astype(dtype)
    high = low + rng.integers(0, 3, (n, 3)).astype(dtype)
    c = (rng.integers(-9, 10, (n, 3)) + shift).astype(dtype)
    near = np.clip(c, low, high).astype(float)
    r = np.linalg.norm(near - c, axis=-1).astype(dtype)
    r += rng.integers(-2, 3, n).astype(dtype) * np.spacing(r)
    f = np.vectorize(lambda x: Fraction(float(x)), otypes=[object])
    expected = (((f(near) - f(c)) ** 2).sum(-1) <= f(r) ** 2) & (r >= 0)
    got = geometry.sphere_aabb(c, r, low, high, full_output=True)
    assert np.array_equal(got.overlap, expected.astype(bool)) and 30 < got.overlap.sum() < 270
    assert np.array_equal(got.point, near) and got.point.dtype == dtype
    assert np.allclose(got.distance, np.linalg.norm(near - c, axis=-1))


def test_zero_radius_is_a_point_and_empty_things_meet_nothing():
    got = geometry.sphere_aabb(
        [1, 1, 1.0], [0, -1, 1, 1, np.nan], [0, 0, 0], [[1, 1, 1]] * 2 + [[-1, 1, 1]] + [[1, 1, 1]] * 2
    )
    assert got.tolist() == [True, False, False, True, False]
