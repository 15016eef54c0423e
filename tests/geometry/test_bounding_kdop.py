"""Discrete-orientation polytopes: heights of rational arithmetic, rounded outwards and no farther."""

from fractions import Fraction

import numpy as np
import pytest
from shadelab import geometry


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("k", [6, 14, 18, 26])
def test_heights_are_those_of_rational_arithmetic_rounded_outwards(dtype, k):
    rng = np.random.default_rng(1)
    p = (rng.normal(size=(6, 20, 3)) * 10.0 ** rng.integers(-6, 7, (6, 20, 3))).astype(dtype)
    got = geometry.bounding_kdop(p, k)
    assert got.lower.shape == (6, k // 2) and got.lower.dtype == dtype
    exact = np.vectorize(lambda x: Fraction(float(x)), otypes=[object])
    heights = (exact(p)[:, :, None] * exact(got.directions)).sum(-1)
    least, greatest = heights.min(1), heights.max(1)
    assert (exact(got.lower) <= least).all() and (exact(got.upper) >= greatest).all()
    rounded = p @ got.directions.T
    assert (got.lower <= rounded.min(1)).all() and (got.upper >= rounded.max(1)).all()
    # No farther than four units of the last place of the sum's largest part.
    slack = 4 * np.spacing(np.abs(p).max((1, 2)))[:, None]
    assert (least - exact(got.lower) <= exact(slack)).all() and (exact(got.upper) - greatest <= exact(slack)).all()


def test_directions_are_distinct_and_none_is_opposite():
    d = geometry.bounding_kdop([[0, 0, 0.0]], 26).directions
    both = np.concatenate([d, -d])
    assert len(np.unique(both, axis=0)) == 26 and np.isin(d, [-1, 0, 1]).all()


def test_sums_that_are_exact_stay():
    p = np.random.default_rng(2).integers(-99, 100, (50, 3)).astype(np.float32)
    got = geometry.bounding_kdop(p)
    assert np.array_equal(got.lower, (p @ got.directions.T).min(0))
    assert np.array_equal(got.upper, (p @ got.directions.T).max(0))


def test_nan_stays_in_its_set_and_bad_k():
    p = np.zeros((2, 4, 3))
    p[0, 2, 1] = np.nan
    got = geometry.bounding_kdop(p, 14)
    assert np.isnan(got.lower[0]).all() and not got.upper[1].any()
    with pytest.raises(ValueError, match="k: expected one of 6, 14, 18, 26, got 8"):
        geometry.bounding_kdop(p, 8)
