"""Balls: the sign of rational arithmetic, at touching and one ulp beside it."""

from fractions import Fraction

import numpy as np
import pytest
from shadelab import geometry


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("shift", [0.0, 1e6])
def test_answers_are_those_of_rational_arithmetic(dtype, shift):
    rng = np.random.default_rng(1)
    n = 300
    a, b = (rng.integers(-9, 10, (2, n, 3)) + shift).astype(dtype)
    ra = rng.uniform(0, 2, n).astype(dtype)
    # The second radius lets them touch as nearly as numbers can, give or take ulps.
    rb = (np.linalg.norm(a.astype(float) - b, axis=-1) - ra).astype(dtype)
    rb += rng.integers(-2, 3, n).astype(dtype) * np.spacing(rb)
    got = geometry.sphere_sphere(a, ra, b, rb)
    f = np.vectorize(lambda x: Fraction(float(x)), otypes=[object])
    reach = f(ra) + f(rb)
    expected = (((f(a) - f(b)) ** 2).sum(-1) <= reach**2) & (rb >= 0)
    assert np.array_equal(got, expected.astype(bool)) and 30 < got.sum() < 270


def test_the_point_of_contact():
    got = geometry.sphere_sphere([0, 0, 0.0], 1.0, [[3, 4, 0], [1, 0, 0], [0, 0, 0]], 2.0, full_output=True)
    assert np.allclose(got.point[0], [1.8, 2.4, 0]) and np.isclose(got.distance[0], 3)
    assert np.array_equal(got.point[1:], np.zeros((2, 3))) and np.array_equal(got.distance[1:], [0, 0])


def test_empty_and_nan_balls_touch_no_other():
    got = geometry.sphere_sphere([[0, 0, 0], [0, 0, np.nan], [0, 0, 0]], 1.0, [0, 0, 0.0], [1, 1, -0.5])
    assert got.tolist() == [True, False, False]
