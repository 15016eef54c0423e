"""Alias tables: exact probabilities, one comparison, what is left of a number is uniform again."""

import numpy as np
import pytest
import shadelab as sl
from scipy import stats

DTYPES = [np.float32, np.float64]


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("n", [1, 2, 3, 100, 5000])
def test_probabilities_are_the_weights(n, dtype):
    rng = np.random.default_rng(n)
    weights = (rng.random(n) * (rng.random(n) < 0.7) * 10.0 ** rng.uniform(-3, 3, n)).astype(dtype)
    weights[rng.integers(n)] = 1
    table = sl.sampling.alias_table(weights)
    exact = weights.astype(float) / weights.sum(dtype=float)
    assert table.share.dtype == dtype
    assert np.abs(table.probability - exact).max() < 4 * np.finfo(dtype).eps * max(exact.max(), 1 / n) * 4
    assert (table.probability[weights == 0] == 0).all()


@pytest.mark.parametrize("dtype", DTYPES)
def test_indices_come_as_often_as_they_should(dtype):
    weights = np.arange(20, dtype=dtype)
    u = sl.sampling.Generator(2).uniform(np.arange(1 << 16), dtype=dtype)
    index, rest = sl.sampling.alias_table(weights).sample(u)
    counts = np.bincount(index, minlength=20)
    assert counts[0] == 0
    assert stats.chisquare(counts[1:], weights[1:] / weights.sum() * len(u)).pvalue > 1e-5
    assert rest.dtype == dtype and (rest >= 0).all() and (rest < 1).all()
    assert stats.kstest(rest, "uniform").pvalue > 1e-5


@pytest.mark.parametrize("dtype", DTYPES)
def test_extremes_side_by_side(dtype):
    big = 1e30 if dtype == np.float32 else 1e300
    table = sl.sampling.alias_table(np.array([1 / big, big, 0, big, 1], dtype))
    assert np.allclose(table.probability, [0, 0.5, 0, 0.5, 0], atol=1e-7)
    ends = np.array([0, np.nextafter(dtype(1), dtype(0)), 1], dtype)
    index, rest = table.sample(ends)
    assert np.isin(index, [0, 1, 3, 4]).all() and (rest < 1).all()
    only = sl.sampling.alias_table(np.array([0, 0, big, 0], dtype))
    index, _ = only.sample(np.linspace(0, 1, 1001, dtype=dtype))
    assert (index == 2).all()


def test_bad_weights_and_numbers():
    with pytest.raises(ValueError, match=r"weights: .* at 1"):
        sl.sampling.alias_table([1.0, -1.0])
    with pytest.raises(ValueError, match="weights: expected a positive one"):
        sl.sampling.alias_table([0.0])
    index, rest = sl.sampling.alias_table([1.0, 1.0]).sample([-0.5, np.nan, 1.5, 0.1])
    assert np.array_equal(index, [-1, -1, -1, 0]) and np.isnan(rest[:3]).all()
