"""Balls and boxes: the sign of rational arithmetic, at touching and one ulp beside it."""

import warnings
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


def test_what_is_no_box_has_no_nearest_point():
    """NaN and empty boxes overlap nothing, and every other field is NaN there, without a warning."""
    good, nan = np.ones(3), np.full(3, np.nan)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for lower, upper in ((-good, nan), (nan, good), (good, -good), (-good, [1, 1, np.nan])):
            contact = geometry.sphere_aabb([3.0, 0, 0], 1.0, lower, upper, full_output=True)
            assert not contact.overlap
            assert np.isnan(contact.point).all() and np.isnan(contact.distance)
            side = geometry.plane_aabb([1.0, 0, 0, 0], lower, upper, full_output=True)
            assert side.side == 0 and np.isnan(side.distance) and np.isnan(side.radius)
        for half in (nan, -good, [1, -1, 1]):
            side = geometry.plane_obb([1.0, 0, 0, 0], good, np.eye(3), half, full_output=True)
            assert side.side == 0 and np.isnan(side.distance) and np.isnan(side.radius)


def test_side_fields_have_the_batch_shape_and_precision():
    radius = np.array([0.5, 3.0], np.float32)
    for contact in (
        geometry.sphere_aabb([3, 0, 0], radius, [-1, -1, -1], [1, 1, 1], full_output=True),
        geometry.sphere_sphere([3, 0, 0], radius, [0, 0, 0], 1.0, full_output=True),
        geometry.sphere_triangle([3, 0, 0], radius, [1, 0, 0], [0, 1, 0], [0, 0, 1], full_output=True),
    ):
        assert contact.overlap.tolist() == [False, True]
        assert contact.point.shape == (2, 3) and contact.point.dtype == np.float32
        assert contact.distance.shape == (2,) and contact.distance.dtype == np.float32
        np.testing.assert_allclose(contact.distance, 2)


def test_infinite_balls_raise_no_warning():
    far = np.array([np.inf, 0, 0])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for a, b, ra, rb in ((far, far, 1, 1), (far, -far, 1, 1), (np.zeros(3), far, np.inf, np.inf)):
            contact = geometry.sphere_sphere(a, ra, b, rb, full_output=True)
            assert np.isnan(contact.point).any()
        contact = geometry.sphere_sphere([0, 0, 0], 1.0, [3, 0, 0], [-1.0, np.nan], full_output=True)
        assert not contact.overlap.any() and np.isnan(contact.point).all() and np.isnan(contact.distance).all()
