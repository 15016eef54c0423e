"""Bounding balls: none outside; the smallest one is as small as any four points demand."""

from fractions import Fraction
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shadelab import geometry


def circumball(p):
    """The smallest ball with all of `p` on its surface: centre and radius."""
    u = p[1:] - p[0]
    x = np.linalg.lstsq(2 * u, (u * u).sum(-1), rcond=None)[0] if len(u) else np.zeros(3)
    return p[0] + x, np.linalg.norm(x)


def smallest_radius(p):
    """By trying all balls of up to four points."""
    best = np.inf
    for n in range(1, 5):
        for some in combinations(range(len(p)), min(n, len(p))):
            c, r = circumball(p[list(some)])
            if r < best and (np.linalg.norm(p - c, axis=-1) <= r + 1e-9).all():
                best = r
    return best


def none_outside(p, ball):
    offset = p - ball.center[..., None, :]
    own = np.sqrt(offset[..., 0] ** 2 + offset[..., 1] ** 2 + offset[..., 2] ** 2)
    assert own.dtype == p.dtype and (own <= ball.radius[..., None]).all()
    exact = np.vectorize(lambda x: Fraction(float(x)), otypes=[object])
    squared = ((exact(p) - exact(ball.center)[..., None, :]) ** 2).sum(-1)
    assert (squared <= exact(ball.radius)[..., None] ** 2).all()


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("method", ["minimal", "ritter"])
@pytest.mark.parametrize("shift", [0.0, 1e6])
def test_no_point_is_outside(dtype, method, shift):
    rng = np.random.default_rng(1)
    for n in (1, 2, 3, 5, 40):
        p = (rng.normal(size=(20, n, 3)) + shift).astype(dtype)
        none_outside(p, geometry.bounding_sphere(p, method=method))


@settings(max_examples=150, deadline=None)
@given(st.lists(st.tuples(*[st.integers(-2, 2)] * 3), min_size=1, max_size=9))
def test_grids_where_points_are_cospherical_coplanar_and_alike(points):
    p = np.array(points, float)
    expected = smallest_radius(np.unique(p, axis=0))
    for dtype in (np.float32, np.float64):
        got = geometry.bounding_sphere(p.astype(dtype))
        # Three units as documented, and the centre's rounding.
        assert abs(got.radius - expected) <= 6 * np.finfo(dtype).eps * max(expected, 1) + 1e-12
        none_outside(p.astype(dtype), got)


def test_the_smallest_ball_of_many_points():
    rng = np.random.default_rng(2)
    for make in (rng.normal, rng.uniform):
        p = make(size=(5000, 3))
        got = geometry.bounding_sphere(p)
        on = p[got.support[got.support >= 0]]
        # The support's own smallest ball is the answer, so none smaller holds all.
        assert np.isclose(got.radius, smallest_radius(on), rtol=1e-12)
        assert np.allclose(np.linalg.norm(on - got.center, axis=-1), got.radius, rtol=1e-12)
    sphere = rng.normal(size=(5000, 3))
    sphere /= np.linalg.norm(sphere, axis=-1, keepdims=True)
    assert np.isclose(geometry.bounding_sphere(7 * sphere).radius, 7, rtol=1e-6)


@pytest.mark.parametrize("size", [1e-30, 1e-12, 1e30])
def test_sets_of_any_size(size):
    p = np.random.default_rng(3).normal(size=(50, 3))
    one, other = geometry.bounding_sphere(p), geometry.bounding_sphere(size * p)
    assert np.isclose(other.radius, size * one.radius, rtol=1e-12)
    single = geometry.bounding_sphere((size * p).astype(np.float32))
    assert np.isclose(single.radius, size * one.radius, rtol=1e-5)


def test_ritter_is_larger_but_not_by_much():
    p = np.random.default_rng(4).normal(size=(200, 100, 3))
    ratio = geometry.bounding_sphere(p, method="ritter").radius / geometry.bounding_sphere(p).radius
    assert (ratio >= 1 - 1e-12).all() and ratio.mean() < 1.15


def test_nan_stays_in_its_set_and_methods_are_known():
    p = np.random.default_rng(5).normal(size=(3, 6, 3))
    p[1, 2, 1] = np.nan
    got = geometry.bounding_sphere(p)
    assert np.isfinite(got.radius[[0, 2]]).all() and np.isnan(got.radius[1]) and (got.support[1] == -1).all()
    with pytest.raises(ValueError, match="method: expected one of"):
        geometry.bounding_sphere(p, method="welzl")
