"""Axis-aligned bounds: least and greatest."""

import numpy as np
import pytest
from shadelab import geometry


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("shape", [(1, 3), (7, 3), (4, 5, 100, 3), (0, 5, 3)])
def test_bounds_are_least_and_greatest(dtype, shape):
    p = np.random.default_rng(1).normal(size=shape).astype(dtype)
    low, high = geometry.bounding_aabb(p)
    assert low.dtype == dtype and np.array_equal(low, p.min(-2)) and np.array_equal(high, p.max(-2))


def test_nan_stays_in_its_set_and_infinity_bounds():
    p = np.zeros((3, 4, 3))
    p[0, 2, 1] = np.nan
    p[1, 2, 1] = np.inf
    low, high = geometry.bounding_aabb(p)
    assert np.isnan(low[0]).all() and np.isnan(high[0]).all()
    assert np.array_equal(high[1], [0, np.inf, 0]) and not low[2].any()


def test_no_points_are_refused():
    with pytest.raises(ValueError, match=r"points: expected shape \(\.\.\., N, 3\) with N at least 1, got \(0, 3\)"):
        geometry.bounding_aabb(np.zeros((0, 3)))
